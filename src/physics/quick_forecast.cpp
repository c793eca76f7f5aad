// SPDX-License-Identifier: BSD-2-Clause
#include "gaiter/physics/quick_forecast.hpp"

#include "gaiter/physics/forecast_laws.hpp"

namespace gaiter::physics {

namespace {

using namespace forecast;

// Newton's last step, in the logarithm of the pressure: beyond, the pressures are not known well enough.
constexpr double largest_step = 1;
constexpr double least_at_end = 0.02;  // of the passive pressure, left by the voltage at the narrow end

// P_m of the leg's radius times (1 + `wider`), and what it grows with the logarithm of that radius; P_a
// likewise, where there is a voltage.
struct Pressing {
  Pack passive, slope, relief, relief_slope;

  double net(int i) const { return passive[i] - relief[i]; }
  double net_slope(int i) const { return slope[i] - relief_slope[i]; }
};

GAITER_INLINE void press(const ForecastInput& input, bool voltage, const Pack& wider, Pressing& found) {
  Pack swell, x, w, stress, stress_slope, bend, rate;
  GAITER_EACH {
    const double wanted = input.gap[i] + input.leg_radius[i] * wider[i];
    const double excess = wanted > -0.999 ? wanted : -0.999;
    swell[i] = excess * (2 + excess);
    const double square = swell[i] * input.middle[i];
    x[i] = 0.5 * log1p(square);
    w[i] = 1 / (1 + square);
    rate[i] = input.leg_radius[i] * (1 + wider[i]);
    stress[i] = stress_slope[i] = bend[i] = 0;
  }
  for (const ForecastInput::Term& term : input.terms) GAITER_EACH {
      const double up = exp(clamped(term.alpha[i] * x[i])), down = 1 / up, half = 0.5 * term.mu[i];
      const double sine = half * (up - down), m = 0.5 * term.alpha[i];
      stress[i] += sine;
      stress_slope[i] += term.alpha[i] * half * (up + down) - 2 * sine;
      // Of w^(1 - m) and w^(1 + m), twice, over L^2 w (1 - w): see forecast_errors.
      bend[i] += half * (up * (1 - m) * (1 - m - (2 - m) * w[i]) - down * (1 + m) * (1 + m - (2 + m) * w[i]));
    }
  GAITER_EACH {
    const double log_area = input.log_area[i], radius = 1 + input.gap[i] + input.leg_radius[i] * wider[i];
    found.passive[i] = log_area * w[i] * (stress[i] + log_area * log_area / 24 * (1 - w[i]) * bend[i]);
    found.slope[i] = log_area * w[i] * w[i] * input.middle[i] * stress_slope[i] * radius * rate[i];
  }
  if (voltage)
    relieving(input, swell, rate, found.relief, found.relief_slope);
  else
    GAITER_EACH found.relief[i] = found.relief_slope[i] = 0;
}

struct State {
  Pack rigid, first, pressure, strain, response, slope, gain;
};

// The correction to first order, as start_at_rest has it, and a pressure to start from: that one, or, where
// the bandage would crush the leg until it is slack, a Newton step from there. `slack_slope`: that of the
// pressure then.
GAITER_INLINE void correct(const ForecastInput& input, const Pressing& undeformed, const Pack& slack_slope,
                           Pack& sure, State& s) {
  GAITER_EACH {
    const double rigid = undeformed.net(i), limit = input.pressure_limit[i];
    s.rigid[i] = rigid;
    s.pressure[i] = rigid < limit ? rigid : limit;
    sure[i] *= rigid > 0 ? 1.0 : 0.0;
  }
  strain_law(input, s.pressure, s.strain, s.response);
  GAITER_EACH {
    const double rigid = s.rigid[i], limit = input.pressure_limit[i], k = undeformed.net_slope(i);
    const double moved = rigid - k * s.strain[i] / (1 + k * s.response[i]);
    const bool gives_way = input.gives_way[i] > 0, crushes = !(rigid < limit);
    const bool good = (moved > 0) & (moved < limit) & (1 + k * s.response[i] > 0);
    const double left = 1 - s.strain[i], softness = 1 / (left > 0.05 ? left : 0.05);
    // The strain that leaves the bandage as much stretch as it needs for about that pressure; the leg's law
    // is close to an exponential there.
    const double slack = input.gap[i] / input.leg_radius[i], needed = limit / (slack_slope[i] * softness);
    const double wanted = slack > 2 * needed ? slack - needed : 0.5 * slack;
    const double ratio = crushes ? wanted / s.strain[i] : 1.0;
    const double from_slack = limit + log(ratio) * s.strain[i] / s.response[i];
    const double start = crushes ? from_slack : moved;
    sure[i] *= good | crushes | !gives_way ? 1.0 : 0.0;
    const double corrected = crushes ? limit : moved;
    s.first[i] = gives_way ? corrected : rigid;
    s.pressure[i] = gives_way ? start : rigid;
  }
}

// One Newton step for ln P = ln P_t from s.pressure.
GAITER_INLINE void step(const ForecastInput& input, bool voltage, Pack& sure, State& s) {
  Pressing here;
  Pack wider;
  strain_law(input, s.pressure, s.strain, s.response);
  GAITER_EACH {
    s.strain[i] *= input.gives_way[i];
    s.response[i] *= input.gives_way[i];
    wider[i] = -s.strain[i];
  }
  press(input, voltage, wider, here);
  GAITER_EACH {
    const double pressure = s.pressure[i], net = here.net(i), slope = here.net_slope(i);
    const double left = 1 - s.strain[i], softness = s.response[i] / (left > 0.05 ? left : 0.05);
    const bool pressing = (net > 0) & (pressure > 0), gives_way = input.gives_way[i] > 0;
    const double quotient = net / pressure, ratio = pressing ? quotient : 1.0;
    const double stiffening = 1 + slope * softness / ratio;
    const double change = input.gives_way[i] * log(ratio) / stiffening;
    const double next = pressure * exp(clamped(change));
    const bool good =
        pressing & (stiffening > 0.3) & (std::fabs(change) < largest_step) & (next < input.pressure_limit[i]);
    sure[i] *= good | !gives_way ? 1.0 : 0.0;
    s.strain[i] += s.response[i] * (next - pressure);
    s.pressure[i] = next;
    s.slope[i] = slope;
    s.gain[i] = slope > 0 ? slope * softness : 0;
  }
}

// What a state that counts says of the errors, if that is worse than what another did.
GAITER_INLINE void tell(const ForecastInput& input, const State& s, const Pack& counts, QuickForecast& found,
                        Pack& share, LegPoles& poles) {
  LegPoles own;
  find_poles(input, s.pressure, s.slope, s.response, own);
  GAITER_EACH {
    // An error that goes with a power of the pressure is larger at the wide end than it is small at the
    // narrow one.
    const double raised = std::fabs(input.taper[i] * s.slope[i] / s.pressure[i]);
    const double limited = raised < 7 ? raised : 7.0, x = limited > 1e-3 ? limited : 1e-3;
    const double up = exp(x), down = 1 / up;
    const double spread = 0.5 * (up - down) / x;
    const double spread_of_cube = (up * up * up - down * down * down) / (6 * x);
    const double fall = s.rigid[i] / s.pressure[i];
    const double log_fall = log(fall > 1e-300 ? fall : 1e-300);
    const double typical = 0.3 * log_fall * log_fall;
    const double missed = caution * std::fabs(s.first[i] / s.pressure[i] - 1);
    const double yields = counts[i] * input.gives_way[i], lost = s.strain[i] > 0 ? s.strain[i] : 1e300;
    const double rigid_error = yields * caution_of_mean * spread * std::fabs(fall - 1);
    const double first_error = yields * spread_of_cube * larger(missed, typical);
    const double volume = counts[i] * s.pressure[i] * s.response[i] / lost;
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

GAITER_MULTIVERSION
void QuickForecast::analyse(const ForecastInput& input, const Pack& rest_counts,
                            const Pack& actuated_counts) {
  const bool voltage = input.energised;
  Pressing undeformed, end;
  State rest, actuated;
  Pack none, wider, strain;
  GAITER_EACH {
    none[i] = 0;
    sure[i] = 1;
  }
  Pack slack_slope;
  GAITER_EACH slack_slope[i] = 0;
  for (const ForecastInput::Term& term : input.terms)
    GAITER_EACH slack_slope[i] += term.mu[i] * term.alpha[i] * input.log_area[i] * input.middle[i];
  press(input, voltage, none, undeformed);
  Pressing passive = undeformed;
  GAITER_EACH passive.relief[i] = passive.relief_slope[i] = 0;
  correct(input, passive, slack_slope, sure, rest);
  step(input, false, sure, rest);
  if (voltage) {
    correct(input, undeformed, slack_slope, sure, actuated);
    GAITER_EACH {
      const double relieved = rest.pressure[i] - undeformed.relief[i] / (1 + rest.gain[i]);
      const bool better = (input.gives_way[i] > 0) & (relieved > 0.3 * rest.pressure[i]);
      actuated.pressure[i] = better ? relieved : actuated.pressure[i];
    }
    step(input, true, sure, actuated);
  }
  strain_law(input, none, strain, wider);
  GAITER_EACH wider[i] = (1 - std::fabs(input.taper[i])) * (1 - input.gives_way[i] * strain[i]) - 1;
  press(input, voltage, wider, end);
  GAITER_EACH {
    const bool pressing = (end.passive[i] > 0) & (end.net(i) > least_at_end * end.passive[i]);
    sure[i] *= pressing ? 1.0 : 0.0;
  }

  strain = rest.strain;
  if (voltage) GAITER_EACH strain[i] = actuated.strain[i] < strain[i] ? actuated.strain[i] : strain[i];
  forecast_errors(input, strain, errors_);

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
      const double drop = rest.pressure[i] - actuated.pressure[i];
      const double safe = drop > 0 ? drop : rest.pressure[i];
      drop_factor[i] = rest.pressure[i] / safe;
    }
  }
  GAITER_EACH {
    tapers_[i] = input.taper[i] != 0 ? 1 : 0;
    const double sum = compliance[i] + first_order[i] + volume_factor[i] + share_[i] + errors_.height[1][i] +
                       errors_.height[2][i] + errors_.wall[0][i] + errors_.wall[1][i] + errors_.wall[2][i] +
                       poles_.part[0][i] + poles_.part[1][i];
    sure[i] *= sum < 1e300 ? 1.0 : 0.0;
  }
}

double QuickForecast::height_error(int place, int points) const {
  const int known = points < forecast_points ? points : forecast_points;
  const double of_bandage =
      caution * (errors_.height[known][place] + errors_.height[known + 1][place]) * share_[place];
  double of_leg[2] = {poles_.part[0][place], poles_.part[1][place]};
  for (int n = 0; n < points; ++n)
    for (int k = 0; k < 2; ++k) of_leg[k] *= poles_.fall[k][place];
  return tapers_[place] * (of_bandage + of_leg[0] + of_leg[1]);
}

double QuickForecast::wall_error(int place, int points) const {
  const int known = points < forecast_points ? points : forecast_points;
  const double before = errors_.wall[known - 1][place], here = errors_.wall[known][place],
               after = errors_.wall[known + 1][place];
  // A term that is small by chance is not trusted.
  const double by_neighbours = 0.2 * std::sqrt(before * after);
  return caution_of_wall * share_[place] * (larger(here, by_neighbours) + after);
}

}  // namespace gaiter::physics
