// SPDX-License-Identifier: BSD-2-Clause
#include "gaiter/solvers/axisym_events.hpp"

#include "gaiter/petsc/check.hpp"

namespace gaiter::solvers {

const AxisymEvents& axisym_events() {
  static const AxisymEvents events = [] {
    AxisymEvents made;
    PetscClassId owner = 0;
    petsc::check(PetscClassIdRegister("AxisymSystem", &owner));
    petsc::check(PetscLogEventRegister("AxisymCells", owner, &made.cells));
    petsc::check(PetscLogEventRegister("AxisymContact", owner, &made.contact));
    return made;
  }();
  return events;
}

}  // namespace gaiter::solvers
