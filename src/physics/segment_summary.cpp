// SPDX-License-Identifier: BSD-2-Clause
#include "gaiter/physics/segment_summary.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace gaiter::physics {

#define GAITER_EACH for (int i = 0; i < pack_width; ++i)

SegmentSummary::SegmentSummary(std::span<const SliceOutcomes> slices, std::span<const Pack> weights,
                               const SegmentPack& segments) {
  for (std::size_t k = 0; k < slices.size(); ++k) add(slices[k], weights[k]);
  finish(segments);
}

GAITER_MULTIVERSION
void SegmentSummary::add(const SliceOutcomes& slice, const Pack& weights) {
  GAITER_EACH {
    status_[i] = slice.status[i] > status_[i] ? slice.status[i] : status_[i];
    iterations_[i] = slice.iterations[i] > iterations_[i] ? slice.iterations[i] : iterations_[i];
    field_[i] = slice.electric_field[i] > field_[i] ? slice.electric_field[i] : field_[i];
    rest_rigid_[i] += weights[i] * slice.pressure_rest_rigid[i];
    actuated_rigid_[i] += weights[i] * slice.pressure_actuated_rigid[i];
    rest_[i] += weights[i] * slice.pressure_rest[i];
    actuated_[i] += weights[i] * slice.pressure_actuated[i];
    actuation_[i] += weights[i] * slice.actuation_pressure[i];
    drop_[i] += weights[i] * slice.actuation_drop[i];
    rest_error_[i] += weights[i] * slice.error_rest[i];
    actuated_error_[i] += weights[i] * slice.error_actuated[i];
  }
  GAITER_EACH {
    rest_force_[i] += weights[i] * slice.pressure_rest[i] * slice.radius_rest[i];
    actuated_force_[i] += weights[i] * slice.pressure_actuated[i] * slice.radius_actuated[i];
    rest_area_[i] += weights[i] * slice.bandage_radius_rest[i];
    actuated_area_[i] += weights[i] * slice.bandage_radius_actuated[i];
  }
  GAITER_EACH {
    const double initial = slice.leg_radius[i] * slice.leg_radius[i];
    const double strain = slice.strain_actuated[i];
    volume_initial_[i] += weights[i] * initial;
    volume_rest_[i] += weights[i] * slice.radius_rest[i] * slice.radius_rest[i];
    volume_actuated_[i] += weights[i] * slice.radius_actuated[i] * slice.radius_actuated[i];
    // Formed from the strains, which a small change needs.
    volume_change_[i] += weights[i] * initial * strain * (2 - strain);
    radius_[i] += weights[i] * slice.radius_actuated[i];
  }
}

GAITER_MULTIVERSION
void SegmentSummary::finish(const SegmentPack& segments) {
  const Pack &height = segments.constants.height, &reference = segments.constants.reference_radius;
  GAITER_EACH {
    const double area = M_PI * height[i];
    volume_change_[i] /= volume_initial_[i];
    volume_initial_[i] *= area;
    volume_rest_[i] *= area;
    volume_actuated_[i] *= area;
    stretch_[i] = rest_area_[i] / reference[i];
    rest_force_[i] /= rest_area_[i];
    actuated_force_[i] /= actuated_area_[i];
  }
}

GAITER_MULTIVERSION
void SegmentSummary::find(SlicesFound& found) const {
  constexpr double contact = static_cast<double>(model::Status::contact),
                   extrapolated = static_cast<double>(model::Status::extrapolated);
  GAITER_EACH {
    found.in_contact[i] = status_[i] == contact || status_[i] == extrapolated ? 1 : 0;
    found.pressure_rest[i] = rest_[i];
    found.pressure_actuated[i] = actuated_[i];
    found.lost_at_rest[i] = 1 - volume_rest_[i] / volume_initial_[i];
    found.lost_actuated[i] = volume_change_[i];
  }
}

model::SegmentResult SegmentSummary::result(int i, double quadrature_error) const {
  constexpr double none = std::numeric_limits<double>::quiet_NaN();
  const auto status = static_cast<model::Status>(static_cast<int>(status_[i]));
  model::SegmentResult result = model::without_numbers(status, model::Fidelity::slice);
  result.slip_max = 0;
  result.iterations = static_cast<int>(iterations_[i]);
  result.pressure_rest_rigid = rest_rigid_[i];
  result.pressure_actuated_rigid = actuated_rigid_[i];
  result.volume_initial = volume_initial_[i];
  if (!model::trustworthy(status)) return result;
  result.pressure_rest = rest_[i];
  result.pressure_actuated = actuated_[i];
  result.pressure_rest_area_mean = rest_force_[i];
  result.pressure_actuated_area_mean = actuated_force_[i];
  model::derive_changes(result);
  result.actuation_drop = drop_[i];
  result.actuation_pressure = actuation_[i];
  result.volume_rest = volume_rest_[i];
  result.volume_actuated = volume_actuated_[i];
  result.volume_change = volume_change_[i];
  result.radius_actuated = radius_[i];
  result.stretch_actual = stretch_[i];
  result.electric_field_max = status == model::Status::pulled_in ? none : field_[i];
  // Of no pressure that might be one, all is in doubt.
  const auto relative = [](double error, double pressure) {
    return pressure > 0 ? error / pressure : error > 0 ? 1.0 : 0.0;
  };
  result.discretisation_error = quadrature_error + std::max(relative(rest_error_[i], rest_[i]),
                                                            relative(actuated_error_[i], actuated_[i]));
  model::derive_error(result);
  return result;
}

}  // namespace gaiter::physics
