// SPDX-License-Identifier: BSD-2-Clause
#pragma once

#include <utility>

#include "gaiter/physics/forecast_laws.hpp"
#include "gaiter/physics/quadrature.hpp"

namespace gaiter::physics::forecast {

constexpr int wall_derivatives = 6;

// Through the wall, over t = ln(B.../A) of the reference radius squared, a power m of w = 1/lambda^2 obeys
//   d/dt sum_j c_j w^(m+j) = L sum_j (m+j) c_j (w^(m+j) - w^(m+j+1)),
// exactly. Here c_j stands for c_j w^j, and all are divided by L; there are `order` of them before.
template <int order, typename Number>
GAITER_INLINE void differentiate(Number (&c)[wall_derivatives + 1], Number m, Number w) {
  [&]<int... back>(std::integer_sequence<int, back...>) {
    ((c[order - back] =
          (back > 0 ? (m + (order - back)) * c[order - back] : Number(0)) -
          (back < order ? (m + (order - back - 1)) * c[order - back - (back < order)] * w : Number(0))),
     ...);
  }
  (std::make_integer_sequence<int, order + 1>{});
}

// ForecastErrors. Over the height a term of the pressure is taken for a power of the radius.
template <typename Number>
GAITER_INLINE void find_errors(const ForecastInput<Number>& input, const PackOf<Number>& strain,
                               ForecastErrors<Number>& errors) {
  using Pack = PackOf<Number>;
  constexpr int rules = forecast_points + 2;
  static const auto constants = [] {
    std::array<Number, rules> all{};
    for (int n = 1; n < rules; ++n) all[n] = static_cast<Number>(gauss_error_constant(n));
    return all;
  }();
  std::array<Pack, wall_derivatives / 2 + 1> through;  // even derivatives through the wall
  std::array<Pack, rules>& height = errors.height;
  Pack x, w, share;
  GAITER_EACH {
    const Number radius = 1 + input.gap[i] - input.leg_radius[i] * strain[i];
    const Number swell = radius * radius - 1, middle = input.middle[i];
    const Number square = larger(swell * middle, Number(-0.999f));
    x[i] = square;
    w[i] = 1 / (1 + square);
    // d ln lambda / d ln R at mid-wall.
    share[i] = radius * middle * w[i] * input.leg_radius[i] * (1 - strain[i]);
    through[0][i] = through[1][i] = through[2][i] = through[3][i] = 0;
  }
  log1p_each(x, x);
  for (Pack& rule : height) GAITER_EACH rule[i] = 0;
  for (const auto& term : input.terms) {
    Pack power;
    GAITER_EACH power[i] = clamped(term.alpha[i] * x[i] / 2);
    exp_each(power, power);
    for (const Number sign : {Number(1), Number(-1)}) {
      Pack size;
      GAITER_EACH {
        const Number here = sign > 0 ? power[i] : -1 / power[i];
        size[i] = 0.5f * term.mu[i] * input.log_area[i] * w[i] * here;
      }
      GAITER_EACH {
        const Number m = 1 - 0.5f * sign * term.alpha[i], square = input.log_area[i] * input.log_area[i];
        Number c[wall_derivatives + 1] = {size[i]};
        through[0][i] += c[0];
        differentiate<1>(c, m, w[i]);
        differentiate<2>(c, m, w[i]);
        through[1][i] += square * (c[0] + c[1] + c[2]);
        differentiate<3>(c, m, w[i]);
        differentiate<4>(c, m, w[i]);
        through[2][i] += square * square * (c[0] + c[1] + c[2] + c[3] + c[4]);
        differentiate<5>(c, m, w[i]);
        differentiate<6>(c, m, w[i]);
        through[3][i] += square * square * square * (c[0] + c[1] + c[2] + c[3] + c[4] + c[5] + c[6]);
      }
      GAITER_EACH {
        const Number exponent = (sign * term.alpha[i] - 2) * share[i];
        const Number span = 4 * input.taper[i] * input.taper[i];
        Number part = size[i];
        [&]<int... before>(std::integer_sequence<int, before...>) {
          ((part *= (exponent - 2 * before) * (exponent - 2 * before - 1) * span,
            height[before + 1][i] += part),
           ...);
        }
        (std::make_integer_sequence<int, rules - 1>{});
      }
    }
  }
  for (int n = 1; n < rules; ++n) GAITER_EACH height[n][i] = constants[n] * std::fabs(height[n][i]);
  GAITER_EACH errors.wall[0][i] = std::fabs(through[0][i]);
  constexpr int last = wall_derivatives / 2;
  for (int n = 1; n <= last; ++n) GAITER_EACH errors.wall[n][i] = constants[n] * std::fabs(through[n][i]);
  // Beyond, each fall is taken to be no faster than the last, but for the rule's own constant.
  Pack ratio;
  GAITER_EACH {
    const Number one = std::fabs(through[1][i]), two = std::fabs(through[2][i]),
                 three = std::fabs(through[3][i]);
    const Number a = two > 0 ? three / two : Number(0), b = one > 0 ? two / one : Number(0);
    const Number pole = input.log_area[i] * input.log_area[i];
    ratio[i] = 1.5f * larger(larger(a, b), pole);
  }
  for (int n = last + 1; n < rules; ++n) {
    const Number fall = constants[n] / constants[n - 1];
    GAITER_EACH errors.wall[n][i] = errors.wall[n - 1][i] * ratio[i] * fall;
  }
}

}  // namespace gaiter::physics::forecast
