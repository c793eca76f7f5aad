// SPDX-License-Identifier: BSD-2-Clause
#include "gaiter/physics/wall_resolution.hpp"

#include <algorithm>
#include <cmath>

#include "gaiter/physics/slice_system.hpp"

namespace gaiter::physics {

namespace {

constexpr int most_wall_points = 128;

// What the error depends on: how fast the integrand varies through the wall.
struct Variation {
  double rate = 0;     // of an exponential
  double ellipse = 1;  // of convergence of Gauss
};

Variation variation_in(const model::Scene& scene, std::size_t segment) {
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
  // 1/lambda^2 has poles at a distance of pi / log_area from the wall.
  const double pole = 2 * M_PI / log_area;
  return {(steepest + 2) * stretch_span + 1e-3 * log_area, pole + std::hypot(1.0, pole)};
}

double error_with(const Variation& variation, int points) {
  return gauss_error_of_exponential(points, variation.rate) + std::pow(variation.ellipse, -2.0 * points);
}

}  // namespace

double wall_error(const model::Scene& scene, std::size_t segment, int points) {
  return error_with(variation_in(scene, segment), points);
}

WallChoice wall_points_for(const model::Scene& scene, std::size_t segment, double tolerance) {
  const Variation variation = variation_in(scene, segment);
  WallChoice choice{2, error_with(variation, 2)};
  while (choice.points < most_wall_points && choice.error > tolerance)
    choice.error = error_with(variation, ++choice.points);
  return choice;
}

}  // namespace gaiter::physics
