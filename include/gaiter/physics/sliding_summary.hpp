// SPDX-License-Identifier: BSD-2-Clause
#pragma once

#include <vector>

#include "gaiter/model/result.hpp"

namespace gaiter::physics {

// One sliding slice in one state, SI.
struct SlidingSlice {
  double reference_height = 0;    // Z [m]
  double height = 0;              // z [m]
  double axial_stretch = 1;       // dz/dZ [1]
  double share = 0;               // of the reference height that the slice stands for [1]
  double pressure = 0;            // [Pa]
  double leg_radius_before = 0;   // undeformed, at z [m]
  double leg_radius = 0;          // [m]
  double tube_radius = 0;         // inner face [m]
  double actuation_pressure = 0;  // [Pa]
  double electric_field = 0;      // [V/m]
};

// The two states of a segment, and what else its result is made of.
struct SlidingOutcome {
  std::vector<SlidingSlice> rest, actuated;
  double slip_max = 0;                 // [m]
  double pressure_rest_rigid = 0;      // NaN where a leg that does not give way has no result [Pa]
  double pressure_actuated_rigid = 0;  // [Pa]
  double voltage_stable = 0;           // as in the result; NaN where there is no state at rest [V]
  int iterations = 0;
  model::Status status = model::Status::contact;
};

// Height average (1/H) int P dz [Pa].
double height_mean_pressure(const std::vector<SlidingSlice>& slices);

// Relative error of that average, from how fast the coefficients of the pressure fall within the elements.
double sliding_error(const std::vector<SlidingSlice>& slices);

model::SegmentResult summarise_sliding(const SlidingOutcome& outcome, double height, double lower_radius,
                                       double upper_radius, double reference_radius, double wall_error);

}  // namespace gaiter::physics
