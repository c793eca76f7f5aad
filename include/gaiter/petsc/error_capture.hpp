// SPDX-License-Identifier: BSD-2-Clause
#pragma once

#include <petscsys.h>

#include <string>

namespace gaiter::petsc {

// While it lives, PETSc's errors are not printed: their first message is kept, and the error code alone goes
// up.
class ErrorCapture {
 public:
  ErrorCapture();
  ~ErrorCapture();
  ErrorCapture(const ErrorCapture&) = delete;
  ErrorCapture& operator=(const ErrorCapture&) = delete;

  const std::string& message() const { return message_; }

 private:
  static PetscErrorCode keep(MPI_Comm comm, int line, const char* function, const char* file,
                             PetscErrorCode code, PetscErrorType kind, const char* message, void* context);

  std::string message_;
};

}  // namespace gaiter::petsc
