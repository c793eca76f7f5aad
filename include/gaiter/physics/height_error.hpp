// SPDX-License-Identifier: BSD-2-Clause
#pragma once

#include <span>

#include "gaiter/physics/quadrature.hpp"

namespace gaiter::physics {

// Fewest Gauss points over the height from which height_error can tell.
constexpr int fewest_for_height_error = 4;

// Relative error of the average of a pressure by a Gauss rule over the height, from the pressures at its
// nodes alone: how fast their Legendre coefficients fall is carried on to the degree 2n that the rule gets
// wrong first, with a factor of ten for caution. Exact zeros give 0. Tested in tests/slice_reference.cpp.
double height_error(const Quadrature& gauss, std::span<const double> pressure);

}  // namespace gaiter::physics
