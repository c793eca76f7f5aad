// SPDX-License-Identifier: BSD-2-Clause
#include "gaiter/physics/forecast_kernel.hpp"

#include <limits>

#include "gaiter/physics/quadrature.hpp"

namespace gaiter::physics {

namespace {

#define GAITER_EACH for (int i = 0; i < pack_width; ++i)
#define GAITER_INLINE inline __attribute__((always_inline))

constexpr double nan = std::numeric_limits<double>::quiet_NaN();
constexpr double largest_exponent = 300;
constexpr int most_steps = 8, steps_at_end = 2;  // of Newton's method for a forecast

GAITER_INLINE double clamped(double x) {
  const double below = x < largest_exponent ? x : largest_exponent;
  return below > -largest_exponent ? below : -largest_exponent;
}

GAITER_INLINE double larger(double a, double b) {
  return a > b ? a : b;
}

// P_m, Eq. (4), and with `voltage` less P_a, Eq. (8); their slope over the logarithm of the leg's radius. The
// radius is that of the segment times (1 + `wider`).
GAITER_INLINE void pressing(const ForecastInput& input, bool voltage, const Pack& wider, Pack& pressure,
                            Pack& slope, Pack& passive) {
  Pack swell, x, stress, stress_slope, inverse;
  GAITER_EACH {
    const double wanted = input.gap[i] + input.leg_radius[i] * wider[i];
    const double excess = wanted > -0.999 ? wanted : -0.999;
    swell[i] = excess * (2 + excess);
    pressure[i] = slope[i] = 0;
  }
  for (const Pack& ratio : input.wall_ratio) {
    GAITER_EACH {
      const double square = swell[i] * ratio[i];
      x[i] = 0.5 * log1p(square);
      inverse[i] = 1 / (1 + square);
      stress[i] = stress_slope[i] = 0;
    }
    for (const ForecastInput::Term& term : input.terms) {
      GAITER_EACH {
        const double power = exp(clamped(term.alpha[i] * x[i])), reciprocal = 1 / power;
        const double sine = 0.5 * (power - reciprocal);
        stress[i] += term.mu[i] * sine;
        stress_slope[i] += term.mu[i] * (term.alpha[i] * 0.5 * (power + reciprocal) - 2 * sine);
      }
    }
    GAITER_EACH {
      pressure[i] += 0.5 * stress[i] * inverse[i];
      slope[i] += 0.5 * stress_slope[i] * inverse[i] * inverse[i] * ratio[i];
    }
  }
  GAITER_EACH {
    const double radius = 1 + input.gap[i] + input.leg_radius[i] * wider[i];
    pressure[i] *= input.log_area[i];
    slope[i] *= input.log_area[i] * radius * input.leg_radius[i] * (1 + wider[i]);
    passive[i] = pressure[i];
  }
  if (!voltage) return;
  Pack area;
  GAITER_EACH area[i] = expm1(input.log_area[i]);  // (B^2 - A^2)/A^2
  GAITER_EACH {
    const double inner = larger(1 + swell[i], 1e-6), outer = inner + area[i];
    const double log_wall = log1p(area[i] / inner);
    const double relief = input.drive[i] * area[i] / (inner * outer * log_wall * log_wall);
    const double relative = -1 / inner - 1 / outer + 2 * area[i] / (inner * outer * log_wall);
    pressure[i] -= relief;
    slope[i] -= relief * relative * 2 * std::sqrt(inner) * input.leg_radius[i] * (1 + wider[i]);
  }
}

// The leg's strain, its derivative, and how fast that one changes.
GAITER_INLINE void strain_law(const ForecastInput& input, const Pack& pressure, Pack& strain, Pack& response,
                              Pack& bending) {
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
      bending[i] = 1 / leg[2][i];
    }
    return;
  }
  GAITER_EACH {
    const double raised = leg[1][i] * pressure[i];
    const double grown = leg[0][i] * exp(raised < 100 ? raised : 100.0);
    const double decayed = leg[2][i] * exp(leg[3][i] * pressure[i]);
    strain[i] = grown + decayed;
    response[i] = leg[1][i] * grown + leg[3][i] * decayed;
    bending[i] = std::fabs(leg[1][i] * leg[1][i] * grown + leg[3][i] * leg[3][i] * decayed) /
                 (response[i] > 1e-300 ? response[i] : 1e-300);
  }
}

}  // namespace

