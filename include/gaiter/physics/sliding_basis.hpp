// SPDX-License-Identifier: BSD-2-Clause
#pragma once

#include <cmath>

#include "gaiter/physics/sliding_system.hpp"

// The cubic elements of sliding slices.
namespace gaiter::physics::sliding {

constexpr int degree = sliding_degree;

// Lagrange polynomials of the Gauss-Lobatto nodes of (0, 1), and their slopes, at the Gauss points.
struct Basis {
  double node[degree + 1];
  double point[degree], weight[degree];
  double value[degree][degree + 1], slope[degree][degree + 1];
  double end_slope[2][degree + 1];  // at 0 and 1

  double value_at(double x, int a) const {
    double product = 1;
    for (int b = 0; b <= degree; ++b)
      if (b != a) product *= (x - node[b]) / (node[a] - node[b]);
    return product;
  }
  double slope_at(double x, int a) const {
    double sum = 0;
    for (int b = 0; b <= degree; ++b) {
      if (b == a) continue;
      double product = 1 / (node[a] - node[b]);
      for (int c = 0; c <= degree; ++c)
        if (c != a && c != b) product *= (x - node[c]) / (node[a] - node[c]);
      sum += product;
    }
    return sum;
  }
};

inline Basis make_basis() {
  Basis basis{};
  const double inner = 0.5 * (1 - std::sqrt(0.2)), outer = 0.5 * (1 - std::sqrt(0.6));
  const double nodes[] = {0, inner, 1 - inner, 1}, points[] = {outer, 0.5, 1 - outer};
  const double weights[] = {5.0 / 18, 8.0 / 18, 5.0 / 18};
  for (int a = 0; a <= degree; ++a) basis.node[a] = nodes[a];
  for (int g = 0; g < degree; ++g) {
    basis.point[g] = points[g];
    basis.weight[g] = weights[g];
  }
  for (int a = 0; a <= degree; ++a) {
    for (int g = 0; g < degree; ++g) {
      basis.value[g][a] = basis.value_at(points[g], a);
      basis.slope[g][a] = basis.slope_at(points[g], a);
    }
    for (int end : {0, 1}) basis.end_slope[end][a] = basis.slope_at(end, a);
  }
  return basis;
}

inline const Basis basis = make_basis();

// Row of the slip of node `a` of an element: -1 for the lower end of the segment, whose slip is 0.
inline int slip_row(int element, int a) {
  return degree * element + a - 1;
}

}  // namespace gaiter::physics::sliding
