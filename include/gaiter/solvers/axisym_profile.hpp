// SPDX-License-Identifier: BSD-2-Clause
#pragma once

#include <span>
#include <vector>

#include "gaiter/model/scene.hpp"
#include "gaiter/solvers/sliding_model.hpp"

namespace gaiter::solvers {

// What a simpler model says of a segment at some of its heights, from which the finite elements start.
struct RadialState {
  std::vector<double> height;         // current, of the tube's material, over the segment's lower end [m]
  std::vector<double> axial_stretch;  // of the tube
  std::vector<double> tube_radius;    // of the tube's inner face [m]
  std::vector<double> leg_strain;     // 1 - leg_radius / undeformed radius at the current height
  std::vector<double> pressure;       // [Pa]
};

// The slice equilibria at heights from 0 to 1 over the segment, at rest or actuated: nothing slides.
RadialState slice_states(const model::Scene& scene, std::size_t segment,
                         std::span<const double> relative_heights, bool actuated);

// The sliding slices, interpolated: at material heights of the tube, or (`of_tube` false) at current heights,
// where the leg is; 0 to 1 over the segment.
RadialState sliding_states(const model::Scene& scene, std::size_t segment, const SlidingProfile& profile,
                           std::span<const double> relative_heights, bool of_tube);

// The ends of a tube are fixed axially across the wall and so cannot turn, while the rest lies along the
// taper. Opens the end that this bends off the leg at rest, unless the open part is so short that the leg
// closes it. Newton's method would otherwise find its length one vertex a step.
void open_ends(const model::Scene& scene, std::size_t segment, RadialState& state);

}  // namespace gaiter::solvers
