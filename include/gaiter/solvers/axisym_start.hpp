// SPDX-License-Identifier: BSD-2-Clause
#pragma once

#include "gaiter/solvers/axisym_system.hpp"

namespace gaiter::solvers {

// What slices say at the height of each node of a contact surface: inner radius of the tube, and pressure [m,
// Pa].
struct RadialState {
  std::vector<double> tube_radius, leg_radius, pressure;
};

// The slice equilibria at the heights of a surface's nodes (0 to 1 over the
// segment), at rest or actuated.
RadialState slice_states(const model::Scene& scene, std::size_t segment,
                         std::span<const double> relative_heights, bool actuated);

// Puts the slice solution into x: each body moved radially, the tube's pressure field from the radial stress
// of the thick wall, the multipliers from the interface pressure.
template <int P>
PetscErrorCode set_slice_start(const AxisymSystem<P>& system, const std::vector<RadialState>& states, Vec x);

}  // namespace gaiter::solvers
