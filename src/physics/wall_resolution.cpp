// SPDX-License-Identifier: BSD-2-Clause
#include "gaiter/physics/wall_resolution.hpp"

#include <algorithm>
#include <cmath>

#include "gaiter/physics/slice_system.hpp"

namespace gaiter::physics {

namespace {

constexpr int most_wall_points = 128;

}  // namespace

double wall_error(const model::Scene& scene, std::size_t segment, int points) {
  const model::Segment& leg = scene.leg.segments[segment];
  const double widest = std::max(leg.lower_radius, leg.upper_radius);
  const Wall wall = reference_wall(scene.bandage, scene.bandage.modules[segment], leg.mean_radius(), widest);
  // Over the wall, whose logarithmic thickness is that of its area, lambda^(alpha - 2) changes by this
  // exponent.
  const double inner = wall.inner_radius, outer = inner + wall.thickness;
  const double area = wall.thickness * (inner + outer) / (inner * inner);
  const double log_area = std::log1p(area);
  const double swell = wall.gap * (2 * inner + wall.gap);
  const double stretch_span =
      0.5 * std::fabs(std::log1p(swell / (inner * inner)) - std::log1p(swell / (outer * outer)));
  double steepest = 0;
  for (const auto& term : scene.bandage.ogden) steepest = std::max(steepest, std::fabs(term.alpha));
  const double exponential =
      gauss_error_of_exponential(points, (steepest + 2) * stretch_span + 1e-3 * log_area);
  // 1/lambda^2 has poles at a distance of pi / log_area from the wall: the ellipse of convergence of Gauss.
  const double pole = 2 * M_PI / log_area;
  const double ellipse = pole + std::hypot(1.0, pole);
  return exponential + std::pow(ellipse, -2.0 * points);
}

int wall_points_for(const model::Scene& scene, std::size_t segment, double tolerance) {
  int points = 2;
  while (points < most_wall_points && wall_error(scene, segment, points) > tolerance) ++points;
  return points;
}

}  // namespace gaiter::physics
