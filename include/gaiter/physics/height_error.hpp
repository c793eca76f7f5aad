// SPDX-License-Identifier: BSD-2-Clause
#pragma once

#include <span>

#include "gaiter/physics/quadrature.hpp"
#include "gaiter/physics/slice_outcome.hpp"

namespace gaiter::physics {

// Fewest Gauss points over the height from which height_error can tell.
constexpr int fewest_for_height_error = 4;

// Error of the average of a pressure by a Gauss rule over the height, times that average, from the pressures
// at its n nodes alone: the fall of their Legendre coefficients carried on to the degree 2n, which the rule
// is the first to get wrong. Ratios of neighbours fall like those of an exponential, but never below those of
// a function with a pole at the distance 1/roughness (in half lengths of the interval). For 64 segments at a
// time, whose slices at one node are a pack. `mean`: the average. Tested in tests/slice_reference.cpp and
// tests/auto_model.cpp.
void height_error(const Quadrature& gauss, std::span<const SliceOutcomes> slices,
                  Pack SliceOutcomes::*pressure, const Pack& roughness, Pack& error, Pack& mean);

}  // namespace gaiter::physics
