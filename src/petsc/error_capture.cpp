// SPDX-License-Identifier: BSD-2-Clause
#include "gaiter/petsc/error_capture.hpp"

#include "gaiter/petsc/check.hpp"

namespace gaiter::petsc {

ErrorCapture::ErrorCapture() {
  check(PetscPushErrorHandler(keep, this));
}

ErrorCapture::~ErrorCapture() {
  (void)PetscPopErrorHandler();
}

PetscErrorCode ErrorCapture::keep(MPI_Comm, int, const char*, const char*, PetscErrorCode code,
                                  PetscErrorType kind, const char* message, void* context) {
  auto& self = *static_cast<ErrorCapture*>(context);
  if (kind == PETSC_ERROR_INITIAL && self.message_.empty() && message) self.message_ = message;
  return code;
}

}  // namespace gaiter::petsc
