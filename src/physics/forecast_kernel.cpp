// SPDX-License-Identifier: BSD-2-Clause
#include "gaiter/physics/forecast_kernel.hpp"

#include <algorithm>
#include <limits>

#include "gaiter/physics/forecast_errors.hpp"
#include "gaiter/physics/leg_law.hpp"
#include "gaiter/physics/slice_system.hpp"

namespace gaiter::physics {

namespace {

using namespace forecast;

constexpr double vacuum_permittivity = 8.8541878128e-12;  // [F/m]
constexpr double nan = std::numeric_limits<double>::quiet_NaN();
constexpr int most_steps = 8;  // of Newton's method for a forecast
constexpr int most_steps_to_cut = 40;
constexpr double error_of_cut = 1e-6;  // over the height; that of the mean pressure goes with its square

// P_m, Eq. (4), and with `voltage` less P_a, Eq. (8); their slope over the logarithm of the leg's radius. The
// radius is that of the segment times (1 + `wider`). By two Gauss points through the wall.
using WallRatios = std::array<Pack, 2>;  // A^2/s
using Input = ForecastInput<double>;

GAITER_INLINE void pressing(const Input& input, const WallRatios& wall, bool voltage, const Pack& wider,
                            Pack& pressure, Pack& slope, Pack& passive) {
  Pack swell, x, stress, stress_slope, inverse;
  GAITER_EACH {
    const double wanted = input.gap[i] + input.leg_radius[i] * wider[i];
    const double excess = wanted > -0.999 ? wanted : -0.999;
    swell[i] = excess * (2 + excess);
    pressure[i] = slope[i] = 0;
  }
  for (const Pack& ratio : wall) {
    GAITER_EACH {
      const double square = swell[i] * ratio[i];
      x[i] = 0.5 * log1p(square);
      inverse[i] = 1 / (1 + square);
      stress[i] = stress_slope[i] = 0;
    }
    for (const Input::Term& term : input.terms) {
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
  Pack rate, relief, relief_slope;
  GAITER_EACH rate[i] = input.leg_radius[i] * (1 + wider[i]);
  relieving(input, swell, rate, relief, relief_slope);
  GAITER_EACH {
    pressure[i] -= relief[i];
    slope[i] -= relief_slope[i];
  }
}

GAITER_INLINE void find_wall_ratios(const Input& input, WallRatios& wall) {
  // Gauss-Legendre, 2 points on (0, 1).
  constexpr std::array<double, 2> nodes{0.21132486540518713, 0.78867513459481287};
  for (std::size_t j = 0; j < nodes.size(); ++j) GAITER_EACH wall[j][i] = exp(-input.log_area[i] * nodes[j]);
}

// What a leg without pressure has left of its radius.
GAITER_INLINE void find_unloaded(const Input& input, Pack& left) {
  Pack none, response;
  GAITER_EACH none[i] = 0;
  strain_law(input, none, left, response);
  GAITER_EACH left[i] = input.gives_way[i] > 0 ? 1 - left[i] : 1;
}

// Safeguarded Newton's method for the equilibrium of a slice whose radius is 1 + `outline` times the
// segment's, where `open`; until it is known to a fiftieth of its distance from `first`, or after some steps.
GAITER_INLINE void equilibrium(const Input& input, const WallRatios& wall, bool voltage, Pack& open,
                               ForecastState& s) {
  Pack low, high, wider, found, slope, passive, strain, response;
  GAITER_EACH {
    low[i] = 0;
    high[i] = input.pressure_limit[i];
  }
  for (int step = 0; step < most_steps; ++step) {
    strain_law(input, s.pressure, strain, response);
    GAITER_EACH wider[i] = -strain[i];
    pressing(input, wall, voltage, wider, found, slope, passive);
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
      const double enough = larger(1e-9 * next, 0.02 * std::fabs(next - s.first[i]));
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

template <typename Number>
void ForecastInput<Number>::start(const model::Scene& scene) {
  material = scene.leg.material;
  terms.resize(scene.bandage.ogden.size());
  energised = false;
}

template <typename Number>
void ForecastInput<Number>::set(int lane, const model::Scene& scene, std::size_t segment) {
  const model::Segment& part = scene.leg.segments[segment];
  const model::Bandage& bandage = scene.bandage;
  const model::Module& module = bandage.modules[segment];
  const double radius = part.mean_radius();
  const Wall wall = reference_wall(bandage, module, radius, radius);
  mean_radius[lane] = radius;
  rise[lane] = part.upper_radius - part.lower_radius;
  height[lane] = part.height;
  inner_radius[lane] = wall.inner_radius;
  thickness[lane] = wall.thickness;
  gap[lane] = wall.gap;
  voltage[lane] = module.voltage * bandage.layers;
  electric[lane] = vacuum_permittivity * bandage.permittivity;
  gives_way[lane] = scene.leg.model == model::LegModel::rigid ? 0 : 1;
  slides[lane] = scene.contact_axial == model::ContactAxial::free ? 1 : 0;
  energised = energised || module.voltage != 0;
  if (material == model::LegMaterial::neo_hookean) {
    const LegConstants constants = leg_constants(scene.leg, part);
    leg[0][lane] = constants.value[0] * constants.pressure_scale;
    leg[1][lane] = constants.value[1] * constants.pressure_scale;
    leg[2][lane] = leg[0][lane] + leg[1][lane];
    leg[3][lane] = 0;
  } else {
    const model::Compliance& law = part.compliance;
    leg[0][lane] = law.a;
    leg[1][lane] = law.b;
    leg[2][lane] = scene.leg.variant == model::ComplianceVariant::anchored ? -law.a : law.c;
    leg[3][lane] = law.d;
  }
  for (std::size_t term = 0; term < terms.size(); ++term) {
    terms[term].mu[lane] = bandage.ogden[term].mu;
    terms[term].alpha[lane] = bandage.ogden[term].alpha;
  }
}

namespace {

template <typename Number>
GAITER_INLINE void finish(ForecastInput<Number>& input, int count) {
  auto &leg = input.leg, &gap = input.gap;
  for (auto* row = &input.mean_radius; row <= &leg[3]; ++row)
    for (int i = count; i < pack_width; ++i) (*row)[i] = (*row)[count - 1];
  for (auto& term : input.terms)
    for (int i = count; i < pack_width; ++i) {
      term.mu[i] = term.mu[count - 1];
      term.alpha[i] = term.alpha[count - 1];
    }
  GAITER_EACH {
    const Number inner = 1 / input.inner_radius[i], wall = input.thickness[i] * inner;
    gap[i] *= inner;
    input.leg_radius[i] = input.mean_radius[i] * inner;
    input.area[i] = wall * (2 + wall);
    input.middle[i] = 1 / std::sqrt(1 + input.area[i]);
    const Number over = 1 / input.mean_radius[i], field = input.voltage[i] * inner;
    input.taper[i] = 0.5f * input.rise[i] * over;
    input.drive[i] = 2 * input.electric[i] * field * field;
    input.slack[i] = gap[i] * input.inner_radius[i] * over;
  }
  log1p_each(input.area, input.log_area);
  limit_pressure(input);
}

}  // namespace

template <>
GAITER_MULTIVERSION void ForecastInput<double>::close(int count) {
  finish(*this, count);
}

template <>
GAITER_MULTIVERSION void ForecastInput<float>::close(int count) {
  finish(*this, count);
}

template struct ForecastInput<double>;
template struct ForecastInput<float>;

// The first order is the start that slices have (start_at_rest).
GAITER_MULTIVERSION
void forecast_state(const ForecastInput<double>& input, bool voltage, const ForecastState* rest,
                    ForecastState& s) {
  Pack wider, unused, none, open, found, slope;
  WallRatios wall;
  find_wall_ratios(input, wall);
  GAITER_EACH none[i] = 0;
  pressing(input, wall, voltage, none, s.rigid, s.slope, s.passive);
  GAITER_EACH {
    const double limit = input.pressure_limit[i], rigid = s.rigid[i];
    open[i] = rigid > 0 && input.gives_way[i] > 0 ? 1 : 0;
    s.pressure[i] = rigid < limit ? rigid : limit;
    if (!(rigid > 0)) s.pressure[i] = 0;
  }
  strain_law(input, s.pressure, s.strain, s.response);
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
  equilibrium(input, wall, voltage, open, s);

  // Which ends are open.
  Pack left;
  find_unloaded(input, left);
  GAITER_EACH wider[i] = (1 - std::fabs(input.taper[i])) * left[i] - 1;
  pressing(input, wall, voltage, wider, s.narrow_net, unused, found);
  s.wide_net = s.narrow_net;  // where the narrow end touches, so does the other
  double open_ends = 0;
  GAITER_EACH open_ends += s.narrow_net[i] > 0 ? 0 : 1;
  if (open_ends > 0) {
    GAITER_EACH wider[i] = (1 + std::fabs(input.taper[i])) * left[i] - 1;
    pressing(input, wall, voltage, wider, unused, slope, found);
    GAITER_EACH s.wide_net[i] = s.narrow_net[i] > 0 ? s.narrow_net[i] : unused[i];
  }
  find_poles(input, s.pressure, s.slope, s.response, s.poles);
}

GAITER_MULTIVERSION
void forecast_cut(const ForecastInput<double>& input, const ForecastState& state, Pack& open, Pack& height) {
  WallRatios wall;
  Pack left, low, high, place, wider, net, slope, unused;  // places: -1 at the narrow end, 1 at the wide one
  find_wall_ratios(input, wall);
  find_unloaded(input, left);
  GAITER_EACH {
    low[i] = -1;
    high[i] = 1;
    const double sum = state.wide_net[i] - state.narrow_net[i];
    place[i] = open[i] > 0 ? -(state.wide_net[i] + state.narrow_net[i]) / sum : 0;
  }
  for (int step = 0; step < most_steps_to_cut; ++step) {
    GAITER_EACH wider[i] = (1 + std::fabs(input.taper[i]) * place[i]) * left[i] - 1;
    pressing(input, wall, true, wider, net, slope, unused);
    double still = 0;
    GAITER_EACH {
      const bool counts = open[i] > 0, beyond = (net[i] > 0) == (state.wide_net[i] > 0);
      const double here = place[i], taper = std::fabs(input.taper[i]);
      high[i] = counts && beyond ? here : high[i];
      low[i] = counts && !beyond ? here : low[i];
      const double newton = here - net[i] * (1 + taper * here) / (taper * slope[i]);
      const double next = newton > low[i] && newton < high[i] ? newton : 0.5 * (low[i] + high[i]);
      place[i] = counts ? next : here;
      open[i] = counts && std::fabs(next - here) > 2 * error_of_cut ? 1 : 0;
      still += open[i];
    }
    if (!(still > 0)) break;
  }
  GAITER_EACH height[i] = 0.5 * (1 + (input.taper[i] < 0 ? -place[i] : place[i]));
}

GAITER_MULTIVERSION
void forecast_errors(const ForecastInput<double>& input, const Pack& strain, ForecastErrors<double>& errors) {
  find_errors(input, strain, errors);
}

GAITER_MULTIVERSION
void forecast_sliding(const ForecastInput<double>& input, bool voltage, Pack& change) {
  Pack x, stretch, push, coupling, axial, difference_slope;  // w_r, w_rz, w_zz, (D/r)' r
  GAITER_EACH {
    const double swell = input.gap[i] * (2 + input.gap[i]);
    x[i] = 0.5 * log1p(larger(swell * input.middle[i], -0.999));
    stretch[i] = exp(x[i]);
    push[i] = coupling[i] = axial[i] = difference_slope[i] = 0;
  }
  for (const Input::Term& term : input.terms) GAITER_EACH {
      const double a = term.alpha[i], mu = term.mu[i], up = exp(clamped(a * x[i])), down = 1 / up;
      push[i] += mu * (up - down) / stretch[i];
      coupling[i] += mu * a * down / stretch[i];
      axial[i] += mu * ((a - 1) + (a + 1) * down);
      difference_slope[i] += mu * ((a - 2) * up + (a + 2) * (1 + a) * down) / (stretch[i] * stretch[i]);
    }
  GAITER_EACH {
    // Energy -1/2 eps V^2 z'^2 r^2/(A h): in units of h, with r = stretch A.
    const double field = input.voltage[i] / input.thickness[i];
    const double drive = voltage ? input.electric[i] * field * field : 0;
    const double slope = input.rise[i] / input.height[i], rise = input.rise[i] / input.inner_radius[i];
    const double pushed = push[i] - drive * stretch[i], coupled = coupling[i] - 2 * drive * stretch[i],
                 along = axial[i] - drive * stretch[i] * stretch[i];
    const double laid = (std::sqrt(1 + slope * slope) - 1) * coupled / pushed;
    const double slid = rise * rise * (pushed - coupled) * difference_slope[i] / (12 * along * pushed);
    const double held = input.slides[i] > 0 ? laid - slid : laid;
    // Wrinkled where the axial stiffness is gone.
    change[i] = pushed > 0 && (along > 0 || !(input.slides[i] > 0)) ? held : nan;
  }
}

}  // namespace gaiter::physics
