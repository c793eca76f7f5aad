// SPDX-License-Identifier: BSD-2-Clause
#pragma once

#include <cstddef>
#include <span>

#include "gaiter/model/scene.hpp"
#include "gaiter/physics/segment_pack.hpp"

namespace gaiter::physics {

struct WallChoice {
  int points = 0;
  double error = 0;  // of the quadrature, relative [1]
};

// Gauss points through the walls of segments that make the quadrature error of their pressures smaller than
// `tolerance`, a priori, where wall_points is 0; and that error for the points chosen or given [1].
void choose_wall_points(std::span<SegmentNumbers> segments, double tolerance);

// The same for one module.
WallChoice wall_points_for(const model::Scene& scene, std::size_t segment, double tolerance);
double wall_error(const model::Scene& scene, std::size_t segment, int points);

}  // namespace gaiter::physics
