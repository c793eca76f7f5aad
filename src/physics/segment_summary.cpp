// SPDX-License-Identifier: BSD-2-Clause
#include "gaiter/physics/segment_summary.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace gaiter::physics {

namespace {

// Coefficients of the Legendre polynomials on (0, 1) that interpolate the values at the Gauss points.
std::vector<double> legendre_coefficients(std::span<const double> values, const Quadrature& rule) {
  const std::size_t count = values.size();
  std::vector<double> coefficients(count, 0.0);
  for (std::size_t k = 0; k < count; ++k) {
    const double x = 2 * rule.nodes[k] - 1;
    double before = 0, now = 1;
    for (std::size_t degree = 0; degree < count; ++degree) {
      coefficients[degree] += (2.0 * degree + 1) * rule.weights[k] * values[k] * now;
      const double next = ((2.0 * degree + 1) * x * now - degree * before) / (degree + 1.0);
      before = now;
      now = next;
    }
  }
  return coefficients;
}

}  // namespace

double height_error(std::span<const double> values, const Quadrature& rule, model::SliceRule kind) {
  const std::size_t count = values.size();
  double mean = 0;
  for (std::size_t k = 0; k < count; ++k) mean += rule.weights[k] * values[k];
  if (count < 2 || mean == 0) return 0;
  if (kind == model::SliceRule::midpoint) {
    // The error of n midpoints is (f'(1) - f'(0)) / (24 n^2).
    const double n = static_cast<double>(count);
    const double slopes = n * ((values[count - 1] - values[count - 2]) - (values[1] - values[0]));
    return std::fabs(slopes / (24 * n * n) / mean);
  }
  // Gauss is exact to degree 2n - 1. The coefficients beyond n - 1 are extrapolated from the fall of the
  // known ones: the largest of the last two, relative to the two in the middle before them.
  const std::vector<double> c = legendre_coefficients(values, rule);
  const auto size = [&](std::size_t from, std::size_t to) {
    double largest = 0;
    for (std::size_t k = from; k < to; ++k) largest = std::max(largest, std::fabs(c[k]));
    return largest;
  };
  const double last = size(count >= 3 ? count - 2 : count - 1, count), first = size(0, count >= 4 ? 2 : 1);
  const double span = count >= 4 ? count - 2.0 : (count >= 3 ? 1.5 : 1.0);  // degrees between the two
  const double fall = std::min(1.0, last / first);
  const double beyond = last * std::pow(fall, (count + 1.0) / span);
  return std::max(beyond, 4e-16 * std::fabs(mean)) / std::fabs(mean);
}

model::SegmentResult summarise(std::span<const SliceOutcome> slices, const Quadrature& rule,
                               model::SliceRule kind, double height, double wall_error) {
  model::SegmentResult result;
  const auto mean = [&](auto&& quantity) {
    double sum = 0;
    for (std::size_t k = 0; k < slices.size(); ++k) sum += rule.weights[k] * quantity(slices[k]);
    return sum;
  };
  const auto square = [](double r) { return M_PI * r * r; };
  for (const SliceOutcome& slice : slices) {
    result.status = std::max(result.status, slice.status);
    result.iterations = std::max(result.iterations, slice.iterations);
    result.electric_field_max = std::max(result.electric_field_max, slice.electric_field);
  }
  result.pressure_rest_rigid = mean([](const auto& s) { return s.pressure_rest_rigid; });
  result.pressure_actuated_rigid = mean([](const auto& s) { return s.pressure_actuated_rigid; });
  result.volume_initial = height * mean([&](const auto& s) { return square(s.leg_radius); });
  constexpr double none = std::numeric_limits<double>::quiet_NaN();
  if (!model::trustworthy(result.status)) {
    result.pressure_rest = result.pressure_actuated = result.pressure_rest_area_mean = none;
    result.pressure_actuated_area_mean = result.actuation_drop = result.actuation_pressure = none;
    result.volume_rest = result.volume_actuated = result.volume_change = result.radius_actuated = none;
    result.stretch_actual = result.electric_field_max = result.error_estimate = none;
    return result;
  }
  if (result.status == model::Status::pulled_in) result.electric_field_max = none;
  result.pressure_rest = mean([](const auto& s) { return s.pressure_rest; });
  result.pressure_actuated = mean([](const auto& s) { return s.pressure_actuated; });
  result.pressure_rest_area_mean = mean([](const auto& s) { return s.pressure_rest * s.radius_rest; }) /
                                   mean([](const auto& s) { return s.bandage_radius_rest; });
  result.pressure_actuated_area_mean =
      mean([](const auto& s) { return s.pressure_actuated * s.radius_actuated; }) /
      mean([](const auto& s) { return s.bandage_radius_actuated; });
  result.actuation_drop = result.pressure_rest - result.pressure_actuated;
  result.actuation_pressure = mean([](const auto& s) { return s.actuation_pressure; });
  result.volume_rest = height * mean([&](const auto& s) { return square(s.radius_rest); });
  result.volume_actuated = height * mean([&](const auto& s) { return square(s.radius_actuated); });
  // Formed from the differences of the radii, which a small change needs.
  result.volume_change =
      height * mean([](const auto& s) {
        return M_PI * (s.leg_radius - s.radius_actuated) * (s.leg_radius + s.radius_actuated);
      }) /
      result.volume_initial;
  result.radius_actuated = mean([](const auto& s) { return s.radius_actuated; });
  result.stretch_actual = mean([](const auto& s) { return s.bandage_radius_rest / s.reference_radius; });

  std::vector<double> rest, actuated;
  for (const SliceOutcome& slice : slices) {
    rest.push_back(slice.pressure_rest);
    actuated.push_back(slice.pressure_actuated);
  }
  result.error_estimate =
      wall_error + std::max(height_error(rest, rule, kind), height_error(actuated, rule, kind));
  return result;
}

}  // namespace gaiter::physics
