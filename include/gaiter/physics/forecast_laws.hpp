// SPDX-License-Identifier: BSD-2-Clause
#pragma once

#include "gaiter/physics/forecast_kernel.hpp"

// What the forecasts' loops over packs have in common.
namespace gaiter::physics::forecast {

#define GAITER_EACH for (int i = 0; i < pack_width; ++i)
#define GAITER_INLINE inline __attribute__((always_inline))

constexpr double largest_exponent = 300;

// Of an estimate of the leading order; of one for the leg's law, whose poles are known but for their
// strength.
constexpr double caution = 2;
constexpr double caution_of_leg = 2;
constexpr double caution_of_wall = 1.2;
constexpr double caution_of_mean = 1.3;  // where the value at mid-height stands for the mean over the height

GAITER_INLINE double clamped(double x) {
  const double below = x < largest_exponent ? x : largest_exponent;
  return below > -largest_exponent ? below : -largest_exponent;
}

GAITER_INLINE double larger(double a, double b) {
  return a > b ? a : b;
}

// The leg's strain, its derivative, and how fast that one changes.
GAITER_INLINE void strain_law(const ForecastInput& input, const Pack& pressure, Pack& strain,
                              Pack& response) {
  const auto& leg = input.leg;
  if (input.material == model::LegMaterial::neo_hookean) {
    Pack y;
    GAITER_EACH y[i] = 1;  // (r/R_c)^2
    for (int k = 0; k < 4; ++k) GAITER_EACH {
        const double low = y[i] > 0.05 ? y[i] : 0.05;
        y[i] = 1 - pressure[i] / (leg[0][i] + leg[1][i] * exp(-5.0 / 3 * log(low)));
      }
    GAITER_EACH {
      const double ratio = std::sqrt(y[i] > 0.05 ? y[i] : 0.05);
      strain[i] = 1 - ratio;
      response[i] = 0.5 / (leg[2][i] * ratio);
    }
    return;
  }
  GAITER_EACH {
    const double raised = leg[1][i] * pressure[i];
    const double grown = leg[0][i] * exp(raised < 100 ? raised : 100.0);
    const double decayed = leg[2][i] * exp(leg[3][i] * pressure[i]);
    strain[i] = grown + decayed;
    response[i] = leg[1][i] * grown + leg[3][i] * decayed;
  }
}

// Relief P_a, Eq. (8), by the voltage, and its slope over the logarithm of the leg's radius. `swell`: (r^2 -
// A^2)/A^2; `rate`: d r / d ln R over A.
GAITER_INLINE void relieving(const ForecastInput& input, const Pack& swell, const Pack& rate, Pack& relief,
                             Pack& slope) {
  GAITER_EACH {
    const double area = input.area[i];
    const double inner = larger(1 + swell[i], 1e-6), outer = inner + area;
    const double log_wall = log1p(area / inner);
    const double share = 1 / (inner * outer * log_wall);
    const double here = input.drive[i] * area * share / log_wall;
    relief[i] = here;
    slope[i] = here * (2 * area * share - 1 / inner - 1 / outer) * 2 * std::sqrt(inner) * rate[i];
  }
}

// The pressure has singularities over the (complex) height where the gain is -1, and Gauss's rule converges
// as the ellipse through them says. With an exponential of rate d in the leg's law, which gives the gain g
// in the middle, it is -1 at a pressure by (-ln g +- i pi)/d higher, and since d P = slope/(1 + gain) d ln R,
// in half heights this is (-ln g - 1 - g + s +- i pi)/u away, u = d slope d ln R, where s is what the other
// exponential's gain adds: d times its integral over the pressure, which counts for the second one only. The
// part that the singularity has in the pressure is 1/|d|.
GAITER_INLINE void find_pole(double gain, double log_gain, double added, double rate, double pressure,
                             double slope, double taper, double& part, double& fall) {
  const double steep = std::fabs(rate * slope * taper), least = 1e-9;
  const bool exists = gain > 1e-300 && pressure > 0;
  const double span = 1 / (steep > least ? steep : least);
  const double x = span * (log_gain + 1 + gain - added), y = span * M_PI;
  // |z + sqrt(z^2 - 1)| by the sum of the distances of z from -1 and 1.
  const double sum = 0.5 * (std::sqrt((x + 1) * (x + 1) + y * y) + std::sqrt((x - 1) * (x - 1) + y * y));
  const double beyond = sum * sum - 1;
  const double ellipse = sum + std::sqrt(beyond > 0 ? beyond : 0.0);
  part = exists ? caution_of_leg / std::fabs(rate * pressure) : 0;
  fall = exists ? 1 / (ellipse * ellipse) : 0;
}

GAITER_INLINE void find_poles(const ForecastInput& input, const Pack& pressure, const Pack& slope,
                              const Pack& response, LegPoles& poles) {
  const auto& leg = input.leg;
  if (input.material == model::LegMaterial::neo_hookean) {
    GAITER_EACH {
      const double rate = 2 * response[i];
      const double gain = input.gives_way[i] * std::fabs(slope[i] * rate) * exp(clamped(rate * pressure[i]));
      find_pole(gain, log(larger(gain, 1e-300)), 0, rate, pressure[i], slope[i], input.taper[i],
                poles.part[0][i], poles.fall[0][i]);
      poles.part[1][i] = poles.fall[1][i] = 0;
    }
    return;
  }
  GAITER_EACH {
    const double size = input.gives_way[i] * std::fabs(slope[i]), up = leg[1][i], down = leg[3][i];
    const double first = size * std::fabs(leg[0][i] * up) * exp(clamped(up * pressure[i]));
    const double second = size * std::fabs(leg[2][i] * down) * exp(clamped(down * pressure[i]));
    const double log_second = log(larger(second, 1e-300)), ratio = up != 0 && down != 0 ? up / down : -1.0;
    const double added = -first / ratio * (1 - exp(clamped(-ratio * log_second)));
    find_pole(first, log(larger(first, 1e-300)), 0, up, pressure[i], slope[i], input.taper[i],
              poles.part[0][i], poles.fall[0][i]);
    find_pole(second, log_second, added, down, pressure[i], slope[i], input.taper[i], poles.part[1][i],
              poles.fall[1][i]);
  }
}

}  // namespace gaiter::physics::forecast
