// SPDX-License-Identifier: BSD-2-Clause
#pragma once

#include <vector>

#include "gaiter/model/scene.hpp"

namespace gaiter::physics {

// Nodes on (0, 1), ascending, and weights that sum to 1.
struct Quadrature {
  std::vector<double> nodes;
  std::vector<double> weights;
};

// Gauss-Legendre with `points` >= 1 nodes: exact for polynomials of degree 2 points - 1.
Quadrature gauss_legendre(int points);

// The rule that cuts a segment into slices: Gauss points of its height, or midpoints of equal pieces (the
// paper's).
Quadrature slice_quadrature(model::SliceRule rule, int slices);

// Relative error of gauss_legendre(points) on exp(rate x), a model for how fast an integrand varies over the
// wall.
double gauss_error_of_exponential(int points, double rate);

// (n!)^4 / ((2n+1) ((2n)!)^3): times the derivative of order 2n somewhere in (0, 1), the rule's error.
double gauss_error_constant(int points);

}  // namespace gaiter::physics
