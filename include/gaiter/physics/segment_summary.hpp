// SPDX-License-Identifier: BSD-2-Clause
#pragma once

#include <span>
#include <vector>

#include "gaiter/model/result.hpp"
#include "gaiter/physics/quadrature.hpp"

namespace gaiter::physics {

// What became of one slice, SI.
struct SliceOutcome {
  double leg_radius = 0;               // undeformed [m]
  double reference_radius = 0;         // of the bandage: flat length / (2 pi) [m]
  double pressure_rest_rigid = 0;      // [Pa]
  double pressure_actuated_rigid = 0;  // [Pa]
  double pressure_rest = 0;            // [Pa]
  double pressure_actuated = 0;        // [Pa]
  double radius_rest = 0;              // of the leg [m]
  double radius_actuated = 0;          // of the leg [m]
  double strain_actuated = 0;          // of the leg: 1 - radius_actuated / leg_radius with all its digits [1]
  double bandage_radius_rest = 0;      // inner face; larger than the leg's where they do not touch [m]
  double bandage_radius_actuated = 0;  // the leg's where the bandage has none (pulled in) [m]
  double actuation_drop = 0;           // pressure_rest - pressure_actuated with all its digits [Pa]
  double error_rest = 0;               // of pressure_rest, by rounding and by what Newton has left [Pa]
  double error_actuated = 0;           // of pressure_actuated, likewise [Pa]
  double actuation_pressure = 0;       // Eq. (8) at the actuated radius [Pa]
  double electric_field = 0;           // [V/m]
  int iterations = 0;
  model::Status status = model::Status::contact;
};

// Segment result from its slices at the nodes of `rule` over the height. All numbers but the initial volume
// and the rigid pressures are NaN where a slice has no trustworthy result, the field also where one is pulled
// in. `quadrature_error` and the slices' own errors make the error estimate.
model::SegmentResult summarise(std::span<const SliceOutcome> slices, const Quadrature& rule, double height,
                               double quadrature_error);

}  // namespace gaiter::physics
