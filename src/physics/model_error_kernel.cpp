// SPDX-License-Identifier: BSD-2-Clause
#include "gaiter/physics/model_error_kernel.hpp"

#include <cmath>

namespace gaiter::physics {

namespace {

constexpr double vacuum_permittivity = 8.8541878128e-12;  // [F/m]
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

// Of the walls and stretches that bounds are fitted to.
struct Range {
  double thinnest, thickest;  // wall over radius
  double loosest, tightest;   // stretch
};
constexpr Range fitted_range{0.0025, 0.05, 1.06, 2.2}, wide_range{0.0015, 0.08, 1.045, 2.65};

#define GAITER_EACH for (int i = places.from; i < places.to; ++i)

// The leg at its mean radius under a pressure P: its strain eps, and derivatives with respect to ln P.
template <typename Number>
struct LegAnswer {
  Number strain;
  Number softness;        // -d ln(1 - eps)
  Number softness_slope;  // d softness
  Number volume_slope;    // d ln v, v = eps (2 - eps) the part of the volume that is lost
  Number volume_bend;     // d volume_slope
};

// `first`, `second`: derivatives of the strain with respect to p, times p and p^2.
inline LegAnswer<double> leg_answer(double strain, double first, double second) {
  const double rest = 1 - strain, volume = strain * (2 - strain);
  LegAnswer<double> answer;
  answer.strain = strain;
  answer.softness = first / rest;
  answer.softness_slope = answer.softness + second / rest + answer.softness * answer.softness;
  answer.volume_slope = 2 * rest * first / volume;
  answer.volume_bend = answer.volume_slope + 2 * (rest * second - first * first) / volume -
                       answer.volume_slope * answer.volume_slope;
  return answer;
}

GAITER_MULTIVERSION
void find_leg_answers(const SegmentConstants<Pack>& segments, model::LegMaterial material,
                      const Pack& pressure, const Pack& lost, Places places, LegAnswer<Pack>& answers) {
  const Pack* const law = segments.leg_law;
  Pack strain, first, second;
  if (material == model::LegMaterial::neo_hookean) {
    GAITER_EACH {
      const double p = pressure[i] / segments.pressure_scale[i];
      const double bulk = law[0][i], shear = law[1][i], y = 1 - lost[i];
      strain[i] = 1 - std::sqrt(y);
      const double power = shear * exp(-5.0 / 3 * log(y));
      const double p_y = -bulk - power - 5.0 / 3 * lost[i] * power / y;
      const double p_yy = 10.0 / 3 * power / y + 40.0 / 9 * lost[i] * power / (y * y);
      const double slope = -2 * (1 - strain[i]) * p_y, bend = 4 * y * p_yy + 2 * p_y;
      first[i] = p / slope;
      second[i] = -p * p * bend / (slope * slope * slope);
    }
  } else {
    GAITER_EACH {
      const double p = pressure[i] / segments.pressure_scale[i];
      const double a = law[0][i], c = law[1][i], none = law[2][i], decay = law[3][i];
      const double grown = a * expm1(p), decayed = c * expm1(decay * p);
      strain[i] = none + grown + decayed;
      first[i] = p * (grown + a + decay * (decayed + c));
      second[i] = p * p * (grown + a + decay * decay * (decayed + c));
    }
  }
  GAITER_EACH {
    const LegAnswer<double> answer = leg_answer(strain[i], first[i], second[i]);
    const bool gives_way = segments.gives_way[i] > 0;
    answers.strain[i] = gives_way ? answer.strain : 0;
    answers.softness[i] = gives_way ? answer.softness : 0;
    answers.softness_slope[i] = gives_way ? answer.softness_slope : 0;
    answers.volume_slope[i] = gives_way ? answer.volume_slope : 0;
    answers.volume_bend[i] = gives_way ? answer.volume_bend : 0;
  }
}

// Derivatives of the tube's energy per volume W, a membrane's, with respect to the logarithms x of the
// stretch around it and y of that along it, at y = 0.
template <typename Number>
struct TubeEnergy {
  Number x, y, xx, xy, yy, xxx, xxy, xyy;
};

// `log_stretch`: x at the middle of the wall.
GAITER_MULTIVERSION
void find_tube_energies(const SegmentPack& segments, const Pack& log_stretch, bool energised, Places places,
                        TubeEnergy<Pack>& w) {
  const SegmentConstants<Pack>& tube = segments.constants;
  // Less the electric energy, eps E^2 e^{2 (x + y)}/2, E the field of a layer before it is stretched.
  GAITER_EACH {
    const double field = energised ? tube.voltage[i] * tube.layers[i] / tube.thickness[i] : 0;
    const double stress =
        vacuum_permittivity * tube.permittivity[i] * field * field * exp(2 * log_stretch[i]);
    w.x[i] = w.y[i] = -stress;
    w.xx[i] = w.xy[i] = w.yy[i] = -2 * stress;
    w.xxx[i] = w.xxy[i] = w.xyy[i] = -4 * stress;
  }
  Pack mu, alpha;
  for (std::size_t term = 0; term < segments.bandages[places.from]->ogden.size(); ++term) {
    GAITER_EACH {
      mu[i] = segments.bandages[i]->ogden[term].mu;
      alpha[i] = segments.bandages[i]->ogden[term].alpha;
    }
    GAITER_EACH {
      const double a = alpha[i], along = mu[i], power = exp(a * log_stretch[i]);
      const double around = along * power, across = along / power;
      w.x[i] += around - across;
      w.y[i] += along - across;
      w.xx[i] += a * (around + across);
      w.xy[i] += a * across;
      w.yy[i] += a * (along + across);
      w.xxx[i] += a * a * (around - across);
      w.xxy[i] -= a * a * across;
      w.xyy[i] -= a * a * across;
    }
  }
}

GAITER_MULTIVERSION
void find_states(const SegmentPack& segments, const LegAnswer<Pack>& legs, const TubeEnergy<Pack>& energies,
                 const Pack& stretches, Places places, State<Pack>& states) {
  const SegmentConstants<Pack>& all = segments.constants;
  GAITER_EACH {
    const double radius = 0.5 * (all.lower_radius[i] + all.upper_radius[i]);
    const double slope = (all.upper_radius[i] - all.lower_radius[i]) / all.height[i];
    const double per_x = 1 / energies.x[i];
    // ln P = ln W_x - 2 x - y, and with x = ln R + ln(1 - eps(P)) its derivatives with respect to ln R (r)
    // and y.
    const double share = energies.xx[i] * per_x, turn = energies.xy[i] * per_x,
                 tension = energies.y[i] * per_x;
    const double f_x = share - 2, f_y = turn - 1, f_xx = energies.xxx[i] * per_x - share * share,
                 f_xy = energies.xxy[i] * per_x - share * turn, f_yy = energies.xyy[i] * per_x - turn * turn;
    const double soft = legs.softness[i], given = 1 / (1 + soft * f_x);
    const double p_r = f_x * given, p_y = f_y * given, x_y = -soft * p_y;
    const double p_ry =
        given * (f_xy * given - p_y * (legs.softness_slope[i] * p_r * f_x + soft * f_xx * given));
    const double p_yy =
        given * (f_yy + f_xy * x_y - p_y * (legs.softness_slope[i] * p_y * f_x + soft * (f_xx * x_y + f_xy)));

    // Axial stiffness of the tube on its leg, over W_x, and K.
    const double coupling = 1 - turn;
    const double yielding = coupling * coupling * soft / (soft * (share - 2) + 1);
    const double stiffness = energies.yy[i] * per_x - tension - (soft > 0 ? yielding : 0);
    const double k = -coupling * given / stiffness;

    constexpr double second_order = 0.35;  // the parabola overestimates long slides; fitted
    const double reach = slope * all.height[i] / radius;
    const double slide = k * reach;
    const double scale = reach * reach / 12 / (1 + second_order * std::fabs(slide));
    const auto sliding = [&](double q_r, double q_y, double q_ry, double q_yy) {
      return scale * k * (0.5 * k * (q_y + q_yy + q_y * q_y) - (q_ry + q_r * q_y));
    };
    const double square = slope * slope;
    const double lengthened = 0.5 * square * turn * given;
    const double g = legs.volume_slope[i], bend = legs.volume_bend[i];
    const double v_r = 2 + g * p_r;
    states.growth[i] = p_r;
    states.k[i] = k;
    states.slide[i] = slide;
    states.pressure_sliding[i] = sliding(p_r, p_y, p_ry, p_yy);
    states.pressure_slope[i] = lengthened;
    states.pressure_ends[i] = -square * tension * given;
    states.volume_sliding[i] =
        sliding(v_r, g * p_y, g * p_ry + bend * p_r * p_y, g * p_yy + bend * p_y * p_y);
    states.volume_slope[i] = g * lengthened;
    states.volume_ends[i] = square * tension * given * (g * (v_r - 1 - p_r) + bend * p_r);
    states.strain[i] = legs.strain[i];
    states.leg_share[i] = 1 - given;
    states.slope_square[i] = square;
    states.reach_square[i] = reach * reach;
    states.stretch[i] = stretches[i];
    states.narrow[i] = stretches[i] * (1 - 0.5 * std::fabs(reach));
    states.stable[i] = stiffness > 0 && given > 0 ? 1 : 0;
  }
}

GAITER_MULTIVERSION
void find_stretches(const SegmentConstants<Pack>& segments, const Pack& strain, Places places, Pack& stretch,
                    Pack& log_stretch) {
  GAITER_EACH {
    const double radius = 0.5 * (segments.lower_radius[i] + segments.upper_radius[i]);
    const double wall = segments.inner_radius[i];
    const double inner = radius * (1 - strain[i]), before = wall + 0.5 * segments.thickness[i];
    stretch[i] = std::sqrt(1 + (inner - wall) * (inner + wall) / (before * before));
    log_stretch[i] = log(stretch[i]);
  }
}

// Under a mean pressure with a part `lost` of the leg's volume.
void find_state(const SegmentPack& segments, model::LegMaterial material, const Pack& pressure,
                const Pack& lost, bool energised, Places places, State<Pack>& state) {
  LegAnswer<Pack> leg;
  TubeEnergy<Pack> energy;
  Pack stretch, log_stretch;
  find_leg_answers(segments.constants, material, pressure, lost, places, leg);
  find_stretches(segments.constants, leg.strain, places, stretch, log_stretch);
  find_tube_energies(segments, log_stretch, energised, places, energy);
  find_states(segments, leg, energy, stretch, places, state);
}

// 0 where it is so, else 1: sums of these leave the loops without branches, which && would bring back.
inline double unless(bool so) {
  return so ? 0.0 : 1.0;
}

inline double outside(double value, double low, double high) {
  return unless(value >= low * (1 - 1e-9)) + unless(value <= high * (1 + 1e-9));
}

inline double outside(const State<Pack>& state, int i, double softest_tube) {
  return unless(state.stable[i] > 0) + unless(std::fabs(state.k[i]) <= softest_tube) +
         unless(std::fabs(state.slide[i]) <= largest_slide) + unless(state.strain[i] <= 0.3) +
         unless(state.narrow[i] >= narrowest);
}

inline double outside_wide(const State<Pack>& state, int i, double load, double softest_tube) {
  return unless(state.stable[i] > 0) + unless(std::fabs(state.k[i]) <= softest_tube) +
         unless(std::fabs(state.slide[i]) <= widest_slide) + unless(state.strain[i] * load <= most_work) +
         unless(std::fabs(state.k[i] * state.slide[i]) * load <= most_sheared) +
         unless(state.narrow[i] >= wide_narrowest);
}

inline double outside(const SegmentConstants<Pack>& all, int i, double radius, const Range& range) {
  return outside(all.thickness[i] / radius, range.thinnest, range.thickest) +
         outside(radius / (all.inner_radius[i] + all.thickness[i]), range.loosest, range.tightest);
}

// Whether the segments lie in the boxes that the bounds are fitted in.
GAITER_MULTIVERSION
void find_known(const SegmentPack& segments, model::LegMaterial material, const SlicesFound& slices,
                const Pack& terms, Places places, States<Pack>& states) {
  const SegmentConstants<Pack>& all = segments.constants;
  const bool law = material == model::LegMaterial::compliance;
  GAITER_EACH {
    const double radius = 0.5 * (all.lower_radius[i] + all.upper_radius[i]),
                 rise = std::fabs(all.upper_radius[i] - all.lower_radius[i]);
    const double softness = law ? all.leg_law[0][i] + all.leg_law[1][i] * all.leg_law[3][i] : 0.5;
    const double gives_way = all.gives_way[i];
    const double load = gives_way * slices.pressure_rest[i] / all.shear_modulus[i];
    const double part = gives_way * all.shear_modulus[i] * softness / all.pressure_scale[i];
    const double pressing = unless(slices.in_contact[i] > 0) + unless(slices.pressure_rest[i] > 0) +
                            unless(slices.pressure_actuated[i] > 0);
    const double both = pressing + unless(terms[i] > 0) +
                        gives_way * (unless(part >= 0.04) + unless(part <= 1)) +
                        unless(rise <= steepest * all.height[i]) + unless(rise <= widest * radius) +
                        outside(all.height[i] / radius, 0.3, 5);
    const double rest = both + gives_way * unless(load <= softest) + outside(all, i, radius, fitted_range) +
                        outside(states.rest, i, softest_at_rest);
    const double wide = both + unless(all.slides[i] > 0) + outside(all, i, radius, wide_range) +
                        outside_wide(states.rest, i, load, wide_softest_at_rest);
    const double driven = all.voltage[i] != 0 ? 1 : 0;
    const double actuated = rest + driven * outside(states.actuated, i, softest_energised);
    const double wide_actuated =
        wide + driven * outside_wide(states.actuated, i, load, wide_softest_energised);
    states.shear_load[i] = load;
    states.shear_part[i] = part;
    states.rest_known[i] = rest > 0 ? 0 : 1;
    states.actuated_known[i] = actuated > 0 ? 0 : 1;
    states.rest_bounded[i] = wide > 0 ? 0 : 1;
    states.actuated_bounded[i] = wide_actuated > 0 ? 0 : 1;
  }
  for (State<Pack>* state : {&states.rest, &states.actuated}) GAITER_EACH {
      const bool slides = all.slides[i] > 0;
      state->pressure_sliding[i] = slides ? state->pressure_sliding[i] : 0;
      state->volume_sliding[i] = slides ? state->volume_sliding[i] : 0;
    }
}

}  // namespace

void find_model_states(const SegmentPack& segments, model::LegMaterial material, const SlicesFound& slices,
                       Places places, States<Pack>& states) {
  find_state(segments, material, slices.pressure_rest, slices.lost_at_rest, false, places, states.rest);
  find_state(segments, material, slices.pressure_actuated, slices.lost_actuated, true, places,
             states.actuated);
  Pack terms;
  GAITER_EACH {
    bool allowed = true;
    for (const model::OgdenTerm& term : segments.bandages[i]->ogden)
      allowed = allowed && term.mu * term.alpha > 0 && !(outside(term.alpha, -2, 12.2) > 0);
    terms[i] = allowed ? 1 : 0;
  }
  find_known(segments, material, slices, terms, places, states);
}

}  // namespace gaiter::physics
