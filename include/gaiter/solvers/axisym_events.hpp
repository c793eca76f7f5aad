// SPDX-License-Identifier: BSD-2-Clause
#pragma once

#include <petscsys.h>

namespace gaiter::solvers {

// What -log_view shows of the axisymmetric model beside PETSc's own events: internal forces and tangents of
// the cells, and all that contact needs. Putting them into the matrix is PETSc's MatSetValuesCOO.
struct AxisymEvents {
  PetscLogEvent cells = 0, contact = 0;
};

// Registered at the first call. @note Collective.
const AxisymEvents& axisym_events();

}  // namespace gaiter::solvers
