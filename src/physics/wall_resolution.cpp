// SPDX-License-Identifier: BSD-2-Clause
#include "gaiter/physics/wall_resolution.hpp"

#include <algorithm>
#include <cmath>

#include "gaiter/physics/quadrature.hpp"

namespace gaiter::physics {

namespace {

constexpr int most_wall_points = 128;

#define GAITER_EACH for (int i = 0; i < pack_width; ++i)

// A pack of segments, of which the error depends on how fast the integrand varies through the wall.
struct Walls {
  Pack inner_radius, thickness, gap, steepest;
  Pack log_rate, growth;  // of an exponential: logarithm of its rate, rate / (1 - exp(-rate))
  Pack log_ellipse;       // of convergence of Gauss
  Pack points, asked, error;
};

GAITER_MULTIVERSION
void find_variation(Walls& walls) {
  GAITER_EACH {
    // Over the wall, whose logarithmic thickness is that of its area, lambda^(alpha - 2) changes by this
    // exponent.
    const double inner = walls.inner_radius[i], outer = inner + walls.thickness[i];
    const double log_area = log1p(walls.thickness[i] * (inner + outer) / (inner * inner));
    const double swell = walls.gap[i] * (2 * inner + walls.gap[i]);
    const double stretch_span =
        0.5 * std::fabs(log1p(swell / (inner * inner)) - log1p(swell / (outer * outer)));
    const double rate = (walls.steepest[i] + 2) * stretch_span + 1e-3 * log_area;
    // 1/lambda^2 has poles at a distance of pi / log_area from the wall.
    const double pole = 2 * M_PI / log_area;
    walls.log_rate[i] = log(rate);
    walls.growth[i] = rate / -expm1(-rate);
    walls.log_ellipse[i] = log(pole + std::sqrt(1 + pole * pole));
  }
}

// The error with `points`; of an exponential it is gauss_error_of_exponential().
GAITER_MULTIVERSION
void find_error(const Pack& log_constant, Walls& walls) {
  GAITER_EACH {
    const double twice = 2 * walls.points[i];
    const double exponential = exp(twice * walls.log_rate[i] + log_constant[i]) * walls.growth[i];
    walls.error[i] = (exponential < 1 ? exponential : 1) + exp(-twice * walls.log_ellipse[i]);
  }
}

void choose(Walls& walls, double tolerance) {
  find_variation(walls);
  GAITER_EACH walls.points[i] = walls.asked[i] > 0 ? walls.asked[i] : 2;
  for (bool more = true; more;) {
    Pack log_constant;
    GAITER_EACH log_constant[i] = gauss_log_constant(static_cast<int>(walls.points[i]));
    find_error(log_constant, walls);
    more = false;
    GAITER_EACH {
      if (walls.asked[i] > 0 || !(walls.error[i] > tolerance) || walls.points[i] >= most_wall_points)
        continue;
      walls.points[i] += 1;
      more = true;
    }
  }
}

}  // namespace

void choose_wall_points(std::span<SegmentNumbers> segments, double tolerance) {
  Walls walls;
  for (std::size_t first = 0; first < segments.size(); first += pack_width) {
    const std::span<SegmentNumbers> these =
        segments.subspan(first, std::min<std::size_t>(pack_width, segments.size() - first));
    GAITER_EACH {
      const SegmentNumbers& one = these[std::min<std::size_t>(i, these.size() - 1)];
      walls.inner_radius[i] = one.inner_radius;
      walls.thickness[i] = one.thickness;
      // Where the leg is widest.
      walls.gap[i] = one.gap + 0.5 * std::fabs(one.upper_radius - one.lower_radius);
      walls.steepest[i] = one.steepest;
      walls.asked[i] = one.wall_points;
    }
    choose(walls, tolerance);
    for (std::size_t i = 0; i < these.size(); ++i) {
      these[i].wall_points = walls.points[static_cast<int>(i)];
      these[i].wall_error = these[i].passive_wall_error = walls.error[static_cast<int>(i)];
    }
  }
}

WallChoice wall_points_for(const model::Scene& scene, std::size_t segment, double tolerance) {
  SegmentNumbers numbers = segment_numbers(scene, segment);
  numbers.wall_points = 0;
  choose_wall_points({&numbers, 1}, tolerance);
  return {static_cast<int>(numbers.wall_points), numbers.wall_error};
}

double wall_error(const model::Scene& scene, std::size_t segment, int points) {
  SegmentNumbers numbers = segment_numbers(scene, segment);
  numbers.wall_points = points;
  choose_wall_points({&numbers, 1}, 0);
  return numbers.wall_error;
}

}  // namespace gaiter::physics
