// SPDX-License-Identifier: BSD-2-Clause
#include "gaiter/physics/model_error.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "gaiter/physics/leg_law.hpp"
#include "gaiter/physics/slice_system.hpp"

namespace gaiter::physics {

namespace {

constexpr double vacuum_permittivity = 8.8541878128e-12;  // [F/m]
constexpr double unknown = std::numeric_limits<double>::infinity();
// Of the box that the bounds are fitted in.
constexpr double steepest = 0.364;  // slope: 20 degrees
constexpr double widest = 1.2;      // difference of the radii at both ends, over their mean
constexpr double narrowest = 1.03;  // stretch of the bandage at the narrow end of a leg that has given way
constexpr double softest = 0.7;     // pressure over the shear modulus of the leg
// K, beyond which the tube is close to buckling; under voltage, which takes its tension away, the less.
constexpr double softest_at_rest = 6, softest_energised = 4;
// K m H/R, beyond which there is often no stable state without friction.
constexpr double largest_slide = 0.8;

// How far that box is left for bounds of the pressures alone. Of 644 segments drawn in there, most at up to
// 80 % of their last stable voltage, one had no stable state; of 216 outside, 123.
constexpr double widest_slide = 1.4;
constexpr double wide_softest_at_rest = 25, wide_softest_energised = 16;
constexpr double most_work = 3.2;  // strain of the leg times pressure over its shear modulus: crushed
constexpr double wide_narrowest = 0.9;
constexpr double most_sheared = 12;  // K^2 m H/R times pressure over the leg's shear modulus: it folds along

// The leg at its mean radius under a pressure P: its strain eps, and derivatives with respect to ln P.
struct LegAnswer {
  double strain = 0;
  double softness = 0;        // -d ln(1 - eps)
  double softness_slope = 0;  // d softness
  double volume_slope = 0;    // d ln v, v = eps (2 - eps) the part of the volume that is lost
  double volume_bend = 0;     // d volume_slope
};

LegAnswer leg_answer(const model::Leg& leg, const model::Segment& segment, double pressure, double lost) {
  LegAnswer answer;
  if (leg.model == model::LegModel::rigid) return answer;
  const LegConstants constants = leg_constants(leg, segment);
  const double p = pressure / constants.pressure_scale;
  double strain = 0, first = 0, second = 0;  // derivatives with respect to p, times p and p^2
  if (leg.material == model::LegMaterial::neo_hookean) {
    const double bulk = constants.value[0], shear = constants.value[1], y = 1 - lost;
    strain = 1 - std::sqrt(y);
    const double power = shear * std::pow(y, -5.0 / 3);
    const double p_y = -bulk - power - 5.0 / 3 * lost * power / y;
    const double p_yy = 10.0 / 3 * power / y + 40.0 / 9 * lost * power / (y * y);
    const double slope = -2 * (1 - strain) * p_y, bend = 4 * y * p_yy + 2 * p_y;
    first = p / slope;
    second = -p * p * bend / (slope * slope * slope);
  } else {
    const auto [a, c, none, decay] = constants.value;
    const double grown = a * std::expm1(p), decayed = c * std::expm1(decay * p);
    strain = none + grown + decayed;
    first = p * (grown + a + decay * (decayed + c));
    second = p * p * (grown + a + decay * decay * (decayed + c));
  }
  const double rest = 1 - strain, volume = strain * (2 - strain);
  answer.strain = strain;
  answer.softness = first / rest;
  answer.softness_slope = answer.softness + second / rest + answer.softness * answer.softness;
  answer.volume_slope = 2 * rest * first / volume;
  answer.volume_bend = answer.volume_slope + 2 * (rest * second - first * first) / volume -
                       answer.volume_slope * answer.volume_slope;
  return answer;
}

// Derivatives of the tube's energy per volume W, a membrane's, with respect to the logarithms x of the
// stretch around it and y of that along it, at y = 0.
struct TubeEnergy {
  double x = 0, y = 0, xx = 0, xy = 0, yy = 0, xxx = 0, xxy = 0, xyy = 0;
};

// `log_stretch`: x at the middle of the wall; `field`: of a layer before it is stretched [V/m].
TubeEnergy tube_energy(const model::Bandage& bandage, double log_stretch, double field) {
  TubeEnergy w;
  for (const model::OgdenTerm& term : bandage.ogden) {
    const double around = term.mu * std::exp(term.alpha * log_stretch), along = term.mu,
                 across = term.mu * (term.mu / around), a = term.alpha;
    w.x += around - across;
    w.y += along - across;
    w.xx += a * (around + across);
    w.xy += a * across;
    w.yy += a * (along + across);
    w.xxx += a * a * (around - across);
    w.xxy -= a * a * across;
    w.xyy -= a * a * across;
  }
  if (field == 0) return w;
  // Less the electric energy, eps E^2 e^{2 (x + y)}/2.
  const double stress =
      vacuum_permittivity * bandage.permittivity * field * field * std::exp(2 * log_stretch);
  w.x -= stress;
  w.y -= stress;
  w.xx -= 2 * stress;
  w.xy -= 2 * stress;
  w.yy -= 2 * stress;
  w.xxx -= 4 * stress;
  w.xxy -= 4 * stress;
  w.xyy -= 4 * stress;
  return w;
}

// What the shifts and their bounds are made of, in one state.
struct State {
  ModelShift pressure, volume;
  double k = 0;             // K
  double slide = 0;         // K m H/R: how much the axial stretch differs between the ends
  double strain = 0;        // of the leg
  double leg_share = 0;     // part of a change of pressure that the leg's giving way takes off
  double slope_square = 0;  // m^2
  double reach_square = 0;  // (m H/R)^2
  double stretch = 1;       // of the bandage, at the mean radius
  double narrow = 1;        // and at the narrow end
  bool axially_stable = true;
};

State state_of(const model::Scene& scene, std::size_t index, double pressure, double lost, double voltage) {
  const model::Segment& segment = scene.leg.segments[index];
  const double radius = segment.mean_radius();
  const double slope = (segment.upper_radius - segment.lower_radius) / segment.height;
  const Wall wall = reference_wall(scene.bandage, scene.bandage.modules[index], radius, radius);
  const LegAnswer leg = leg_answer(scene.leg, segment, pressure, lost);

  const double inner = radius * (1 - leg.strain), before = wall.inner_radius + 0.5 * wall.thickness;
  const double stretch =
      std::sqrt(1 + (inner - wall.inner_radius) * (inner + wall.inner_radius) / (before * before));
  const TubeEnergy w =
      tube_energy(scene.bandage, std::log(stretch), voltage * scene.bandage.layers / scene.bandage.thickness);

  // ln P = ln W_x - 2 x - y, and with x = ln R + ln(1 - eps(P)) its derivatives with respect to ln R (r) and
  // y.
  const double share = w.xx / w.x, turn = w.xy / w.x, tension = w.y / w.x;
  const double f_x = share - 2, f_y = turn - 1, f_xx = w.xxx / w.x - share * share,
               f_xy = w.xxy / w.x - share * turn, f_yy = w.xyy / w.x - turn * turn;
  const double soft = leg.softness, given = 1 / (1 + soft * f_x);
  const double p_r = f_x * given, p_y = f_y * given, x_y = -soft * p_y;
  const double p_ry = given * (f_xy * given - p_y * (leg.softness_slope * p_r * f_x + soft * f_xx * given));
  const double p_yy =
      given * (f_yy + f_xy * x_y - p_y * (leg.softness_slope * p_y * f_x + soft * (f_xx * x_y + f_xy)));

  // Axial stiffness of the tube on its leg, over W_x, and K.
  const double coupling = 1 - turn;
  const double stiffness =
      w.yy / w.x - tension - (soft > 0 ? coupling * coupling * soft / (soft * (share - 2) + 1) : 0);
  const double k = -coupling * given / stiffness;

  constexpr double second_order = 0.35;  // the parabola overestimates long slides; fitted
  const double reach = slope * segment.height / radius;
  State state;
  state.k = k;
  state.slide = k * reach;
  const double scale = reach * reach / 12 / (1 + second_order * std::fabs(state.slide));
  const auto sliding = [&](double q_r, double q_y, double q_ry, double q_yy) {
    return scale * k * (0.5 * k * (q_y + q_yy + q_y * q_y) - (q_ry + q_r * q_y));
  };
  const double square = slope * slope;
  state.pressure = {sliding(p_r, p_y, p_ry, p_yy), 0.5 * square * turn * given, -square * tension * given};
  const double g = leg.volume_slope, bend = leg.volume_bend;
  const double v_r = 2 + g * p_r;
  state.volume = {sliding(v_r, g * p_y, g * p_ry + bend * p_r * p_y, g * p_yy + bend * p_y * p_y),
                  g * state.pressure.slope, square * tension * given * (g * (v_r - 1 - p_r) + bend * p_r)};
  state.strain = leg.strain;
  state.leg_share = 1 - given;
  state.slope_square = square;
  state.reach_square = reach * reach;
  state.stretch = stretch;
  state.narrow = stretch * (1 - 0.5 * std::fabs(reach));
  state.axially_stable = stiffness > 0 && given > 0;
  return state;
}

// Of the leg's shear modulus: the pressure at rest over it, and it over the leg's stiffness against a small
// uniform pressure.
struct LegShear {
  double load = 0, part = 0;
};

LegShear leg_shear(const model::Leg& leg, const model::Segment& segment, double pressure) {
  const LegConstants constants = leg_constants(leg, segment);
  const bool law = leg.material == model::LegMaterial::compliance;
  const double modulus = law ? leg.shear_modulus : 3 * constants.value[1] * constants.pressure_scale;
  const double softness = law ? constants.value[0] + constants.value[1] * constants.value[3] : 0.5;
  return {pressure / modulus, modulus * softness / constants.pressure_scale};
}

// Of the walls and stretches that bounds are fitted to.
struct Range {
  double thinnest = 0.0025, thickest = 0.05;  // wall over radius
  double loosest = 1.06, tightest = 2.2;      // stretch
};
constexpr Range wide_range{0.0015, 0.08, 1.045, 2.65};

// Whether the segment lies in the box that the bounds are fitted in.
bool in_box(const model::Scene& scene, std::size_t index, const Range& range = {}) {
  const model::Segment& segment = scene.leg.segments[index];
  const double radius = segment.mean_radius(), rise = std::fabs(segment.upper_radius - segment.lower_radius);
  const Wall wall = reference_wall(scene.bandage, scene.bandage.modules[index], radius, radius);
  const auto within = [](double value, double low, double high) {
    return value >= low * (1 - 1e-9) && value <= high * (1 + 1e-9);
  };
  bool terms = true;
  for (const model::OgdenTerm& term : scene.bandage.ogden)
    terms = terms && term.mu * term.alpha > 0 && within(term.alpha, -2, 12.2);
  return terms && rise <= steepest * segment.height && rise <= widest * radius &&
         within(segment.height / radius, 0.3, 5) &&
         within(wall.thickness / radius, range.thinnest, range.thickest) &&
         within(radius / (wall.inner_radius + wall.thickness), range.loosest, range.tightest);
}

bool in_box(const State& state, double softest_tube) {
  return state.axially_stable && std::fabs(state.k) <= softest_tube &&
         std::fabs(state.slide) <= largest_slide && state.strain <= 0.3 && state.narrow >= narrowest;
}

bool in_wide_box(const State& state, const LegShear& leg, double softest_tube) {
  return state.axially_stable && std::fabs(state.k) <= softest_tube &&
         std::fabs(state.slide) <= widest_slide && state.strain * leg.load <= most_work &&
         std::fabs(state.k * state.slide) * leg.load <= most_sheared && state.narrow >= wide_narrowest;
}

// Both states of a segment, which of them are inside of the box, and what the leg's shear has to say.
struct States {
  State rest, actuated;
  bool rest_known = false, actuated_known = false;
  bool rest_bounded = false, actuated_bounded = false;  // in the wide box
  LegShear shear;
};

States states_of(const model::Scene& scene, std::size_t segment, const model::SegmentResult& slices) {
  States states;
  const bool in_contact =
      slices.status == model::Status::contact || slices.status == model::Status::extrapolated;
  if (!in_contact || !(slices.pressure_rest > 0) || !(slices.pressure_actuated > 0)) return states;
  const double voltage = scene.bandage.modules[segment].voltage;
  states.rest =
      state_of(scene, segment, slices.pressure_rest, 1 - slices.volume_rest / slices.volume_initial, 0);
  states.actuated = voltage == 0
                        ? states.rest
                        : state_of(scene, segment, slices.pressure_actuated, slices.volume_change, voltage);
  bool known = in_box(scene, segment);
  bool bounded = in_box(scene, segment, wide_range) && scene.contact_axial == model::ContactAxial::free;
  if (scene.leg.model == model::LegModel::compliant) {
    states.shear = leg_shear(scene.leg, scene.leg.segments[segment], slices.pressure_rest);
    bounded = bounded && states.shear.part >= 0.04 && states.shear.part <= 1;
    known = known && states.shear.load <= softest && states.shear.part >= 0.04 && states.shear.part <= 1;
  }
  states.rest_known = known && in_box(states.rest, softest_at_rest);
  states.actuated_known = states.rest_known && (voltage == 0 || in_box(states.actuated, softest_energised));
  states.rest_bounded = bounded && in_wide_box(states.rest, states.shear, wide_softest_at_rest);
  states.actuated_bounded = states.rest_bounded && (voltage == 0 || in_wide_box(states.actuated, states.shear,
                                                                                wide_softest_energised));
  if (scene.contact_axial == model::ContactAxial::held)
    for (State* state : {&states.rest, &states.actuated}) state->pressure.sliding = state->volume.sliding = 0;
  return states;
}

// What is added to the size of the shifts that a model lacks, so that the sum exceeds its difference to the
// finite elements in 99 of 100 cases: parts of the shifts and of what they leave out. Fitted by quantile
// regression to the segments of benchmarks/model_map.py, each weighed by one over its true difference.
struct Bound {
  double floor;                 // of the finite elements' own error
  double sliding, slope, ends;  // of the shifts
  double stiff_slope;           // of slope times leg_share
  double share;                 // of slope_square times (leg_share + shear modulus over stiffness of the leg)
  double shear;                 // of reach_square times pressure over shear modulus

