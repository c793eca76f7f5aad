// SPDX-License-Identifier: BSD-2-Clause
#pragma once

#include <cmath>
#include <limits>

#include "gaiter/physics/forecast_kernel.hpp"
#include "gaiter/physics/leg_law.hpp"

// What the forecasts' loops over packs have in common. Constants are written as floats, which numbers of
// either precision take without a conversion of their own.
namespace gaiter::physics::forecast {

#define GAITER_EACH for (int i = 0; i < pack_width; ++i)
#define GAITER_INLINE inline __attribute__((always_inline))

template <typename Number>
constexpr Number largest_exponent = sizeof(Number) == sizeof(double) ? 300 : 80;
template <typename Number>
constexpr Number least = 1 / std::numeric_limits<Number>::max();

// Of an estimate of the leading order; of one for the leg's law, whose poles are known but for their
// strength.
constexpr float caution = 2;
constexpr float caution_of_leg = 2;
constexpr float caution_of_wall = 1.2f;

template <typename Number>
GAITER_INLINE Number clamped(Number x) {
  const Number below = x < largest_exponent<Number> ? x : largest_exponent<Number>;
  return below > -largest_exponent<Number> ? below : -largest_exponent<Number>;
}

template <typename Number>
GAITER_INLINE Number larger(Number a, Number b) {
  return a > b ? a : b;
}

// Where the value at mid-height stands for the mean over the height, from where the pressure is by a part
// `raised` larger at an end.
template <typename Number>
GAITER_INLINE Number caution_of_mean(Number raised) {
  return Number(1.03) + (raised < 1 ? raised : Number(1));
}

// Each in a loop by itself: a call among other work would have all registers saved around it.
template <typename Number>
GAITER_INLINE void exp_each(const PackOf<Number>& x, PackOf<Number>& out) {
  GAITER_EACH out[i] = std::exp(x[i]);
}

template <typename Number>
GAITER_INLINE void log_each(const PackOf<Number>& x, PackOf<Number>& out) {
  GAITER_EACH out[i] = std::log(x[i]);
}

template <typename Number>
GAITER_INLINE void log1p_each(const PackOf<Number>& x, PackOf<Number>& out) {
  GAITER_EACH out[i] = std::log1p(x[i]);
}

// Those of the strain law, exp(bP) and exp(dP).
template <typename Number>
GAITER_INLINE void exponentials(const ForecastInput<Number>& input, const PackOf<Number>& pressure,
                                PackOf<Number>& first, PackOf<Number>& second) {
  GAITER_EACH {
    first[i] = clamped(input.leg[1][i] * pressure[i]);
    second[i] = clamped(input.leg[3][i] * pressure[i]);
  }
  exp_each(first, first);
  exp_each(second, second);
}

// The leg's strain, its derivative, and how fast that one changes.
template <typename Number>
GAITER_INLINE void strain_law(const ForecastInput<Number>& input, const PackOf<Number>& pressure,
                              PackOf<Number>& strain, PackOf<Number>& response) {
  const auto& leg = input.leg;
  if (input.material == model::LegMaterial::neo_hookean) {
    // (1 - y) (K + G/3 y^(-5/3)) = P by Newton's method, y = (r/R_c)^2.
    PackOf<Number> y, stiffness;
    GAITER_EACH y[i] = 1 / (1 + pressure[i] / leg[2][i]);
    for (int k = 0; k < 4; ++k) GAITER_EACH {
        constexpr Number power = Number(5.0 / 3);
        const Number low = larger(y[i], Number(0.05f)), shear = leg[1][i] * std::exp(-power * std::log(low));
        stiffness[i] = leg[0][i] + shear * (1 + power * (1 - low) / low);
        y[i] = low + ((1 - low) * (leg[0][i] + shear) - pressure[i]) / stiffness[i];
      }
    GAITER_EACH {
      const Number ratio = std::sqrt(larger(y[i], Number(0.05f)));
      strain[i] = 1 - ratio;
      response[i] = 0.5f / (stiffness[i] * ratio);
    }
    return;
  }
  PackOf<Number> grown, decayed;
  exponentials(input, pressure, grown, decayed);
  GAITER_EACH {
    const Number growing = leg[0][i] * grown[i], decaying = leg[2][i] * decayed[i];
    strain[i] = growing + decaying;
    response[i] = leg[1][i] * growing + leg[3][i] * decaying;
  }
}

// The pressure at which the leg's strain leaves the bandage slack.
template <typename Number>
GAITER_INLINE void limit_pressure(ForecastInput<Number>& input) {
  const auto& leg = input.leg;
  if (input.material == model::LegMaterial::neo_hookean) {
    GAITER_EACH input.pressure_limit[i] = neo_hookean_pressure_bound(leg[0][i], leg[1][i], input.slack[i]);
    return;
  }
  GAITER_EACH {
    const Number none = leg[0][i] + leg[2][i];
    input.pressure_limit[i] = strain_law_pressure_bound(leg[0][i], none, input.slack[i]) / leg[1][i];
  }
}

// Relief P_a, Eq. (8), by the voltage, and its slope over the logarithm of the leg's radius. `swell`: (r^2 -
// A^2)/A^2; `rate`: d r / d ln R over A.
template <typename Number>
GAITER_INLINE void relieving(const ForecastInput<Number>& input, const PackOf<Number>& swell,
                             const PackOf<Number>& rate, PackOf<Number>& relief, PackOf<Number>& slope) {
  PackOf<Number> log_wall;
  GAITER_EACH log_wall[i] = input.area[i] / larger(1 + swell[i], Number(1e-6f));
  log1p_each(log_wall, log_wall);
  GAITER_EACH {
    const Number area = input.area[i], inner = larger(1 + swell[i], Number(1e-6f)), outer = inner + area;
    const Number share = 1 / (inner * outer * log_wall[i]);
    const Number here = input.drive[i] * area * share * share * inner * outer;
    relief[i] = here;
    slope[i] = here * share * (2 * area - (inner + outer) * log_wall[i]) * 2 * std::sqrt(inner) * rate[i];
  }
}

// The pressure has singularities over the (complex) height where the gain is -1, and Gauss's rule converges
// as the ellipse through them says. With an exponential of rate d in the leg's law, which gives the gain g
// in the middle, it is -1 at a pressure by (-ln g +- i pi)/d higher, and since d P = slope/(1 + gain) d ln R,
// in half heights this is (-ln g - 1 - g + s +- i pi)/u away, u = d slope d ln R, where s is what the other
// exponential's gain adds: d times its integral over the pressure, which counts for the second one only. The
// part that the singularity has in the pressure is 1/|d|.
template <typename Number>
GAITER_INLINE void find_pole(Number gain, Number log_gain, Number added, Number rate, Number pressure,
                             Number slope, Number taper, Number& part, Number& fall) {
  const Number steep = std::fabs(rate * slope * taper);
  const bool exists = gain > least<Number> && pressure > 0;
  const Number span = 1 / larger(steep, Number(1e-9f));
  const Number x = span * (log_gain + 1 + gain - added), y = span * Number(M_PI);
  // The ellipse's half axes a and b by the distances of z from -1 and 1, of sum 2 a; of it, (a + b)^2 counts.
  const Number left = (x + 1) * (x + 1) + y * y, right = (x - 1) * (x - 1) + y * y;
  const Number square = 0.25f * (left + right) + 0.5f * std::sqrt(left * right);  // a^2
  const Number ellipse = 2 * square - 1 + 2 * std::sqrt(square * larger(square - 1, Number(0)));
  part = exists ? caution_of_leg / std::fabs(rate * pressure) : 0;
  fall = exists ? 1 / ellipse : 0;
}

template <typename Number>
GAITER_INLINE void find_poles(const ForecastInput<Number>& input, const PackOf<Number>& pressure,
                              const PackOf<Number>& slope, const PackOf<Number>& response,
                              LegPoles<Number>& poles) {
  const auto& leg = input.leg;
  PackOf<Number> first, second, log_first, log_second, added;
  if (input.material == model::LegMaterial::neo_hookean) {
    GAITER_EACH {
      const Number rate = 2 * response[i];
      first[i] = input.gives_way[i] * std::fabs(slope[i] * rate) * std::exp(clamped(rate * pressure[i]));
      log_first[i] = std::log(larger(first[i], least<Number>));
      find_pole(first[i], log_first[i], Number(0), rate, pressure[i], slope[i], input.taper[i],
                poles.part[0][i], poles.fall[0][i]);
      poles.part[1][i] = poles.fall[1][i] = 0;
    }
    return;
  }
  exponentials(input, pressure, first, second);
  GAITER_EACH {
    const Number size = input.gives_way[i] * std::fabs(slope[i]);
    first[i] *= size * std::fabs(leg[0][i] * leg[1][i]);
    second[i] *= size * std::fabs(leg[2][i] * leg[3][i]);
    log_first[i] = larger(first[i], least<Number>);
    log_second[i] = larger(second[i], least<Number>);
  }
  log_each(log_first, log_first);
  log_each(log_second, log_second);
  GAITER_EACH {
    const Number up = leg[1][i], down = leg[3][i];
    added[i] = clamped(up != 0 && down != 0 ? -up / down * log_second[i] : log_second[i]);
  }
  exp_each(added, added);
  GAITER_EACH {
    const Number up = leg[1][i], down = leg[3][i];
    const Number ratio = up != 0 && down != 0 ? -down / up : Number(1);
    find_pole(first[i], log_first[i], Number(0), up, pressure[i], slope[i], input.taper[i], poles.part[0][i],
              poles.fall[0][i]);
    find_pole(second[i], log_second[i], first[i] * ratio * (1 - added[i]), down, pressure[i], slope[i],
              input.taper[i], poles.part[1][i], poles.fall[1][i]);
  }
}

}  // namespace gaiter::physics::forecast
