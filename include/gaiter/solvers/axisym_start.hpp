// SPDX-License-Identifier: BSD-2-Clause
#pragma once

#include "gaiter/solvers/axisym_profile.hpp"
#include "gaiter/solvers/axisym_system.hpp"

namespace gaiter::solvers {

// Puts what simpler models say into x, `states` one a block at the heights of its surface's nodes: the tubes
// by the incompressible map of a thick wall with its axial stretch, their pressure field from the radial
// stress of that wall, the leg radially by its strain, the multipliers from the interface pressure.
template <int P>
PetscErrorCode set_start(const AxisymSystem<P>& system, const std::vector<RadialState>& states, Vec x);

}  // namespace gaiter::solvers
