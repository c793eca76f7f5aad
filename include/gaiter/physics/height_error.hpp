// SPDX-License-Identifier: BSD-2-Clause
#pragma once

#include <span>

#include "gaiter/physics/quadrature.hpp"
#include "gaiter/physics/slice_outcome.hpp"

namespace gaiter::physics {

// Fewest Gauss points over the height from which height_error can tell, and the largest result that is worth
// having: it is an upper bound that need not be sharp.
constexpr int fewest_for_height_error = 6;
constexpr double largest_height_error = 1e-7;

// Bound of the relative error of the average of a pressure by a Gauss rule over the height, from the
// pressures at its n nodes alone: the fall of their Legendre coefficients carried on to the degree 2n, which
// the rule is the first to get wrong. For 64 segments at a time, whose slices at one node are a pack. Costs
// nothing beside an evaluation. Tested in tests/slice_reference.cpp.
void height_error(const Quadrature& gauss, std::span<const SliceOutcomes> slices,
                  Pack SliceOutcomes::*pressure, Pack& error);

}  // namespace gaiter::physics
