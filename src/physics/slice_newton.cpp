// SPDX-License-Identifier: BSD-2-Clause
#include "gaiter/physics/slice_newton.hpp"

#include "gaiter/physics/slice_kernel.hpp"

namespace gaiter::physics {

namespace {

constexpr double epsilon = 2.2e-16;
constexpr double single_epsilon = 1.2e-7;  // of the exponentials and logarithms, where these are single
constexpr double reachable_in_single = 2 * single_epsilon;
constexpr double rounding_caution = 8, caution_in_single = 4;  // of estimates of rounding errors
constexpr double left_caution = 3;                             // of what the last step leaves
// A priori estimates of the quadrature through the wall can be a few times too low where it is almost exact.
constexpr double wall_caution = 16, smallest_sure_wall_error = 1e-12;
// Part of the leg's pressure by which the bandage may be below 0 in a state that is called close to
// equilibrium.
constexpr double crushing = 1e4;
constexpr double far =
    4;  // ratio of the bandage's and the leg's pressure beyond which logarithms are compared

#define GAITER_EACH for (int i = 0; i < pack_width; ++i)

inline __attribute__((always_inline)) bool any(const Pack& flags) {
  int found = 0;  // a sum of doubles would be taken one by one
  GAITER_EACH found |= flags[i] > 0;
  return found != 0;
}

// f and f' of one slice from its block.
inline __attribute__((always_inline)) double scalar_slope(const PackState& state, int i) {
  return 1 - state.bandage_slope[i] * state.strain_slope[i];
}

inline __attribute__((always_inline)) void initialise(PackState& state) {
  GAITER_EACH {
    state.low[i] = -1;
    state.smallest_slope[i] = 1;
    state.iterations[i] = state.failed[i] = state.left[i] = 0;
    state.open[i] = 1;
  }
}

}  // namespace

GAITER_MULTIVERSION
void start_at_rest(const SliceShape& shape, const Pack* rows, PackState& state, Pack& rigid_pressure) {
  Pack rigid_slope, capped;
  GAITER_EACH state.strain[i] = 0;
  bandage_pressure(shape, rows, state.strain, rigid_pressure, rigid_slope);
  initialise(state);
  const Pack& limit = rows[SliceShape::pressure_limit];
  GAITER_EACH {
    const double rigid = rigid_pressure[i] > 0 ? rigid_pressure[i] : 0;
    capped[i] = rigid > limit[i] ? 1 : 0;
    state.high[i] = limit[i];
    state.rounding[i] = 0;
    state.pressure[i] = capped[i] > 0 ? limit[i] : rigid;
  }
  leg_strain(shape, rows, state.pressure, state.strain, state.strain_slope);
  // With the bandage as a power law, P = rigid exp(-k eps): one Newton step for ln P + k eps_r(P) = ln rigid.
  // A bandage so stiff that it would crush the leg starts where it goes slack instead.
  GAITER_EACH {
    const double k = rigid_pressure[i] > 0 ? -rigid_slope[i] / rigid_pressure[i] : 0;
    const double pressure = state.pressure[i];
    state.settled_slope[i] = rigid_slope[i];
    const double step = -pressure * k * state.strain[i] / (1 + pressure * k * state.strain_slope[i]);
    const double moved = pressure + step > 0 ? pressure + step : 0.5 * pressure;
    const double kept = capped[i] > 0 || moved >= limit[i] ? pressure : moved;
    state.strain[i] += state.strain_slope[i] * (kept - pressure);
    state.pressure[i] = kept;
  }
}

GAITER_MULTIVERSION
void start_actuated(const SliceShape& shape, const Pack* rows, PackState& state) {
  Pack relief, slope, pressure_at_most;
  // The one at rest may be a little larger than where an early end left it.
  GAITER_EACH pressure_at_most[i] = state.pressure[i] + (state.may_leave[i] > 0 ? state.left[i] : 0);
  initialise(state);
  actuation_pressure(shape, rows, state.strain, relief, slope);
  GAITER_EACH {
    const bool pressing = state.pressure[i] > 0;
    state.high[i] = pressure_at_most[i];
    state.rounding[i] = state.pressure[i];
    state.open[i] = pressing ? 1 : 0;
    state.strain_residual[i] = 0;
    state.pressure_residual[i] = pressing ? relief[i] : 0;
    state.bandage_slope[i] -= pressing ? slope[i] : 0;
  }
}

void start_fixed_point(bool at_rest, PackState& state) {
  initialise(state);
  if (at_rest) GAITER_EACH state.strain[i] = state.pressure[i] = 0;
  GAITER_EACH state.rounding[i] = state.pressure[i];
}

GAITER_MULTIVERSION
void evaluate_residual(const SliceShape& shape, const Pack* rows, PackState& state) {
  Pack strain, pressure;
  leg_strain(shape, rows, state.pressure, strain, state.strain_slope);
  bandage_pressure(shape, rows, state.strain, pressure, state.bandage_slope);
  GAITER_EACH {
    state.strain_residual[i] = state.strain[i] - strain[i];
    const bool pressing = state.pressure[i] > 0 || pressure[i] > 0;
    state.pressure_residual[i] = state.pressure[i] - (pressing ? pressure[i] : 0);
    state.bandage_slope[i] = pressing ? state.bandage_slope[i] : 0;
  }
}

void evaluate_open(const SliceShape& shape, const Pack* rows, PackState& state) {
  const Pack strain_slope = state.strain_slope, bandage_slope = state.bandage_slope;
  evaluate_residual(shape, rows, state);
  GAITER_EACH {
    const bool open = state.open[i] > 0;
    state.strain_slope[i] = open ? state.strain_slope[i] : strain_slope[i];
    state.bandage_slope[i] = open ? state.bandage_slope[i] : bandage_slope[i];
  }
}

GAITER_MULTIVERSION
void solve_blocks(const Pack& strain_slope, const Pack& bandage_slope, const Pack& strain_residual,
                  const Pack& pressure_residual, Pack& strain_direction, Pack& pressure_direction) {
  GAITER_EACH {
    const double determinant = 1 - bandage_slope[i] * strain_slope[i];
    pressure_direction[i] = (pressure_residual[i] + bandage_slope[i] * strain_residual[i]) / determinant;
    strain_direction[i] = strain_residual[i] + strain_slope[i] * pressure_direction[i];
  }
}

double reachable(const SliceShape& shape, double tolerance) {
  return shape.single && tolerance < reachable_in_single ? reachable_in_single : tolerance;
}

GAITER_MULTIVERSION
void advance_newton(const SliceShape& shape, const Pack* rows, const Pack& direction, double tolerance,
                    PackState& state) {
  tolerance = reachable(shape, tolerance);
  const double finest = shape.single ? single_epsilon : epsilon;
  const double coarse = shape.single ? caution_in_single * single_epsilon : 0;
  Pack trial, quadratic, remote;
  GAITER_EACH {
    const double pressure = state.pressure[i];
    const double bandage = pressure - state.pressure_residual[i];
    trial[i] = pressure - direction[i];
    remote[i] = state.open[i] > 0 && pressure > 0 && bandage > 0 &&
                        (bandage > far * pressure || pressure > far * bandage)
                    ? 1
                    : 0;
  }
  if (any(remote)) GAITER_EACH {
      const double pressure = state.pressure[i];
      const double bandage = remote[i] > 0 ? pressure - state.pressure_residual[i] : 1.0;
      const double slope = 1 - (1 - scalar_slope(state, i)) * pressure / bandage;
      const double step = pressure * log(remote[i] > 0 ? bandage / pressure : 1.0) / slope;
      trial[i] = remote[i] > 0 && std::fabs(step) > std::fabs(direction[i]) ? pressure + step : trial[i];
    }
  GAITER_EACH {
    const double low = state.low[i], high = state.high[i];
    const double bandage = state.pressure[i] - state.pressure_residual[i];
    // Newton's method crawls where the bandage is crushed; whether it touches the leg at all is asked first.
    const bool crushed = bandage < -crushing * state.pressure[i];
    const double aim = crushed ? -1 : trial[i];
    const double wanted = low < 0 && aim <= 0 ? 0 : aim;
    const bool inside = wanted > low && wanted < high;
    const double floor = low > 0 ? low : 0;
    const double middle = low > 0 ? std::sqrt(low * high) : 0.5 * (floor + high);
    // Beyond the middle of a bracket, a far step and Newton's way back could go on for ever.
    const bool leap =
        remote[i] > 0 && low > 0 && (state.pressure_residual[i] < 0 ? wanted > middle : wanted < middle);
    const double chosen = inside && !leap ? wanted : middle;
    quadratic[i] = inside && !crushed && !(remote[i] > 0) ? 1 : 0;
    trial[i] = state.open[i] > 0 ? chosen : state.pressure[i];
  }

  Pack strain, strain_slope, bandage, bandage_slope;
  leg_strain(shape, rows, trial, strain, strain_slope);
  bandage_pressure(shape, rows, strain, bandage, bandage_slope);

  GAITER_EACH {
    const bool open = state.open[i] > 0;
    const bool pressing = trial[i] > 0 || bandage[i] > 0;
    const double steep = pressing ? bandage_slope[i] : 0;
    const double residual = trial[i] - (pressing ? bandage[i] : 0);
    const double slope = 1 - steep * strain_slope[i];
    const double taken = std::fabs(trial[i] - state.pressure[i]);
    const double next = std::fabs(residual / slope);

    const double low = residual < 0 ? trial[i] : state.low[i];
    const double high = residual < 0 ? state.high[i] : trial[i];
    // A Newton step of size `taken` that leaves a step `next` converges quadratically with constant
    // next/taken^2.
    const bool converging = quadratic[i] > 0 && slope > 0 && next < 0.1 * taken;
    const double error = converging ? next * (next / taken) * (next / taken) : next;
    const double rounding = std::fabs(bandage[i]) + state.rounding[i];
    const double noise = 2 * finest * (trial[i] + rounding / (slope > 1 ? slope : 1));
    const bool collapsed = high - low <= 2 * finest * high;
    const bool near = !(bandage[i] < -crushing * trial[i]);
    const double polished = trial[i] - residual / slope;
    // A slice that closes on the error after this last step must take it, to the end of its bracket if need
    // be.
    const double kept = polished < high ? polished : high;
    const bool ahead = slope > 0 && kept > (low > 0 ? low : 0);
    // The constant of the convergence, as two steps tell it, may be small by chance; that of a law of powers
    // is about the inverse of the pressure. A stiff bandage's is larger with the slope, which an early end
    // shows.
    const double bend = state.may_leave[i] > 0 && slope > 1 ? slope : 1;
    const double curved = 0.5 * bend * next * (next / (ahead ? kept : 1.0));
    const double beyond = left_caution * (error > curved ? error : curved);
    const bool small = error <= tolerance * trial[i] || next <= noise;
    // Likewise of the radius, which a leg that is being crushed changes faster than the pressure.
    const bool enough = ahead && beyond <= state.may_leave[i] * kept &&
                        strain_slope[i] * beyond <= state.may_leave[i] * (1 - strain[i]);
    const bool closing = residual == 0 || (near && slope > 0 && (small || enough)) || collapsed;
    const bool polish = closing && ahead;

    const double pressure = polish ? kept : trial[i];
    state.pressure[i] = open ? pressure : state.pressure[i];
    state.strain[i] = open ? strain[i] + strain_slope[i] * (pressure - trial[i]) : state.strain[i];
    state.strain_residual[i] = open ? 0 : state.strain_residual[i];
    state.pressure_residual[i] = open ? residual : state.pressure_residual[i];
    state.strain_slope[i] = open ? strain_slope[i] : state.strain_slope[i];
    state.bandage_slope[i] = open ? steep : state.bandage_slope[i];
    state.low[i] = open ? low : state.low[i];
    state.high[i] = open ? high : state.high[i];
    state.smallest_slope[i] = open && slope < state.smallest_slope[i] ? slope : state.smallest_slope[i];
    const double missed = slope > 0 ? next : high - low;
    // What has lifted off by less than the rounding may touch yet.
    const bool touching = trial[i] == 0 && bandage[i] + coarse * state.rounding[i] > 0;
    const double undecided = touching ? coarse * state.rounding[i] : missed;
    state.left[i] = open && closing ? (polish ? beyond : undecided) : state.left[i];
    state.settled_slope[i] = open ? steep : state.settled_slope[i];
    state.iterations[i] += state.open[i];
    state.open[i] = open && !closing ? 1 : 0;
  }
}

GAITER_MULTIVERSION
void advance_fixed_point(const SliceShape& shape, const Pack* rows, const Pack& direction, double tolerance,
                         PackState& state) {
  Pack trial, strain, strain_slope;
  const Pack& limit = rows[SliceShape::pressure_limit];
  GAITER_EACH {
    const double unlimited = state.pressure[i] - direction[i];
    const double wanted = unlimited < 0 ? 0 : unlimited;  // a bandage cannot pull
    const bool admissible = wanted < limit[i];
    state.failed[i] = state.open[i] > 0 && !admissible ? 1 : state.failed[i];
    trial[i] = state.open[i] > 0 && admissible ? wanted : state.pressure[i];
  }
  leg_strain(shape, rows, trial, strain, strain_slope);
  Pack change;
  GAITER_EACH {
    const bool open = state.open[i] > 0;
    change[i] = std::fabs(strain[i] - state.strain[i]);
    state.pressure[i] = trial[i];
    state.strain[i] = open ? strain[i] : state.strain[i];
  }
  evaluate_residual(shape, rows, state);
  GAITER_EACH {
    // What Newton's next step would still change.
    const double next = std::fabs(state.pressure_residual[i] / scalar_slope(state, i));
    state.left[i] = state.open[i] > 0 ? next : state.left[i];
    state.settled_slope[i] = state.open[i] > 0 ? state.bandage_slope[i] : state.settled_slope[i];
    state.iterations[i] += state.open[i];
    state.open[i] = state.open[i] > 0 && !(state.failed[i] > 0) && change[i] >= tolerance ? 1 : 0;
  }
}

GAITER_MULTIVERSION
void pressure_error(const SliceShape& shape, const Pack* rows, const PackState& state, const Pack& wall_error,
                    const Pack& passive_wall_error, PressureError& error) {
  const double law = shape.material == model::LegMaterial::compliance ? 1 : 0;
  const double coarse = shape.single ? caution_in_single * single_epsilon : 0;
  const Pack &gap = rows[SliceShape::gap], &radius = rows[SliceShape::leg_radius],
             &leg = rows[SliceShape::leg_1], &unstrained = rows[SliceShape::leg_2];
  GAITER_EACH {
    const double pressure = state.pressure[i];
    // Strain at which the bandage is slack, and the largest part of the leg's strain.
    const double strain =
        std::fabs(gap[i] / radius[i]) + std::fabs(state.strain[i]) + law * std::fabs(leg[i]);
    const double steep = state.settled_slope[i];
    const double flat = std::fabs(1 - steep * state.strain_slope[i]);
    const double slope = flat > epsilon ? flat : epsilon;
    const double passive = (pressure + state.rounding[i]) / slope;
    const double bandage = 2 * passive + std::fabs(steep) * strain / slope;
    const double excess = passive > pressure ? passive - pressure : 0;
    const double sure = wall_error[i] < smallest_sure_wall_error ? wall_error[i] : smallest_sure_wall_error;
    const double wall = passive_wall_error[i] * excess + wall_caution * sure * passive;
    // What single precision rounds: the way from slack, and the leg's strain by the pressure.
    const double moved =
        std::fabs(gap[i] / radius[i] - state.strain[i]) + law * std::fabs(state.strain[i] - unstrained[i]);
    const double rounded = pressure + 2 * passive + std::fabs(steep) * moved / slope;
    const double solution =
        state.left[i] + rounding_caution * epsilon * (pressure + bandage) + coarse * rounded;
    error.wall[i] = pressure > 0 ? wall : 0;
    const double lifted = coarse * state.rounding[i];
    error.solution[i] = pressure > 0 ? solution : state.left[i] < lifted ? 0 : lifted;
  }
}

}  // namespace gaiter::physics
