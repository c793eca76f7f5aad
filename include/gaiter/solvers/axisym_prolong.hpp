// SPDX-License-Identifier: BSD-2-Clause
#pragma once

#include "gaiter/solvers/axisym_system.hpp"

namespace gaiter::solvers {

// The same state in a larger space: x of one system into y of another, whose mesh halves the first's cells
// any number of times (not at all included) and whose order Q is P or more. Displacements, potentials and the
// pressures of the tubes are the same functions; a multiplier on a new vertex is what the line between its
// neighbours says. Instantiated for Q = P and Q = P + 1. @note Collective.
template <int P, int Q>
PetscErrorCode prolongate(const AxisymSystem<P>& coarse, Vec x, const AxisymSystem<Q>& fine, Vec y);

}  // namespace gaiter::solvers
