// SPDX-License-Identifier: BSD-2-Clause
#include "gaiter/petsc/session.hpp"

#include <fstream>

#include "gaiter/base/error.hpp"
#include "gaiter/petsc/check.hpp"
#include "gaiter/petsc/error_capture.hpp"

namespace gaiter::petsc {

namespace {

// argv as C wants it, alive as long as the strings are.
std::vector<char*> pointers(std::vector<std::string>& arguments) {
  static char program[] = "gaiter";
  std::vector<char*> argv{program};
  for (std::string& argument : arguments) argv.push_back(argument.data());
  argv.push_back(nullptr);
  return argv;
}

double reduce(MPI_Comm comm, double value, MPI_Op operation) {
  double result = 0;
  MPI_Allreduce(&value, &result, 1, MPI_DOUBLE, operation, comm);
  return result;
}

}  // namespace

Session::Session(std::vector<std::string> arguments) : arguments_(std::move(arguments)) {
  std::vector<char*> argv = pointers(arguments_);
  int argc = static_cast<int>(argv.size()) - 1;
  char** values = argv.data();
  check(PetscInitialize(&argc, &values, nullptr, nullptr));
}

Session::~Session() {
  (void)PetscFinalize();
}

void Session::insert_options_file(const std::string& path) {
  const bool readable =
      rank(PETSC_COMM_WORLD) != 0 || std::ifstream(path).peek() != std::ifstream::traits_type::eof();
  if (!agree(PETSC_COMM_WORLD, readable))
    throw base::InputError("-options_file '" + path + "': the file cannot be read, or is empty");
  PetscErrorCode code = PETSC_SUCCESS;
  {
    ErrorCapture quiet;
    code = PetscOptionsInsertFileYAML(PETSC_COMM_WORLD, nullptr, path.c_str(), PETSC_TRUE);
  }
  if (!agree(PETSC_COMM_WORLD, code == PETSC_SUCCESS))
    throw base::InputError("-options_file '" + path +
                           "': not a YAML file of options (maps of values and lists of values)");
  std::vector<char*> argv = pointers(arguments_);
  int argc = static_cast<int>(argv.size()) - 1;
  char** values = argv.data();
  check(PetscOptionsInsert(nullptr, &argc, &values, nullptr));
}

std::map<std::string, std::string> Session::unused_options() const {
  PetscInt count = 0;
  char **names = nullptr, **values = nullptr;
  check(PetscOptionsLeftGet(nullptr, &count, &names, &values));
  std::map<std::string, std::string> options;
  for (PetscInt i = 0; i < count; ++i) options[names[i]] = values[i] ? values[i] : "";
  check(PetscOptionsLeftRestore(nullptr, &count, &names, &values));
  return options;
}

int rank(MPI_Comm comm) {
  int value = 0;
  MPI_Comm_rank(comm, &value);
  return value;
}

int size(MPI_Comm comm) {
  int value = 0;
  MPI_Comm_size(comm, &value);
  return value;
}

bool agree(MPI_Comm comm, bool ok) {
  return reduce(comm, ok ? 1 : 0, MPI_MIN) > 0;
}
double sum(MPI_Comm comm, double value) {
  return reduce(comm, value, MPI_SUM);
}
double largest(MPI_Comm comm, double value) {
  return reduce(comm, value, MPI_MAX);
}

}  // namespace gaiter::petsc
