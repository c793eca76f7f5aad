// SPDX-License-Identifier: BSD-2-Clause
#pragma once

#include "gaiter/physics/forecast_laws.hpp"

// The states that a quick forecast goes by (quick_forecast.hpp): the rigid leg's, its correction to first
// order, and what one step of Newton's method makes of that.
namespace gaiter::physics::forecast {

// Newton's last step, in the logarithm of the pressure: beyond, the pressures are not known well enough.
constexpr float largest_step = 1;

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
  PackOf<Number> swell, x, w, stress, stress_slope, bend, bend_slope, rate, power;
  GAITER_EACH {
    const Number wanted = input.gap[i] + input.leg_radius[i] * wider[i];
    const Number excess = larger(wanted, Number(-0.999f));
    swell[i] = excess * (2 + excess);
    x[i] = swell[i] * input.middle[i];
    w[i] = 1 / (1 + x[i]);
    rate[i] = input.leg_radius[i] * (1 + wider[i]);
    stress[i] = stress_slope[i] = bend[i] = bend_slope[i] = 0;
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
      const Number above = half * up * (1 - m), below = half * down * (1 + m);
      const Number high = 1 - m - (2 - m) * w[i], low = 1 + m - (2 + m) * w[i];
      bend[i] += above * high - below * low;
      bend_slope[i] += above * (term.alpha[i] * high + 2 * (2 - m) * w[i]) +
                       below * (term.alpha[i] * low - 2 * (2 + m) * w[i]);
    }
  }
  GAITER_EACH {
    const Number log_area = input.log_area[i], radius = 1 + input.gap[i] + input.leg_radius[i] * wider[i];
    const Number thick = log_area * log_area * Number(1.0 / 24);
    const Number bent = (1 - w[i]) * bend_slope[i] - (2 - 4 * w[i]) * bend[i];
    found.passive[i] = log_area * w[i] * (stress[i] + thick * (1 - w[i]) * bend[i]);
    found.slope[i] =
        log_area * w[i] * w[i] * input.middle[i] * (stress_slope[i] + thick * bent) * radius * rate[i];
  }
  if (voltage)
    relieving(input, swell, rate, found.relief, found.relief_slope);
  else
    GAITER_EACH found.relief[i] = found.relief_slope[i] = 0;
}

template <typename Number>
struct State {
  PackOf<Number> rigid, first, pressure, strain, response, slope, gain;
  PackOf<Number> doubt;  // the pressure's relative error, about
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
  const bool law = input.material == model::LegMaterial::compliance;
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
    s.doubt[i] = 0.5f * change * change;
  }
  exp_each(grown, grown);
  GAITER_EACH {
    const Number pressure = s.pressure[i], next = pressure * grown[i];
    sure[i] *= (next < input.pressure_limit[i]) | !(input.gives_way[i] > 0) ? 1 : 0;
    s.strain[i] += s.response[i] * (next - pressure);
    s.pressure[i] = next;
    // Newton's step is wrong by half its square times the curvature of ln P - ln P_t over ln P, where the
    // strain's logarithm grows by `rate` and the bandage, close to slack, is a straight line.
    const Number rate = (law ? input.leg[1][i] : 2 * s.response[i]) * next;
    s.doubt[i] *= s.gain[i] * (s.gain[i] + rate) / (1 + s.gain[i]);
  }
}

// Where a stiff bandage crushes the leg: how far the strain falls under voltage, as a part of it. At rest the
// bandage carries that pressure, and on the leg undeformed, far more; in between its radius is Hermite's
// polynomial in the pressure, which gives the strain that is left when it carries the relief as well.
template <typename Number>
GAITER_INLINE Number widening_where_crushed(Number relief, Number drop, Number strain, Number steepness,
                                            Number range, Number rigid_steepness) {
  const Number q = (relief - drop) / range, back = 1 - q;
  const Number widening = strain * q * q * (3 - 2 * q) +
                          q * back * range * (back * (1 - strain) / steepness - q / rigid_steepness);
  // On the safe side: a slack bandage has no pressure to go on from.
  const Number part = Number(1.1) * widening / strain, limited = part < Number(0.9) ? part : Number(0.9);
  return larger(limited, Number(0));
}

template <typename Number>
struct States {
  Pressing<Number> undeformed;
  State<Number> rest, actuated;
};

// Of one slice a segment; `sure`: 1 where its states are known well enough, else 0.
template <typename Number>
GAITER_INLINE void find_states(const ForecastInput<Number>& input, PackOf<Number>& sure,
                               States<Number>& found) {
  const bool voltage = input.energised;
  auto& [undeformed, rest, actuated] = found;
  PackOf<Number> none, slack_slope, left;
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
  if (!voltage) return;
  correct(input, undeformed, slack_slope, sure, actuated);
  GAITER_EACH {
    const Number relief = undeformed.relief[i], drop = relief / (1 + rest.gain[i]);
    left[i] = 1 - widening_where_crushed(relief, drop, rest.strain[i], rest.slope[i],
                                         undeformed.passive[i] - rest.pressure[i], undeformed.slope[i]);
  }
  log_each(left, left);
  GAITER_EACH {
    const Number drop = undeformed.relief[i] / (1 + rest.gain[i]);
    const Number crushed = -left[i] * rest.strain[i] / rest.response[i];
    const bool crushes = !(rest.rigid[i] < input.pressure_limit[i]);
    const Number relieved = rest.pressure[i] - (crushes ? crushed : drop);
    const bool better = (input.gives_way[i] > 0) & (relieved > Number(0.3) * rest.pressure[i]);
    actuated.pressure[i] = better ? relieved : actuated.pressure[i];
  }
  step(input, true, sure, actuated);
}

}  // namespace gaiter::physics::forecast
