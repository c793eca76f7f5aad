// SPDX-License-Identifier: BSD-2-Clause
#include "gaiter/physics/quick_forecast.hpp"

#include "gaiter/physics/forecast_errors.hpp"

namespace gaiter::physics {

namespace {

using namespace forecast;

// Newton's last step, in the logarithm of the pressure: beyond, the pressures are not known well enough.
constexpr float largest_step = 1;
constexpr float least_at_end = 0.02f;  // of the passive pressure, left by the voltage at the narrow end
constexpr float beyond_all = 1e30f;

// P_m of the leg's radius times (1 + `wider`), and what it grows with the logarithm of that radius; P_a
// likewise, where there is a voltage.
template <typename Number>
struct Pressing {
  PackOf<Number> passive, slope, relief, relief_slope;

  Number net(int i) const { return passive[i] - relief[i]; }
  Number net_slope(int i) const { return slope[i] - relief_slope[i]; }
};

template <typename Number>
GAITER_INLINE void press(const ForecastInput<Number>& input, bool voltage, const PackOf<Number>& wider,
                         Pressing<Number>& found) {
  PackOf<Number> swell, x, w, stress, stress_slope, bend, rate, power;
  GAITER_EACH {
    const Number wanted = input.gap[i] + input.leg_radius[i] * wider[i];
    const Number excess = larger(wanted, Number(-0.999f));
    swell[i] = excess * (2 + excess);
    x[i] = swell[i] * input.middle[i];
    w[i] = 1 / (1 + x[i]);
    rate[i] = input.leg_radius[i] * (1 + wider[i]);
    stress[i] = stress_slope[i] = bend[i] = 0;
  }
  log1p_each(x, x);
  for (const auto& term : input.terms) {
    GAITER_EACH power[i] = clamped(0.5f * term.alpha[i] * x[i]);
    exp_each(power, power);
    GAITER_EACH {
      const Number up = power[i], down = 1 / up, half = 0.5f * term.mu[i];
      const Number sine = half * (up - down), m = 0.5f * term.alpha[i];
      stress[i] += sine;
      stress_slope[i] += term.alpha[i] * half * (up + down) - 2 * sine;
      // Of w^(1 - m) and w^(1 + m), twice, over L^2 w (1 - w): see forecast_errors.
      bend[i] += half * (up * (1 - m) * (1 - m - (2 - m) * w[i]) - down * (1 + m) * (1 + m - (2 + m) * w[i]));
    }
  }
  GAITER_EACH {
    const Number log_area = input.log_area[i], radius = 1 + input.gap[i] + input.leg_radius[i] * wider[i];
    const Number thick = log_area * log_area * Number(1.0 / 24);
    found.passive[i] = log_area * w[i] * (stress[i] + thick * (1 - w[i]) * bend[i]);
    found.slope[i] = log_area * w[i] * w[i] * input.middle[i] * stress_slope[i] * radius * rate[i];
  }
  if (voltage)
    relieving(input, swell, rate, found.relief, found.relief_slope);
  else
    GAITER_EACH found.relief[i] = found.relief_slope[i] = 0;
}

template <typename Number>
struct State {
  PackOf<Number> rigid, first, pressure, strain, response, slope, gain;
};

// The correction to first order, as start_at_rest has it, and a pressure to start from: that one, or, where
// the bandage would crush the leg until it is slack, a Newton step from there. `slack_slope`: that of the
// pressure then.
template <typename Number>
GAITER_INLINE void correct(const ForecastInput<Number>& input, const Pressing<Number>& undeformed,
                           const PackOf<Number>& slack_slope, PackOf<Number>& sure, State<Number>& s) {
  PackOf<Number> ratio;
  GAITER_EACH {
    const Number rigid = undeformed.net(i), limit = input.pressure_limit[i];
    s.rigid[i] = rigid;
    s.pressure[i] = rigid < limit ? rigid : limit;
    sure[i] *= rigid > 0 ? 1 : 0;
  }
  strain_law(input, s.pressure, s.strain, s.response);
  GAITER_EACH {
    const Number softness = 1 / larger(1 - s.strain[i], Number(0.05f));
    // The strain that leaves the bandage as much stretch as it needs for about that pressure; the leg's law
    // is close to an exponential there.
    const Number slack = input.slack[i], needed = input.pressure_limit[i] / (slack_slope[i] * softness);
    const Number wanted = slack > 2 * needed ? slack - needed : 0.5f * slack;
    ratio[i] = s.rigid[i] < input.pressure_limit[i] ? Number(1) : wanted / s.strain[i];
  }
  log_each(ratio, ratio);
  GAITER_EACH {
    const Number rigid = s.rigid[i], limit = input.pressure_limit[i], k = undeformed.net_slope(i);
    const Number moved = rigid - k * s.strain[i] / (1 + k * s.response[i]);
    const bool gives_way = input.gives_way[i] > 0, crushes = !(rigid < limit);
    const bool good = (moved > 0) & (moved < limit) & (1 + k * s.response[i] > 0);
    const Number from_slack = limit + ratio[i] * s.strain[i] / s.response[i];
    const Number start = crushes ? from_slack : moved;
    sure[i] *= good | crushes | !gives_way ? 1 : 0;
    const Number corrected = crushes ? limit : moved;
    s.first[i] = gives_way ? corrected : rigid;
    s.pressure[i] = gives_way ? start : rigid;
  }
}

// One Newton step for ln P = ln P_t from s.pressure.
template <typename Number>
GAITER_INLINE void step(const ForecastInput<Number>& input, bool voltage, PackOf<Number>& sure,
                        State<Number>& s) {
  Pressing<Number> here;
  PackOf<Number> wider, ratio, grown;
  strain_law(input, s.pressure, s.strain, s.response);
  GAITER_EACH {
    s.strain[i] *= input.gives_way[i];
    s.response[i] *= input.gives_way[i];
    wider[i] = -s.strain[i];
  }
  press(input, voltage, wider, here);
  GAITER_EACH {
    const Number pressure = s.pressure[i], net = here.net(i);
    const bool pressing = (net > 0) & (pressure > 0);
    ratio[i] = pressing ? net / pressure : Number(1);
    sure[i] *= pressing | !(input.gives_way[i] > 0) ? 1 : 0;
  }
  log_each(ratio, grown);
  GAITER_EACH {
    const Number softness = s.response[i] / larger(1 - s.strain[i], Number(0.05f));
    const Number slope = here.net_slope(i), stiffening = 1 + slope * softness / ratio[i];
    const Number change = input.gives_way[i] * grown[i] / stiffening;
    const bool good = (stiffening > 0.3f) & (std::fabs(change) < largest_step);
    sure[i] *= good | !(input.gives_way[i] > 0) ? 1 : 0;
    grown[i] = clamped(change);
    s.slope[i] = slope;
    s.gain[i] = larger(slope, Number(0)) * softness;
  }
  exp_each(grown, grown);
  GAITER_EACH {
    const Number pressure = s.pressure[i], next = pressure * grown[i];
    sure[i] *= (next < input.pressure_limit[i]) | !(input.gives_way[i] > 0) ? 1 : 0;
    s.strain[i] += s.response[i] * (next - pressure);
    s.pressure[i] = next;
  }
}

// What a state that counts says of the errors, if that is worse than what another did.
template <typename Number>
GAITER_INLINE void tell(const ForecastInput<Number>& input, const State<Number>& s,
                        const PackOf<Number>& counts, QuickForecast<Number>& found, PackOf<Number>& share,
                        LegPoles<Number>& poles) {
  constexpr Number rounding = 16 * std::numeric_limits<Number>::epsilon();
  LegPoles<Number> own;
  PackOf<Number> x, up, fall, log_fall;
  find_poles(input, s.pressure, s.slope, s.response, own);
  GAITER_EACH {
    // An error that goes with a power of the pressure is larger at the wide end than it is small at the
    // narrow one.
    const Number raised = std::fabs(input.taper[i] * s.slope[i] / s.pressure[i]);
    const Number limited = raised < 7 ? raised : Number(7);
    x[i] = larger(limited, Number(1e-3f));
    fall[i] = s.rigid[i] / s.pressure[i];
    log_fall[i] = larger(fall[i], least<Number>);
  }
  exp_each(x, up);
  log_each(log_fall, log_fall);
  GAITER_EACH {
    const Number down = 1 / up[i], over = 1 / x[i];
    const Number spread = 0.5f * (up[i] - down) * over;
    const Number spread_of_cube = (up[i] * up[i] * up[i] - down * down * down) * over * Number(1.0 / 6);
    const Number typical = Number(0.3) * log_fall[i] * log_fall[i];
    const Number missed = caution * std::fabs(s.first[i] / s.pressure[i] - 1);
    const Number yields = counts[i] * input.gives_way[i];
    const Number rigid_error = yields * (caution_of_mean * spread * std::fabs(fall[i] - 1) + rounding);
    const Number first_error = yields * (spread_of_cube * larger(missed, typical) + rounding);
    const Number lost = s.strain[i] > 0 ? s.strain[i] : Number(beyond_all);
    const Number volume = counts[i] * s.pressure[i] * s.response[i] / lost;
    found.compliance[i] = larger(found.compliance[i], rigid_error);
    found.first_order[i] = larger(found.first_order[i], first_error);
    found.volume_factor[i] = larger(found.volume_factor[i], volume);
    share[i] = larger(share[i], counts[i] / (s.pressure[i] * (1 + s.gain[i])));
  }
  for (int k = 0; k < 2; ++k) GAITER_EACH {
      poles.part[k][i] = larger(poles.part[k][i], counts[i] * own.part[k][i]);
      poles.fall[k][i] = larger(poles.fall[k][i], counts[i] * own.fall[k][i]);
    }
}

}  // namespace

template <typename Number>
GAITER_INLINE void QuickForecast<Number>::work_out(const Input& input, const Pack& rest_counts,
                                                   const Pack& actuated_counts) {
  const bool voltage = input.energised;
  Pressing<Number> undeformed, end;
  State<Number> rest, actuated;
  Pack none, wider, strain, slack_slope;
  GAITER_EACH {
    none[i] = slack_slope[i] = 0;
    sure[i] = 1;
  }
  for (const auto& term : input.terms)
    GAITER_EACH slack_slope[i] += term.mu[i] * term.alpha[i] * input.log_area[i] * input.middle[i];
  press(input, voltage, none, undeformed);
  Pressing<Number> passive = undeformed;
  GAITER_EACH passive.relief[i] = passive.relief_slope[i] = 0;
  correct(input, passive, slack_slope, sure, rest);
  step(input, false, sure, rest);
  if (voltage) {
    correct(input, undeformed, slack_slope, sure, actuated);
    GAITER_EACH {
      const Number relieved = rest.pressure[i] - undeformed.relief[i] / (1 + rest.gain[i]);
      const bool better = (input.gives_way[i] > 0) & (relieved > Number(0.3) * rest.pressure[i]);
      actuated.pressure[i] = better ? relieved : actuated.pressure[i];
    }
    step(input, true, sure, actuated);
  }
  strain_law(input, none, strain, wider);
  GAITER_EACH wider[i] = (1 - std::fabs(input.taper[i])) * (1 - input.gives_way[i] * strain[i]) - 1;
  press(input, voltage, wider, end);
  GAITER_EACH {
    const bool pressing = (end.passive[i] > 0) & (end.net(i) > least_at_end * end.passive[i]);
    sure[i] *= pressing ? 1 : 0;
  }

  strain = rest.strain;
  if (voltage) GAITER_EACH strain[i] = actuated.strain[i] < strain[i] ? actuated.strain[i] : strain[i];
  find_errors(input, strain, errors_);

  poles_ = {};
  share_ = {};
  GAITER_EACH {
    compliance[i] = first_order[i] = 0;
    volume_factor[i] = drop_factor[i] = 1;
  }
  tell(input, rest, rest_counts, *this, share_, poles_);
  if (voltage) {
    tell(input, actuated, actuated_counts, *this, share_, poles_);
    GAITER_EACH {
      const Number drop = rest.pressure[i] - actuated.pressure[i];
      const Number safe = drop > 0 ? drop : rest.pressure[i];
      drop_factor[i] = rest.pressure[i] / safe;
    }
  }
  GAITER_EACH {
    tapers_[i] = input.taper[i] != 0 ? 1 : 0;
    const Number sum = compliance[i] + first_order[i] + volume_factor[i] + share_[i] + errors_.height[1][i] +
                       errors_.height[2][i] + errors_.wall[0][i] + errors_.wall[1][i] + errors_.wall[2][i] +
                       poles_.part[0][i] + poles_.part[1][i];
    sure[i] *= sum < beyond_all ? 1 : 0;
  }
}

template <>
GAITER_MULTIVERSION void QuickForecast<double>::analyse(const Input& input, const Pack& rest,
                                                        const Pack& actuated) {
  work_out(input, rest, actuated);
}

template <>
GAITER_MULTIVERSION void QuickForecast<float>::analyse(const Input& input, const Pack& rest,
                                                       const Pack& actuated) {
  work_out(input, rest, actuated);
}

template <typename Number>
double QuickForecast<Number>::height_error(int place, int points) const {
  const int known = points < forecast_points ? points : forecast_points;
  const double of_bandage =
      caution * (errors_.height[known][place] + errors_.height[known + 1][place]) * share_[place];
  double of_leg[2] = {poles_.part[0][place], poles_.part[1][place]};
  for (int n = 0; n < points; ++n)
    for (int k = 0; k < 2; ++k) of_leg[k] *= poles_.fall[k][place];
  return tapers_[place] * (of_bandage + of_leg[0] + of_leg[1]);
}

template <typename Number>
double QuickForecast<Number>::wall_error(int place, int points) const {
  const int known = points < forecast_points ? points : forecast_points;
  const Number before = errors_.wall[known - 1][place], here = errors_.wall[known][place],
               after = errors_.wall[known + 1][place];
  // A term that is small by chance is not trusted.
  const Number neighbours = Number(0.04f) * before * after;
  const Number trusted = here * here < neighbours ? std::sqrt(neighbours) : here;
  return caution_of_wall * share_[place] * (trusted + after);
}

template class QuickForecast<double>;
template class QuickForecast<float>;

}  // namespace gaiter::physics
