// SPDX-License-Identifier: BSD-2-Clause
#include "gaiter/physics/model_error.hpp"

#include <cmath>
#include <limits>

namespace gaiter::physics {

namespace {

constexpr double unknown = std::numeric_limits<double>::infinity();

// What is added to the size of the shifts that a model lacks, so that the sum exceeds its difference to the
// finite elements in 99 of 100 cases: parts of the shifts and of what they leave out. Fitted by quantile
// regression to the segments of benchmarks/model_map.py, each weighed by one over its true difference.
struct Bound {
  double floor;                 // of the finite elements' own error
  double sliding, slope, ends;  // of the shifts
  double stiff_slope;           // of slope times leg_share
  double share;                 // of slope_square times (leg_share + shear modulus over stiffness of the leg)
  double shear;                 // of reach_square times pressure over shear modulus

  // What the leg's shear has to say: see States.
  double operator()(const ModelShift& shift, double leg_share, double slope_square, double reach_square,
                    double load, double part) const {
    return floor + sliding * std::fabs(shift.sliding) + slope * std::fabs(shift.slope) +
           ends * std::fabs(shift.ends) + stiff_slope * std::fabs(shift.slope) * leg_share +
           share * slope_square * (leg_share + part) + shear * reach_square * load;
  }
};

struct Bounds {
  Bound pressure, volume, drop;
};

constexpr Bounds slice_bounds{
    .pressure = {2e-4, 0.54, 0.1, 0, 0, 0, 0.05},
    .volume = {5e-4, 0.33, 1.6, 1.6, 0, 0.23, 0.1},
    .drop = {1e-3, 0.35, 0.1, 0.35, 0, 0, 2.2},
};
constexpr Bounds sliding_bounds{
    .pressure = {2e-4, 0.08, 0.27, 0, 3, 0, 0.35},
    .volume = {6e-4, 0.4, 0.85, 0.25, 0, 0.5, 0.25},
    .drop = {1e-3, 0.25, 0.3, 0.1, 3.9, 0, 0.5},
};

// Of one segment; without contact all are 0.
States<double> states_of(const model::Scene& scene, std::size_t segment, const model::SegmentResult& slices) {
  States<double> one{};
  const bool in_contact =
      slices.status == model::Status::contact || slices.status == model::Status::extrapolated;
  if (!in_contact || !(slices.pressure_rest > 0) || !(slices.pressure_actuated > 0)) return one;
  static const Quadrature none;
  SegmentPack segments;
  segments.set(0, segment_numbers(scene, segment), scene.bandage, none);
  SlicesFound found;
  found.in_contact[0] = 1;
  found.pressure_rest[0] = slices.pressure_rest;
  found.pressure_actuated[0] = slices.pressure_actuated;
  found.lost_at_rest[0] = 1 - slices.volume_rest / slices.volume_initial;
  found.lost_actuated[0] = slices.volume_change;
  States<Pack> states;
  find_model_states(segments, scene.leg.material, found, {0, 1}, states);
  const Pack* from = reinterpret_cast<const Pack*>(&states);
  double* to = reinterpret_cast<double*>(&one);
  for (std::size_t row = 0; row < sizeof one / sizeof *to; ++row) to[row] = from[row][0];
  return one;
}

ModelShift pressure_shift(const State<double>& state) {
  return {state.pressure_sliding, state.pressure_slope, state.pressure_ends};
}

ModelShift volume_shift(const State<double>& state) {
  return {state.volume_sliding, state.volume_slope, state.volume_ends};
}

GAITER_MULTIVERSION
void bound_pressure(const State<Pack>& state, const Pack& known, const States<Pack>& states, Pack& error) {
  for (int i = 0; i < pack_width; ++i) {
    const ModelShift shift{state.pressure_sliding[i], state.pressure_slope[i], state.pressure_ends[i]};
    const double bound =
        std::fabs(shift.all()) + slice_bounds.pressure(shift, state.leg_share[i], state.slope_square[i],
                                                       state.reach_square[i], states.shear_load[i],
                                                       states.shear_part[i]);
    const double here = known[i] > 0 ? bound : unknown;
    error[i] = error[i] < here ? here : error[i];
  }
}

}  // namespace

void bound_slice_pressures(const SegmentPack& segments, model::LegMaterial material,
                           const SlicesFound& slices, Pack& error) {
  States<Pack> states;
  find_model_states(segments, material, slices, {}, states);
  for (int i = 0; i < pack_width; ++i) error[i] = 0;
  bound_pressure(states.rest, states.rest_known, states, error);
  bound_pressure(states.actuated, states.actuated_known, states, error);
}

ModelShifts model_shifts(const model::Scene& scene, std::size_t segment, const model::SegmentResult& slices) {
  const States<double> states = states_of(scene, segment, slices);
  return {pressure_shift(states.rest),   pressure_shift(states.actuated), volume_shift(states.rest),
          volume_shift(states.actuated), states.rest_known > 0,           states.actuated_known > 0};
}

ModelErrors model_errors(const model::Scene& scene, std::size_t segment, const model::SegmentResult& slices) {
  const States<double> states = states_of(scene, segment, slices);
  const State<double>&rest = states.rest, &actuated = states.actuated;
  const ModelShift at_rest = pressure_shift(rest), under_voltage = pressure_shift(actuated);
  // The drop is the difference of two pressures whose shifts are much the same.
  const double drop = slices.pressure_rest - slices.pressure_actuated;
  const auto drop_part = [&](double ModelShift::*part) {
    return (slices.pressure_rest * at_rest.*part - slices.pressure_actuated * under_voltage.*part) / drop;
  };
  ModelShift dropped;
  if (drop > 0)
    dropped = {drop_part(&ModelShift::sliding), drop_part(&ModelShift::slope), drop_part(&ModelShift::ends)};
  const auto errors = [&](const Bounds& bounds, auto&& lacking) {
    const auto bounded = [&](const Bound& bound, const ModelShift& shift, const State<double>& state) {
      return std::fabs(lacking(shift)) + bound(shift, state.leg_share, state.slope_square, state.reach_square,
                                               states.shear_load, states.shear_part);
    };
    ModelError error{unknown, unknown, unknown, unknown};
    // Without voltage, and on a leg that does not give way, all models agree on nothing.
    if (scene.bandage.modules[segment].voltage == 0) error.actuation_drop = 0;
    if (scene.leg.model == model::LegModel::rigid) error.volume_change = 0;
    if (states.rest_known > 0) error.pressure_rest = bounded(bounds.pressure, at_rest, rest);
    if (!(states.actuated_known > 0)) return error;
    error.pressure_actuated = bounded(bounds.pressure, under_voltage, actuated);
    if (scene.bandage.modules[segment].voltage != 0 && drop > 0)
      error.actuation_drop = bounded(bounds.drop, dropped, actuated);
    if (actuated.strain > 0) error.volume_change = bounded(bounds.volume, volume_shift(actuated), actuated);
    return error;
  };
  return {errors(slice_bounds, [](const ModelShift& shift) { return shift.all(); }),
          errors(sliding_bounds, [](const ModelShift& shift) { return shift.ends; })};
}

}  // namespace gaiter::physics