namespace {

// Safeguarded Newton's method for the equilibrium of a slice whose radius is 1 + `outline` times the
// segment's, where `open`; until it is known to a fiftieth of its distance from `first`, or after some steps.
GAITER_INLINE void equilibrium(const ForecastInput& input, bool voltage, const Pack& outline, int most_steps,
                               const Pack& limit, Pack& open, const Pack& first, ForecastState& s) {
  Pack low, high, wider, found, slope, passive, strain, response, bending;
  GAITER_EACH {
    low[i] = 0;
    high[i] = limit[i];
  }
  for (int step = 0; step < most_steps; ++step) {
    strain_law(input, s.pressure, strain, response, bending);
    GAITER_EACH wider[i] = (1 + outline[i]) * (1 - strain[i]) - 1;
    pressing(input, voltage, wider, found, slope, passive);
    double left = 0;
    GAITER_EACH {
      const bool counts = open[i] > 0;
      const double pressure = s.pressure[i], residual = pressure - found[i];
      low[i] = counts && residual < 0 ? pressure : low[i];
      high[i] = counts && !(residual < 0) ? pressure : high[i];
      const double yielding = slope[i] * response[i] / larger(1 - strain[i], 0.05);
      // Newton's step for ln P = ln P_t where the two are far apart, else for P = P_t.
      const bool far = found[i] > 4 * pressure || (found[i] > 0 && pressure > 4 * found[i]);
      const double ratio = found[i] > 1e-300 * pressure ? found[i] / pressure : 1e-300;
      const double in_log = pressure * exp(log(ratio) / (1 + yielding / ratio));
      double next = far ? in_log : pressure - residual / (1 + yielding);
      const double middle = low[i] > 0 ? std::sqrt(low[i] * high[i]) : 0.5 * (low[i] + high[i]);
      next = next > low[i] && next < high[i] ? next : middle;
      const double change = std::fabs(next - pressure);
      const double enough = larger(1e-9 * next, 0.02 * std::fabs(next - first[i]));
      s.pressure[i] = counts ? next : pressure;
      s.strain[i] = counts ? strain[i] + response[i] * (next - pressure) : s.strain[i];
      s.response[i] = counts ? response[i] : s.response[i];
      s.slope[i] = counts ? slope[i] : s.slope[i];
      s.passive[i] = counts ? passive[i] : s.passive[i];
      s.gain[i] = counts ? (yielding > 0 ? yielding : 0) : s.gain[i];
      open[i] = change < enough ? 0 : open[i];
      left += open[i];
    }
    if (!(left > 0)) break;
  }
}

}  // namespace

GAITER_MULTIVERSION
void ForecastInput::close() {
  // Gauss-Legendre, 2 points on (0, 1).
  constexpr std::array<double, 2> nodes{0.21132486540518713, 0.78867513459481287};
  for (std::size_t j = 0; j < nodes.size(); ++j) GAITER_EACH wall_ratio[j][i] = exp(-log_area[i] * nodes[j]);
}

