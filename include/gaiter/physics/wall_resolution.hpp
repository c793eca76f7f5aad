// SPDX-License-Identifier: BSD-2-Clause
#pragma once

#include <cstddef>

#include "gaiter/model/scene.hpp"

namespace gaiter::physics {

struct WallChoice {
  int points = 0;
  double error = 0;  // of the quadrature, relative [1]
};

// Gauss points through the wall of a module that make the quadrature error of its pressure smaller than
// `tolerance`, a priori, and that error for a given number of points [1].
WallChoice wall_points_for(const model::Scene& scene, std::size_t segment, double tolerance);
double wall_error(const model::Scene& scene, std::size_t segment, int points);

}  // namespace gaiter::physics
