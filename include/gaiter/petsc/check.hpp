// SPDX-License-Identifier: BSD-2-Clause
#pragma once

#include <petscsys.h>

#include <source_location>
#include <string>

#include "gaiter/base/error.hpp"

#if PETSC_VERSION_LT(3, 19, 0)
#define PETSC_SUCCESS static_cast<PetscErrorCode>(0)
#endif

namespace gaiter::petsc {

// Turns the error code of a PETSc call into base::InternalError. For functions that may throw; callbacks of
// PETSc return the code instead, with PetscCall.
inline void check(PetscErrorCode code, std::source_location where = std::source_location::current()) {
  if (code == PETSC_SUCCESS) return;
  const char* text = nullptr;
  PetscErrorMessage(code, &text, nullptr);
  throw base::InternalError(std::string("PETSc: ") + (text ? text : "unknown error") + " (" +
                            where.file_name() + ":" + std::to_string(where.line()) + ")");
}

}  // namespace gaiter::petsc
