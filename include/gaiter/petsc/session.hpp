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
  // over, ~/.petscrc and the environment's PETSC_OPTIONS. Never throws: see require_started.
  explicit Session(std::vector<std::string> arguments);
  ~Session();
  Session(const Session&) = delete;
  Session& operator=(const Session&) = delete;

  // @note Collective. Throws base::InputError if PETSc did not start because an option was not to its liking.
  // Then the session is good for nothing else.
  void require_started() const;

  // @note Collective. Adds the options of a YAML file; options of the command line keep their values. Throws
  // base::InputError if the file cannot be read or is not YAML that PETSc understands.
  void insert_options_file(const std::string& path);

  // Options given so far that PETSc itself has not asked for, name (without dash) to text; empty text: no
  // value.
  std::map<std::string, std::string> unused_options() const;

  // Tells PETSc that an option has been read, so that -options_left does not call it forgotten.
  void mark_used(const std::string& name);

 private:
  // Errors while PETSc starts are kept; later ones are traced back as usual.
  static PetscErrorCode keep_while_starting(MPI_Comm comm, int line, const char* function, const char* file,
                                            PetscErrorCode code, PetscErrorType kind, const char* message,
                                            void* context);

  std::vector<std::string> arguments_;
  bool starting_ = true;
  std::string refusal_;  // what PETSc said when it did not start
};

// @note Collective. Opens and closes the viewer that an option (with its dash) asks for, if it is given.
// Throws base::InputError on every rank if that fails on one: the first rank alone opens files.
void try_viewer(const std::string& option);

int rank(MPI_Comm comm);
int size(MPI_Comm comm);

// @note Collective. True on all ranks if `ok` is true on all.
bool agree(MPI_Comm comm, bool ok);

// @note Collective. Sum or maximum over the ranks.
double sum(MPI_Comm comm, double value);
double largest(MPI_Comm comm, double value);

}  // namespace gaiter::petsc