// The first order is the start that slices have (start_at_rest).
GAITER_MULTIVERSION
void forecast_state(const ForecastInput& input, bool voltage, const ForecastState* rest, ForecastState& s) {
  Pack wider, unused, none, open, found, bending, slope;
  GAITER_EACH none[i] = 0;
  pressing(input, voltage, none, s.rigid, s.slope, s.passive);
  GAITER_EACH {
    const double limit = input.pressure_limit[i], rigid = s.rigid[i];
    open[i] = rigid > 0 && input.gives_way[i] > 0 ? 1 : 0;
    s.pressure[i] = rigid < limit ? rigid : limit;
    if (!(rigid > 0)) s.pressure[i] = 0;
  }
  strain_law(input, s.pressure, s.strain, s.response, bending);
  GAITER_EACH {
    const double limit = input.pressure_limit[i], rigid = s.rigid[i], pressure = s.pressure[i];
    const double k = rigid > 0 ? s.slope[i] / rigid : 0;
    const double step = -pressure * k * s.strain[i] / (1 + pressure * k * s.response[i]);
    const double moved = pressure + step > 0 ? pressure + step : 0.5 * pressure;
    s.first[i] = open[i] > 0 ? (rigid <= limit && moved < limit ? moved : pressure) : rigid;
    s.pressure[i] = s.first[i];
    s.gain[i] = 0;
    if (!(open[i] > 0)) s.strain[i] = s.response[i] = 0;
  }
  if (rest) GAITER_EACH {
      // From the state at rest, by the relief that the leg's giving way leaves.
      const double relieved = rest->pressure[i] - (rest->rigid[i] - s.rigid[i]) / (1 + rest->gain[i]);
      const bool better = relieved > 0.3 * rest->pressure[i] && relieved < input.pressure_limit[i];
      s.pressure[i] = open[i] > 0 && better ? relieved : s.pressure[i];
    }
  equilibrium(input, voltage, none, most_steps, input.pressure_limit, open, s.first, s);

  // The ends: which are open, and the pressure at the narrow one, at which the leg is softest.
  strain_law(input, none, wider, unused, bending);
  Pack strain_of_none = wider, outline;
  GAITER_EACH {
    strain_of_none[i] = input.gives_way[i] > 0 ? strain_of_none[i] : 0;
    outline[i] = -std::fabs(input.taper[i]);
    wider[i] = (1 + outline[i]) * (1 - strain_of_none[i]) - 1;
  }
  pressing(input, voltage, wider, s.narrow_net, unused, found);
  s.wide_net = s.narrow_net;  // where the narrow end touches, so does the other
  double open_ends = 0;
  GAITER_EACH open_ends += s.narrow_net[i] > 0 ? 0 : 1;
  if (open_ends > 0) {
    GAITER_EACH wider[i] = (1 - outline[i]) * (1 - strain_of_none[i]) - 1;
    pressing(input, voltage, wider, unused, slope, found);
    GAITER_EACH s.wide_net[i] = s.narrow_net[i] > 0 ? s.narrow_net[i] : unused[i];
  }
  ForecastState& end = s;  // its pressure moves on, and comes back
  const Pack pressure = s.pressure, strain = s.strain, response = s.response, passive = s.passive,
             gain = s.gain;
  Pack limit;
  slope = s.slope;
  GAITER_EACH {
    open[i] = s.narrow_net[i] > 0 && s.pressure[i] > 0 && input.gives_way[i] > 0 ? 1 : 0;
    const double net = larger(s.narrow_net[i], 0), middle = s.pressure[i];
    limit[i] = net < middle ? net : middle;
    const double share = s.rigid[i] > 0 && net < s.rigid[i] ? net / s.rigid[i] : 1;
    end.pressure[i] = larger(0.999 * limit[i] * share, 1e-300);
  }
  equilibrium(input, voltage, outline, steps_at_end, limit, open, limit, end);
  GAITER_EACH s.narrow[i] = input.gives_way[i] > 0 ? end.pressure[i] : larger(s.narrow_net[i], 0);
  s.pressure = pressure;
  s.strain = strain;
  s.response = response;
  s.slope = slope;
  s.passive = passive;
  s.gain = gain;
}

