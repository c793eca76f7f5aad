// SPDX-License-Identifier: BSD-2-Clause
#pragma once

#include <span>

#include "gaiter/physics/quadrature.hpp"

namespace gaiter::physics {

// Fewest Gauss points over the height from which height_error can tell.
constexpr int fewest_for_height_error = 4;

// Relative error of the average of a pressure by a Gauss rule over the height, from the pressures at its n
// nodes alone: the fall of their Legendre coefficients carried on to the degree 2n, which the rule is the
// first to get wrong (gauss_tail). `taper`: half the difference of the segment's end radii over their mean,
// which says how near the pole r = 0 is. Costs nothing beside an evaluation. Tested in
// tests/error_estimates.cpp.
double height_error(const Quadrature& gauss, std::span<const double> pressure, double taper);

}  // namespace gaiter::physics