  double operator()(const ModelShift& shift, const State& state, const LegShear& leg) const {
    return floor + sliding * std::fabs(shift.sliding) + slope * std::fabs(shift.slope) +
           ends * std::fabs(shift.ends) + stiff_slope * std::fabs(shift.slope) * state.leg_share +
           share * state.slope_square * (state.leg_share + leg.part) + shear * state.reach_square * leg.load;
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

  double operator()(double lacking, const ModelShift& shift, const State& state, const LegShear& leg) const {
    // How close the narrow end is to leaving the leg: 1 where it does.
    const double reach = (state.stretch - state.narrow) / (state.stretch - 1);
    const double loose = std::min(1.2, reach * reach), square = state.slope_square, share = state.leg_share;
    const double beyond = leg_shear * square * leg.load / (1 + leg.load) + slack * shift.slope * loose +
                          slope_share * shift.slope * share + ends_share * shift.ends * share +
                          square * (this->share * share + strain * state.strain);
    const double bound = floor + sliding * std::fabs(shift.sliding) +
                         std::fabs(shift.slope) * (slope + stiff_slope * share + slack_slope * loose) +
                         slack_ends * std::fabs(shift.ends) * loose +
                         sheared_leg * std::fabs(state.k * state.slide) * leg.load;
    return caution * (std::fabs(lacking + beyond) + bound);
  }
};

constexpr WideBound wide_slice_bound{1,    0.21, -0.316, -0.804, -0.388, -0.124, -0.339,
                                     2e-4, 0.16, 0.23,   0.19,   0.37,   0.26,   1.6e-3};
constexpr WideBound wide_sliding_bound{1.2,  0.171, 0.159, -0.68, -2.08, -0.392, 0.256,
                                       2e-4, 0.061, 0.21,  1.4,   0,     0.7,    2e-3};

}  // namespace

ModelShifts model_shifts(const model::Scene& scene, std::size_t segment, const model::SegmentResult& slices) {
  const States states = states_of(scene, segment, slices);
  return {states.rest.pressure,   states.actuated.pressure, states.rest.volume,
          states.actuated.volume, states.rest_known,        states.actuated_known};
}

ModelErrors model_errors(const model::Scene& scene, std::size_t segment, const model::SegmentResult& slices) {
  const States states = states_of(scene, segment, slices);
  const State &rest = states.rest, &actuated = states.actuated;
  // The drop is the difference of two pressures whose shifts are much the same.
  const double drop = slices.pressure_rest - slices.pressure_actuated;
  const auto drop_part = [&](double ModelShift::*part) {
    return (slices.pressure_rest * rest.pressure.*part - slices.pressure_actuated * actuated.pressure.*part) /
           drop;
  };
  ModelShift dropped;
  if (drop > 0)
    dropped = {drop_part(&ModelShift::sliding), drop_part(&ModelShift::slope), drop_part(&ModelShift::ends)};
  const auto errors = [&](const Bounds& bounds, const WideBound& wide, auto&& lacking) {
    const auto bounded = [&](const Bound& bound, const ModelShift& shift, const State& state) {
      return std::fabs(lacking(shift)) + bound(shift, state, states.shear);
    };
    ModelError error{unknown, unknown, unknown, unknown};
    // Without voltage, and on a leg that does not give way, all models agree on nothing.
    if (scene.bandage.modules[segment].voltage == 0) error.actuation_drop = 0;
    if (scene.leg.model == model::LegModel::rigid) error.volume_change = 0;
    if (states.rest_known) error.pressure_rest = bounded(bounds.pressure, rest.pressure, rest);
    const auto widely = [&](const ModelShift& shift, const State& state) {
      return wide(lacking(shift), shift, state, states.shear);
    };
    if (!states.rest_known && states.rest_bounded) error.pressure_rest = widely(rest.pressure, rest);
    if (!states.actuated_known && states.actuated_bounded)
      error.pressure_actuated = widely(actuated.pressure, actuated);
    if (!states.actuated_known) return error;
    error.pressure_actuated = bounded(bounds.pressure, actuated.pressure, actuated);
    if (scene.bandage.modules[segment].voltage != 0 && drop > 0)
      error.actuation_drop = bounded(bounds.drop, dropped, actuated);
    if (actuated.strain > 0) error.volume_change = bounded(bounds.volume, actuated.volume, actuated);
    return error;
  };
  return {errors(slice_bounds, wide_slice_bound, [](const ModelShift& shift) { return shift.all(); }),
          errors(sliding_bounds, wide_sliding_bound, [](const ModelShift& shift) { return shift.ends; })};
}

}  // namespace gaiter::physics