// Through the wall, over t = ln(B.../A) of the reference radius squared, a power m of w = 1/lambda^2 obeys
//   d/dt sum_j c_j w^(m+j) = L sum_j (m+j) c_j (w^(m+j) - w^(m+j+1)),
// exactly; over the height it is taken for a power of the radius.
GAITER_MULTIVERSION
void forecast_errors(const ForecastInput& input, const Pack& strain, ForecastErrors& errors) {
  constexpr int derivatives = 6;
  static const auto constants = [] {
    std::array<double, forecast_points + 2> all{};
    for (int n = 1; n < static_cast<int>(all.size()); ++n) all[n] = gauss_error_constant(n);
    return all;
  }();
  std::array<Pack, derivatives / 2 + 1> through{};  // even derivatives through the wall
  std::array<Pack, forecast_points + 2>& height = errors.height;
  Pack x, w, share;
  GAITER_EACH {
    height[0][i] = 0;
    const double radius = 1 + input.gap[i] - input.leg_radius[i] * strain[i];
    const double swell = radius * radius - 1, middle = exp(-0.5 * input.log_area[i]);
    const double square = larger(swell * middle, -0.999);
    x[i] = 0.5 * log1p(square);
    w[i] = 1 / (1 + square);
    // d ln lambda / d ln R at mid-wall.
    share[i] = radius * middle * w[i] * input.leg_radius[i] * (1 - strain[i]);
  }
  for (int n = 1; n < static_cast<int>(height.size()); ++n) GAITER_EACH height[n][i] = 0;
  for (const ForecastInput::Term& term : input.terms)
    for (const double sign : {1.0, -1.0}) {
      Pack size, exponent;
      GAITER_EACH {
        exponent[i] = sign * term.alpha[i] - 2;
        size[i] = sign * 0.5 * term.mu[i] * input.log_area[i] * exp(clamped(exponent[i] * x[i]));
      }
      std::array<Pack, derivatives + 1> c;
      GAITER_EACH {
        c[0][i] = size[i];
        through[0][i] += size[i];
      }
      for (int k = 1; k <= derivatives; ++k) {
        GAITER_EACH c[k][i] = 0;
        for (int j = k; j >= 0; --j) GAITER_EACH {
            const double m = -0.5 * exponent[i] + j;
            const double from = j > 0 ? (m - 1) * c[j - 1][i] * w[i] : 0;
            c[j][i] = input.log_area[i] * (m * c[j][i] - from);
          }
        if (k % 2 == 0)
          for (int j = 0; j <= k; ++j) GAITER_EACH through[k / 2][i] += c[j][i];
      }
      Pack part = size;
      for (int n = 1; n < static_cast<int>(height.size()); ++n) GAITER_EACH {
          const double power = exponent[i] * share[i] - (2 * n - 2), span = 2 * input.taper[i];
          part[i] *= power * (power - 1) * span * span;
          height[n][i] += part[i];
        }
    }
  for (int n = 1; n < static_cast<int>(height.size()); ++n)
    GAITER_EACH height[n][i] = constants[n] * std::fabs(height[n][i]);
  GAITER_EACH errors.wall[0][i] = std::fabs(through[0][i]);
  for (int n = 1; n <= derivatives / 2; ++n)
    GAITER_EACH errors.wall[n][i] = constants[n] * std::fabs(through[n][i]);
  // Beyond, each fall is taken to be no faster than the last, but for the rule's own constant.
  constexpr int last = derivatives / 2;
  Pack ratio;
  GAITER_EACH {
    const double one = std::fabs(through[1][i]), two = std::fabs(through[2][i]),
                 three = std::fabs(through[3][i]);
    const double a = two > 0 ? three / two : 0, b = one > 0 ? two / one : 0;
    const double pole = input.log_area[i] * input.log_area[i];
    ratio[i] = 1.5 * larger(larger(a, b), pole);
  }
  for (int n = last + 1; n < static_cast<int>(errors.wall.size()); ++n)
    GAITER_EACH errors.wall[n][i] = errors.wall[n - 1][i] * ratio[i] * constants[n] / constants[n - 1];
}

GAITER_MULTIVERSION
void forecast_sliding(const ForecastInput& input, bool voltage, Pack& change) {
  Pack x, stretch, push, coupling, axial, difference_slope;  // w_r, w_rz, w_zz, (D/r)' r
  GAITER_EACH {
    const double swell = input.gap[i] * (2 + input.gap[i]);
    x[i] = 0.5 * log1p(larger(swell * exp(-0.5 * input.log_area[i]), -0.999));
    stretch[i] = exp(x[i]);
    push[i] = coupling[i] = axial[i] = difference_slope[i] = 0;
  }
  for (const ForecastInput::Term& term : input.terms) GAITER_EACH {
      const double a = term.alpha[i], mu = term.mu[i], up = exp(clamped(a * x[i])), down = 1 / up;
      push[i] += mu * (up - down) / stretch[i];
      coupling[i] += mu * a * down / stretch[i];
      axial[i] += mu * ((a - 1) + (a + 1) * down);
      difference_slope[i] += mu * ((a - 2) * up + (a + 2) * (1 + a) * down) / (stretch[i] * stretch[i]);
    }
  GAITER_EACH {
    // Energy -1/2 eps V^2 z'^2 r^2/(A h): in units of h, with r = stretch A.
    const double drive = voltage ? input.membrane_drive[i] : 0;
    const double pushed = push[i] - drive * stretch[i], coupled = coupling[i] - 2 * drive * stretch[i],
                 along = axial[i] - drive * stretch[i] * stretch[i];
    const double laid = (std::sqrt(1 + input.slope[i] * input.slope[i]) - 1) * coupled / pushed;
    const double slid =
        input.rise[i] * input.rise[i] * (pushed - coupled) * difference_slope[i] / (12 * along * pushed);
    const double held = input.slides[i] > 0 ? laid - slid : laid;
    // Wrinkled where the axial stiffness is gone.
    change[i] = pushed > 0 && (along > 0 || !(input.slides[i] > 0)) ? held : nan;
  }
}

}  // namespace gaiter::physics
