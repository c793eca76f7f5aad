// SPDX-License-Identifier: BSD-2-Clause
#include "gaiter/physics/segment_summary.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace gaiter::physics {

model::SegmentResult summarise(std::span<const SliceOutcome> slices, const Quadrature& rule, double height,
                               double quadrature_error) {
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
    result.pressure_actuated_area_mean = result.actuation_pressure = none;
    model::derive_changes(result);
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
  model::derive_changes(result);
  result.actuation_drop = mean([](const auto& s) { return s.actuation_drop; });
  result.actuation_pressure = mean([](const auto& s) { return s.actuation_pressure; });
  result.volume_rest = height * mean([&](const auto& s) { return square(s.radius_rest); });
  result.volume_actuated = height * mean([&](const auto& s) { return square(s.radius_actuated); });
  // Formed from the strains, which a small change needs.
  result.volume_change = height * mean([&](const auto& s) {
                           return square(s.leg_radius) * s.strain_actuated * (2 - s.strain_actuated);
                         }) /
                         result.volume_initial;
  result.radius_actuated = mean([](const auto& s) { return s.radius_actuated; });
  result.stretch_actual = mean([](const auto& s) { return s.bandage_radius_rest / s.reference_radius; });
  const auto relative = [](double error, double pressure) { return pressure > 0 ? error / pressure : 0; };
  result.error_estimate =
      quadrature_error +
      std::max(relative(mean([](const auto& s) { return s.error_rest; }), result.pressure_rest),
               relative(mean([](const auto& s) { return s.error_actuated; }), result.pressure_actuated));
  return result;
}

}  // namespace gaiter::physics
