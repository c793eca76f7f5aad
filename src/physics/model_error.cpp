// SPDX-License-Identifier: BSD-2-Clause
#include "gaiter/physics/model_error.hpp"

#include <algorithm>
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

  // `load`, `part`: of the leg's shear, see States.
  double operator()(const ModelShift& shift, const State<double>& state, double load, double part) const {
    return floor + sliding * std::fabs(shift.sliding) + slope * std::fabs(shift.slope) +
           ends * std::fabs(shift.ends) + stiff_slope * std::fabs(shift.slope) * state.leg_share +
           share * state.slope_square * (state.leg_share + part) + shear * state.reach_square * load;
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

// What the shifts leave out, as far as it is known, and a bound of the rest: for 97 of 100 of the states in
// the wide box, fitted to 426 segments there of two Sobol sequences (sobol_scenes.hpp from 0 on,
// model_error_draws.hpp from 40000 on).
struct WideBound {
  double caution;
  double leg_shear, slack, slope_share, ends_share, share, strain;                  // signed
  double floor, sliding, slope, stiff_slope, slack_slope, slack_ends, sheared_leg;  // of the bound

  // `lacking`: of the shift, what the model does not have.
  double operator()(double lacking, const ModelShift& shift, const State<double>& state, double load) const {
    // How close the narrow end is to leaving the leg: 1 where it does.
    const double reach = (state.stretch - state.narrow) / (state.stretch - 1);
    const double loose = std::min(1.2, reach * reach), square = state.slope_square, given = state.leg_share;
    const double beyond = leg_shear * square * load / (1 + load) + slack * shift.slope * loose +
                          slope_share * shift.slope * given + ends_share * shift.ends * given +
                          square * (share * given + strain * state.strain);
    const double bound = floor + sliding * std::fabs(shift.sliding) +
                         std::fabs(shift.slope) * (slope + stiff_slope * given + slack_slope * loose) +
                         slack_ends * std::fabs(shift.ends) * loose +
                         sheared_leg * std::fabs(state.k * state.slide) * load;
    return caution * (std::fabs(lacking + beyond) + bound);
  }
};

constexpr WideBound wide_slice_bound{.caution = 1,
                                     .leg_shear = 0.21,
                                     .slack = -0.316,
                                     .slope_share = -0.804,
                                     .ends_share = -0.388,
                                     .share = -0.124,
                                     .strain = -0.339,
                                     .floor = 2e-4,
                                     .sliding = 0.16,
                                     .slope = 0.23,
                                     .stiff_slope = 0.19,
                                     .slack_slope = 0.37,
                                     .slack_ends = 0.26,
                                     .sheared_leg = 1.6e-3};
constexpr WideBound wide_sliding_bound{.caution = 1.2,
                                       .leg_shear = 0.171,
                                       .slack = 0.159,
                                       .slope_share = -0.68,
                                       .ends_share = -2.08,
                                       .share = -0.392,
                                       .strain = 0.256,
                                       .floor = 2e-4,
                                       .sliding = 0.061,
                                       .slope = 0.21,
                                       .stiff_slope = 1.4,
                                       .slack_slope = 0,
                                       .slack_ends = 0.7,
                                       .sheared_leg = 2e-3};

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

// What the bounds need of a pack's state, at one place.
inline State<double> at(const State<Pack>& states, int i) {
  State<double> state{};
  state.k = states.k[i];
  state.slide = states.slide[i];
  state.strain = states.strain[i];
  state.leg_share = states.leg_share[i];
  state.slope_square = states.slope_square[i];
  state.reach_square = states.reach_square[i];
  state.stretch = states.stretch[i];
  state.narrow = states.narrow[i];
  return state;
}

GAITER_MULTIVERSION
void bound_pressure(const State<Pack>& state, const Pack& known, const Pack& bounded,
                    const States<Pack>& states, Pack& error) {
  for (int i = 0; i < pack_width; ++i) {
    const ModelShift shift{state.pressure_sliding[i], state.pressure_slope[i], state.pressure_ends[i]};
    const double load = states.shear_load[i], lacking = shift.all();
    const double bound =
        std::fabs(lacking) + slice_bounds.pressure(shift, at(state, i), load, states.shear_part[i]);
    const double wide = wide_slice_bound(lacking, shift, at(state, i), load);
    const double here = known[i] > 0 ? bound : bounded[i] > 0 ? wide : unknown;
    error[i] = error[i] < here ? here : error[i];
  }
}

GAITER_MULTIVERSION
void find_highest(const Pack& mean, const State<Pack>& state, Pack& highest) {
  for (int i = 0; i < pack_width; ++i)
    highest[i] = mean[i] * exp(0.5 * std::fabs(state.growth[i]) * std::sqrt(state.reach_square[i]));
}

}  // namespace

void bound_slice_pressures(const SegmentPack& segments, model::LegMaterial material,
                           const SlicesFound& slices, Pack& error, Pack& highest) {
  States<Pack> states;
  find_model_states(segments, material, slices, {}, states);
  for (int i = 0; i < pack_width; ++i) error[i] = 0;
  bound_pressure(states.rest, states.rest_known, states.rest_bounded, states, error);
  bound_pressure(states.actuated, states.actuated_known, states.actuated_bounded, states, error);
  find_highest(slices.pressure_rest, states.rest, highest);
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
  const auto errors = [&](const Bounds& bounds, const WideBound& wide, auto&& lacking) {
    const auto bounded = [&](const Bound& bound, const ModelShift& shift, const State<double>& state) {
      return std::fabs(lacking(shift)) + bound(shift, state, states.shear_load, states.shear_part);
    };
    const auto widely = [&](const ModelShift& shift, const State<double>& state) {
      return wide(lacking(shift), shift, state, states.shear_load);
    };
    ModelError error{unknown, unknown, unknown, unknown};
    // Without voltage, and on a leg that does not give way, all models agree on nothing.
    if (scene.bandage.modules[segment].voltage == 0) error.actuation_drop = 0;
    if (scene.leg.model == model::LegModel::rigid) error.volume_change = 0;
    if (states.rest_known > 0)
      error.pressure_rest = bounded(bounds.pressure, at_rest, rest);
    else if (states.rest_bounded > 0)
      error.pressure_rest = widely(at_rest, rest);
    if (!(states.actuated_known > 0) && states.actuated_bounded > 0)
      error.pressure_actuated = widely(under_voltage, actuated);
    if (!(states.actuated_known > 0)) return error;
    error.pressure_actuated = bounded(bounds.pressure, under_voltage, actuated);
    if (scene.bandage.modules[segment].voltage != 0 && drop > 0)
      error.actuation_drop = bounded(bounds.drop, dropped, actuated);
    if (actuated.strain > 0) error.volume_change = bounded(bounds.volume, volume_shift(actuated), actuated);
    return error;
  };
  return {errors(slice_bounds, wide_slice_bound, [](const ModelShift& shift) { return shift.all(); }),
          errors(sliding_bounds, wide_sliding_bound, [](const ModelShift& shift) { return shift.ends; })};
}

}  // namespace gaiter::physics
