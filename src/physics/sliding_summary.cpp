// SPDX-License-Identifier: BSD-2-Clause
#include "gaiter/physics/sliding_summary.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "gaiter/physics/sliding_system.hpp"

namespace gaiter::physics {

namespace {

// Sum over the slices of share dz/dZ quantity: the mean over the height of what lies on the deformed segment.
template <typename Quantity>
double height_mean(const std::vector<SlidingSlice>& slices, Quantity&& quantity) {
  double sum = 0;
  for (const SlidingSlice& slice : slices) sum += slice.share * slice.axial_stretch * quantity(slice);
  return sum;
}

double area_mean_pressure(const std::vector<SlidingSlice>& slices) {
  return height_mean(slices, [](const auto& s) { return s.pressure * s.leg_radius; }) /
         height_mean(slices, [](const auto& s) { return s.tube_radius; });
}

}  // namespace

double height_mean_pressure(const std::vector<SlidingSlice>& slices) {
  return height_mean(slices, [](const auto& s) { return s.pressure; });
}

double sliding_error(const std::vector<SlidingSlice>& slices) {
  static_assert(sliding_degree == 3);
  constexpr double safety = 5, kink = 0.05;
  const double mean = height_mean_pressure(slices);
  if (!(mean > 0)) return 0;
  double sum = 0;
  for (std::size_t k = 0; k + 2 < slices.size(); k += 3) {
    // Legendre coefficients on the element of p = P dz/dZ, from its values at the three Gauss points.
    const auto p = [&](int g) { return slices[k + g].pressure * slices[k + g].axial_stretch; };
    const double first = std::fabs(p(2) - p(0)) * std::sqrt(15.0) / 6;
    const double second = std::fabs(p(0) - 2 * p(1) + p(2)) * 5 / 9;
    const double constant = std::fabs(p(0) + p(1) + p(2)) / 3;
    const double size = std::max({first, constant, 1e-300});
    // The mean is exact up to the fifth coefficient where these fall geometrically; four more such falls.
    const double fall = std::min(1.0, std::max(std::sqrt(second / size), first > 0 ? second / first : 0.0));
    sum += safety * second * std::pow(fall, 4);
    // A kink, where the bandage lifts off, costs Gauss's rule up to 0.017 of the rise within the element.
    const auto [low, high] = std::minmax({p(0), p(1), p(2)});
    const bool beside_lifted =
        (k > 0 && slices[k - 1].pressure == 0) || (k + 3 < slices.size() && slices[k + 3].pressure == 0);
    if (low == 0) sum += kink * high;
    if (low > 0 && beside_lifted) sum += kink * (high - low);
  }
  const double elements = static_cast<double>(slices.size()) / 3;
  return std::max(sum / elements / mean, 4e-16);
}

model::SegmentResult summarise_sliding(const SlidingOutcome& outcome, double height, double lower_radius,
                                       double upper_radius, double reference_radius, double wall_error) {
  model::SegmentResult result;
  result.fidelity = model::Fidelity::sliding;
  result.status = outcome.status;
  result.iterations = outcome.iterations;
  result.pressure_rest_rigid = outcome.pressure_rest_rigid;
  result.pressure_actuated_rigid = outcome.pressure_actuated_rigid;
  result.volume_initial =
      height * M_PI / 3 *
      (lower_radius * lower_radius + lower_radius * upper_radius + upper_radius * upper_radius);
  result.voltage_stable = outcome.voltage_stable;
  constexpr double none = std::numeric_limits<double>::quiet_NaN();
  const bool actuated_found = model::trustworthy(result.status);
  const bool rest_found = actuated_found || std::isfinite(outcome.voltage_stable);
  const auto &rest = outcome.rest, &actuated = outcome.actuated;
  result.pressure_rest = rest_found ? height_mean_pressure(rest) : none;
  result.pressure_actuated = actuated_found ? height_mean_pressure(actuated) : none;
  result.pressure_rest_area_mean = rest_found ? area_mean_pressure(rest) : none;
  result.pressure_actuated_area_mean = actuated_found ? area_mean_pressure(actuated) : none;
  model::derive_changes(result);
  // Formed from the differences of the radii, which a small change needs.
  const auto loss = [&](const std::vector<SlidingSlice>& slices) {
    return height * M_PI * height_mean(slices, [](const auto& s) {
             return (s.leg_radius_before - s.leg_radius) * (s.leg_radius_before + s.leg_radius);
           });
  };
  result.volume_rest = rest_found ? result.volume_initial - loss(rest) : none;
  result.stretch_actual =
      rest_found ? height_mean(rest, [](const auto& s) { return s.tube_radius; }) / reference_radius : none;
  result.discretisation_error = rest_found ? wall_error + sliding_error(rest) : none;
  result.model_error = none;  // ends, bending, shear of the leg
  model::derive_error(result);
  if (!actuated_found) {
    result.actuation_pressure = result.volume_actuated = result.volume_change = result.radius_actuated = none;
    result.slip_max = result.electric_field_max = none;
    return result;
  }
  result.actuation_pressure = height_mean(actuated, [](const auto& s) { return s.actuation_pressure; });
  result.volume_actuated = result.volume_initial - loss(actuated);
  result.volume_change = loss(actuated) / result.volume_initial;
  result.radius_actuated = height_mean(actuated, [](const auto& s) { return s.leg_radius; });
  result.slip_max = outcome.slip_max;
  for (const SlidingSlice& slice : actuated)
    result.electric_field_max = std::max(result.electric_field_max, slice.electric_field);
  if (result.status == model::Status::pulled_in)
    result.electric_field_max = std::numeric_limits<double>::quiet_NaN();
  result.discretisation_error = std::max(result.discretisation_error, wall_error + sliding_error(actuated));
  model::derive_error(result);
  return result;
}

}  // namespace gaiter::physics
