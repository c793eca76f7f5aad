// SPDX-License-Identifier: BSD-2-Clause
#pragma once

#include <petscsys.h>

#include <map>
#include <string>
#include <vector>

namespace gaiter::petsc {

// PETSc and MPI from construction to destruction. Lives outside every try block: unwinding through
// PetscFinalize on one rank would hang the others.
class Session {
 public:
  // @note Collective. `arguments` are those of the program without its name; they come after, and so win
  // over,
  // ~/.petscrc and the environment's PETSC_OPTIONS.
  explicit Session(std::vector<std::string> arguments);
  ~Session();
  Session(const Session&) = delete;
  Session& operator=(const Session&) = delete;

  // @note Collective. Adds the options of a YAML file; options of the command line keep their values. Throws
  // base::InputError if the file cannot be read or is not YAML that PETSc understands.
  void insert_options_file(const std::string& path);

  // Options given so far that PETSc itself has not asked for, name (without dash) to text; empty text: no
  // value.
  std::map<std::string, std::string> unused_options() const;

 private:
  std::vector<std::string> arguments_;
};

int rank(MPI_Comm comm);
int size(MPI_Comm comm);

// @note Collective. True on all ranks if `ok` is true on all.
bool agree(MPI_Comm comm, bool ok);

// @note Collective. Sum or maximum over the ranks.
double sum(MPI_Comm comm, double value);
double largest(MPI_Comm comm, double value);

}  // namespace gaiter::petsc
