// SPDX-License-Identifier: BSD-2-Clause
#pragma once

#include <span>

#include "gaiter/model/leg.hpp"
#include "gaiter/physics/quadrature.hpp"
#include "gaiter/physics/slice_outcome.hpp"

namespace gaiter::physics {

// Fewest Gauss points over the height from which height_error can tell.
constexpr int fewest_for_height_error = 4;

// Error of the average of a pressure, or of a strain, by a Gauss rule over the height, times that average,
// from the pressures at its n nodes alone: the fall of their Legendre coefficients carried on to the degree
// 2n, which the rule is the first to get wrong. Ratios of neighbours fall like those of an exponential, but
// never below those of a function with a pole at the distance 1/roughness (in half lengths of the interval).
// For 64 segments at a time, whose slices at one node are a pack. `mean`: the average. Tested in
// tests/slice_reference.cpp and tests/auto_model.cpp.
void height_error(const Quadrature& gauss, std::span<const SliceOutcomes> slices,
                  Pack SliceOutcomes::*quantity, const Pack& roughness, Pack& error, Pack& mean);

// The leg at mid-height in the state whose volume counts: its strain, that one's derivative over the
// pressure, and what the pressure grows with the logarithm of the leg's radius.
struct LoadedLeg {
  double pressure = 0, strain = 0, response = 0, give = 0;  // [Pa, 1, 1/Pa, Pa]
};

// Relative error of the volume change by a Gauss rule, leading order: of a power of the radius, and of the
// exponentials of the leg's law, which over the height are steeper than that. `taper`: half the difference of
// the end radii over the mean radius.
double volume_height_error(const model::Leg& leg, const model::Segment& segment, const LoadedLeg& loaded,
                           double taper, int points);

}  // namespace gaiter::physics
