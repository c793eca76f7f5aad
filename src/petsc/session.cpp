// SPDX-License-Identifier: BSD-2-Clause
#include "gaiter/petsc/session.hpp"

#include <petscviewer.h>

#include <array>
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

// What PETSc asks for when it starts, and not again: by then an options file has not been read.
constexpr std::array asked_at_start{"-check_pointer_intensity",
                                    "-fp_trap",
                                    "-info",
                                    "-log_trace",
                                    "-log_view",
                                    "-malloc_debug",
                                    "-malloc_view",
                                    "-on_error_abort",
                                    "-on_error_attach_debugger",
                                    "-start_in_debugger"};

bool given(const char* option) {
  PetscBool is_given = PETSC_FALSE;
  check(PetscOptionsHasName(nullptr, nullptr, option, &is_given));
  return is_given == PETSC_TRUE;
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
  // Stays where it is: options such as -on_error_abort put theirs on top of it.
  (void)PetscPushErrorHandler(keep_while_starting, this);
  const PetscErrorCode code = PetscInitialize(&argc, &values, nullptr, nullptr);
  if (code != PETSC_SUCCESS && refusal_.empty()) refusal_ = "unknown reason";
  starting_ = false;
}

PetscErrorCode Session::keep_while_starting(MPI_Comm comm, int line, const char* function, const char* file,
                                            PetscErrorCode code, PetscErrorType kind, const char* message,
                                            void* context) {
  auto& self = *static_cast<Session*>(context);
  if (!self.starting_)
    return PetscTraceBackErrorHandler(comm, line, function, file, code, kind, message, nullptr);
  if (kind == PETSC_ERROR_INITIAL && self.refusal_.empty() && message) self.refusal_ = message;
  return code;
}

Session::~Session() {
  if (refusal_.empty())
    (void)PetscFinalize();
  else
    MPI_Finalize();  // PETSc does not end what it has not fully begun
}

void Session::require_started() const {
  if (!refusal_.empty()) {
    std::string given;
    for (std::size_t i = 0; i + 1 < arguments_.size(); ++i) {
      const std::string& value = arguments_[i + 1];  // of a viewer, its last part is what PETSc complains of
      if (refusal_.find(value.substr(value.rfind(':') + 1)) != std::string::npos)
        given = arguments_[i] + " '" + value + "': ";
    }
    throw base::InputError(given + "PETSc refuses to start: " + refusal_.substr(0, refusal_.find('\n')));
  }
  // PETSc opens this one last of all, when it ends.
  try {
    try_viewer("-log_view");
  } catch (const base::InputError&) {
    check(PetscOptionsClearValue(nullptr, "-log_view"));
    throw;
  }
}

void Session::insert_options_file(const std::string& path) {
  const bool readable =
      rank(PETSC_COMM_WORLD) != 0 || std::ifstream(path).peek() != std::ifstream::traits_type::eof();
  if (!agree(PETSC_COMM_WORLD, readable))
    throw base::InputError("-options_file '" + path + "': the file cannot be read, or is empty");
  std::vector<const char*> too_late;
  for (const char* option : asked_at_start)
    if (!given(option)) too_late.push_back(option);
  PetscErrorCode code = PETSC_SUCCESS;
  {
    ErrorCapture quiet;
    code = PetscOptionsInsertFileYAML(PETSC_COMM_WORLD, nullptr, path.c_str(), PETSC_TRUE);
  }
  if (!agree(PETSC_COMM_WORLD, code == PETSC_SUCCESS))
    throw base::InputError("-options_file '" + path +
                           "': not a YAML file of options (maps of values and lists of values)");
  for (const char* option : too_late) {
    if (!given(option)) continue;
    check(PetscOptionsClearValue(nullptr, option));
    throw base::InputError("-options_file '" + path + "': " + option +
                           " belongs on the command line, since PETSc reads it when it starts");
  }
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

void Session::mark_used(const std::string& name) {
  (void)given(("-" + name).c_str());
}

void try_viewer(const std::string& option) {
  PetscViewer viewer = nullptr;
  ErrorCapture quiet;
  const PetscErrorCode code =
      PetscOptionsGetViewer(PETSC_COMM_WORLD, nullptr, nullptr, option.c_str(), &viewer, nullptr, nullptr);
  if (code == PETSC_SUCCESS) check(PetscViewerDestroy(&viewer));
  if (agree(PETSC_COMM_WORLD, code == PETSC_SUCCESS)) return;
  char text[256] = "";
  check(PetscOptionsGetString(nullptr, nullptr, option.c_str(), text, sizeof text, nullptr));
  throw base::InputError(option + " '" + text +
                         "': PETSc refuses this: " + quiet.message().substr(0, quiet.message().find('\n')));
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
