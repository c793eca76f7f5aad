// SPDX-License-Identifier: BSD-2-Clause
#include "gaiter/physics/segment_forecast.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "gaiter/physics/leg_law.hpp"
#include "gaiter/physics/quadrature.hpp"
#include "gaiter/physics/slice_system.hpp"

namespace gaiter::physics {

namespace {

constexpr double caution = 2;
constexpr double caution_of_wall = 3;
constexpr double caution_of_mean = 1.3;  // where the value at mid-height stands for the mean over the height
constexpr double vacuum_permittivity = 8.8541878128e-12;  // [F/m]
constexpr int forecast_wall_points = 4;

// Gauss-Legendre, 4 points on (0, 1).
constexpr std::array<double, 4> wall_nodes{0.06943184420297371, 0.33000947820757187, 0.66999052179242813,
                                           0.93056815579702629};
constexpr std::array<double, 4> wall_weights{0.17392742256872693, 0.32607257743127307, 0.32607257743127307,
                                             0.17392742256872693};

double falling_factorial(double x, int n) {
  double product = 1;
  for (int k = 0; k < n; ++k) product *= x - k;
  return product;
}

}  // namespace

double gauss_tail(const std::array<double, 3>& last, int degree, double closeness, int points) {
  const double before = std::fabs(last[0]), middle = std::fabs(last[1]), end = std::fabs(last[2]);
  // The size of the last coefficient, which may be small by chance, as its two forerunners would have it.
  const double falling = (2.0 * degree - 3) / (2.0 * degree - 1);
  const double expected = before > 0 ? falling * middle * std::min(1.0, middle / before) : middle;
  double size = std::max(end, 0.5 * expected);
  if (!(size > 0)) return 0;
  const double ratio = middle > 0 ? std::min(size / middle, 1.0) : 1.0;
  const double rate = ratio * (2 * degree - 1);
  for (int k = degree + 1; k <= 2 * points; ++k)
    size *= std::min(1.0, (rate + (k - degree) * closeness) / (2 * k - 1));
  // The rule gives at most half for the mean of the Legendre polynomial of degree 2n, which is 0.
  return 0.5 * size;
}

SegmentForecast::SegmentForecast(const model::Scene& scene, std::size_t segment)
    : scene_(scene), leg_(scene.leg.segments[segment]), module_(scene.bandage.modules[segment]) {
  mean_radius_ = leg_.mean_radius();
  taper_ = 0.5 * (leg_.upper_radius - leg_.lower_radius) / mean_radius_;
  const Wall wall = reference_wall(scene.bandage, module_, mean_radius_, mean_radius_);
  inner_ = wall.inner_radius;
  gap_ = wall.gap;
  log_area_ = std::log1p(wall.thickness * (2 * inner_ + wall.thickness) / (inner_ * inner_));
  for (int j = 0; j < forecast_wall_points; ++j) wall_ratio_[j] = std::exp(-log_area_ * wall_nodes[j]);
  rest_.sliding = sliding_change(false);
  actuated_ = rest_;
  if (module_.voltage != 0)
    actuated_.sliding = sliding_change(true);
  else
    actuated_.wanted = false;
}

void SegmentForecast::analyse() {
  double unused;
  if (scene_.leg.model != model::LegModel::rigid) strain_law(0, strain_of_none_, unused, unused);
  find_cuts();
  forecast_state(rest_, false);
  if (module_.voltage != 0) forecast_state(actuated_, true);
  resolve_wall(mean_radius_ * (1 - rest_.strain));
}

void SegmentForecast::want(bool rest, bool actuated) {
  rest_.wanted = rest;
  actuated_.wanted = actuated && module_.voltage != 0;
  if (!rest && !actuated_.wanted) rest_.wanted = true;
}

// P_m, Eq. (4), in the sum over four points of the wall, and its slope over the logarithm of the leg's
// radius.
double SegmentForecast::passive_pressure(double leg_radius, double* slope) const {
  const double excess = (gap_ + (leg_radius - mean_radius_)) / inner_;
  const double swell = excess * (2 + excess), radius = 1 + excess;
  double pressure = 0, steep = 0;
  for (int j = 0; j < forecast_wall_points; ++j) {
    const double ratio = wall_ratio_[j];
    const double square = swell * ratio;
    const double x = 0.5 * std::log1p(square);
    double stress = 0, stress_slope = 0;
    for (const model::OgdenTerm& term : scene_.bandage.ogden) {
      const double power = std::exp(std::clamp(term.alpha * x, -300.0, 300.0));
      const double sine = std::fabs(term.alpha * x) < 1e-3 ? term.alpha * x : 0.5 * (power - 1 / power);
      stress += term.mu * sine;
      stress_slope += term.mu * (term.alpha * 0.5 * (power + 1 / power) - 2 * sine);
    }
    pressure += wall_weights[j] * stress / (1 + square);
    steep += wall_weights[j] * stress_slope / ((1 + square) * (1 + square)) * ratio;
  }
  if (slope) *slope = log_area_ * steep * radius * (leg_radius / inner_);
  return log_area_ * pressure;
}

// P_a, Eq. (8), layers as if the field were the same in all.
double SegmentForecast::relief(double leg_radius) const {
  if (module_.voltage == 0) return 0;
  const double radius = inner_ + gap_ + (leg_radius - mean_radius_);
  const double area = std::expm1(log_area_) * inner_ * inner_;  // B^2 - A^2
  const double q = area / (radius * radius), log_wall = std::log1p(q);
  const double voltage = module_.voltage * scene_.bandage.layers;
  return 2 * vacuum_permittivity * scene_.bandage.permittivity * voltage * voltage * q /
         ((radius * radius + area) * log_wall * log_wall);
}

// The leg's radial strain, its derivative, and how fast that one changes.
void SegmentForecast::strain_law(double pressure, double& strain, double& response, double& bending) const {
  const model::Leg& leg = scene_.leg;
  if (leg.material == model::LegMaterial::neo_hookean) {
    const double shear = leg.young_modulus / (2 * (1 + leg.poisson_ratio));
    const double bulk = leg.young_modulus / (3 * (1 - 2 * leg.poisson_ratio));
    const double stiffness = bulk + shear / 3;
    double y = 1;  // (r/R_c)^2
    for (int k = 0; k < 4; ++k) y = 1 - pressure / (bulk + shear / 3 * std::pow(std::max(y, 0.05), -5.0 / 3));
    y = std::max(y, 0.05);
    strain = 1 - std::sqrt(y);
    response = 0.5 / (stiffness * std::sqrt(y));
    bending = 1 / stiffness;
    return;
  }
  const model::Compliance& law = leg_.compliance;
  const double c = leg.variant == model::ComplianceVariant::anchored ? -law.a : law.c;
  const double grown = law.a * std::exp(std::min(law.b * pressure, 100.0)),
               decayed = c * std::exp(law.d * pressure);
  strain = grown + decayed;
  response = law.b * grown + law.d * decayed;
  bending = std::fabs(law.b * law.b * grown + law.d * law.d * decayed) / std::max(response, 1e-300);
}

// How the stress varies through the wall, and as what powers of the radius the pressure goes over the height.
void SegmentForecast::resolve_wall(double leg_radius) {
  const double excess = (gap_ + (leg_radius - mean_radius_)) / inner_, swell = excess * (2 + excess);
  const auto stress = [&](double t) {  // t: A^2/s
    const double square = swell * t, x = 0.5 * std::log1p(square);
    double sum = 0;
    for (const model::OgdenTerm& term : scene_.bandage.ogden)
      sum += term.mu * std::sinh(std::clamp(term.alpha * x, -300.0, 300.0));
    return sum / (1 + square);
  };
  wall_ = {};
  for (int j = 0; j < forecast_wall_points; ++j) {
    const double x = 2 * wall_nodes[j] - 1, share = wall_weights[j] * stress(wall_ratio_[j]);
    double before = 0, legendre = 1;
    for (int degree = 0; degree < 4; ++degree) {
      wall_[degree] += (2 * degree + 1) * share * legendre;
      const double next = ((2 * degree + 1) * x * legendre - degree * before) / (degree + 1);
      before = legendre;
      legendre = next;
    }
  }
  const double middle = swell * std::exp(-0.5 * log_area_), x = 0.5 * std::log1p(middle);
  const double radius = 1 + excess;
  // d ln lambda / d ln R at mid-wall.
  const double share = radius * std::exp(-0.5 * log_area_) / (1 + middle) * leg_radius / inner_;
  powers_.clear();
  for (const model::OgdenTerm& term : scene_.bandage.ogden) {
    const double size = 0.5 * term.mu * log_area_;
    const double up = term.alpha - 2, down = -term.alpha - 2;
    powers_.push_back({size * std::exp(std::clamp(up * x, -300.0, 300.0)), share * up});
    powers_.push_back({-size * std::exp(std::clamp(down * x, -300.0, 300.0)), share * down});
  }
}

// The equilibrium of the slice at mid-height, from the start that slices have (start_at_rest), whose distance
// from it is what the first order leaves out.
void SegmentForecast::forecast_state(State& state, bool voltage) {
  double steep = 0;
  const auto bandage = [&](double strain) {
    const double radius = mean_radius_ * (1 - strain);
    const double pressure = passive_pressure(radius, &steep);
    state.passive = pressure;
    if (!voltage) return pressure;
    const double relieved = relief(radius);
    steep -= (relief(radius * 1.0001) - relieved) / 1e-4;
    return pressure - relieved;
  };
  state.rigid = state.first = state.pressure = bandage(0);
  state.slope = steep;
  state.gain = state.bending = state.strain = state.response = 0;
  if (!(state.rigid > 0) || scene_.leg.model == model::LegModel::rigid) return;
  const double slack = gap_ / mean_radius_;  // strain at which the bandage is slack, and beyond
  const double limit = pressure_bound(scene_.leg, leg_constants(scene_.leg, leg_), slack) *
                       leg_constants(scene_.leg, leg_).pressure_scale;
  double pressure = std::min(state.rigid, limit), strain = 0, response = 0, bending = 0;
  const double k = state.slope / state.rigid;
  strain_law(pressure, strain, response, bending);
  if (state.rigid <= limit) {
    const double step = -pressure * k * strain / (1 + pressure * k * response);
    const double moved = pressure + step > 0 ? pressure + step : 0.5 * pressure;
    if (moved < limit) pressure = moved;
  }
  state.first = pressure;
  double low = 0, high = limit;
  for (int iteration = 0; iteration < 40; ++iteration) {
    strain_law(pressure, strain, response, bending);
    const double pressing = bandage(strain), residual = pressure - pressing;
    (residual < 0 ? low : high) = pressure;
    // Newton's step for ln P = ln P_t where the two are far apart, else for P = P_t.
    const double yielding = steep * response / std::max(1 - strain, 0.05);
    double next =
        pressing > 4 * pressure || (pressing > 0 && pressure > 4 * pressing)
            ? pressure * std::exp(std::log(pressing / pressure) / (1 + yielding * pressure / pressing))
            : pressure - residual / (1 + yielding);
    if (!(next > low && next < high)) next = low > 0 ? std::sqrt(low * high) : 0.5 * (low + high);
    const double change = std::fabs(next - pressure);
    pressure = next;
    if (change < std::max(1e-9 * pressure, 0.02 * std::fabs(pressure - state.first))) break;
  }
  strain_law(pressure, state.strain, state.response, state.bending);
  state.pressure = pressure;
  state.slope = (bandage(state.strain), steep);
  state.gain = std::max(0.0, state.slope * state.response / std::max(1 - state.strain, 0.05));
}

void SegmentForecast::find_cuts() {
  const auto net = [&](double height, bool voltage) {
    const double radius = mean_radius_ * (1 + taper_ * (2 * height - 1)) * (1 - strain_of_none_);
    return passive_pressure(radius) - (voltage ? relief(radius) : 0);
  };
  bool open = true;
  for (bool voltage : {false, true}) {
    if (voltage && module_.voltage == 0) break;
    const double low = net(0, voltage), high = net(1, voltage);
    if (low > 0 || high > 0) open = false;
    if ((low > 0) == (high > 0)) continue;
    double from = 0, to = 1;
    for (int k = 0; k < 50; ++k) {
      const double middle = 0.5 * (from + to);
      ((net(middle, voltage) > 0) == (low > 0) ? from : to) = middle;
    }
    cuts_.push_back(0.5 * (from + to));
  }
  open_everywhere_ = open;
  std::sort(cuts_.begin(), cuts_.end());
}

// Thin wall, leg that does not give way. With w(r, z') the tube's energy per reference height, balance along
// the leg of slope m asks for (w_z')' = w_r m; where nothing has slid, it is missed by f = -m D, D = w_r -
// w_rz. The slip that makes up for it, u'' = -f/w_zz with u = 0 at both ends, changes the mean of P = w_r/r
// by
//   - m^2 H^2 D (D/r)' / (12 w_zz).
// The slope itself stretches the tube by sqrt(1 + m^2) along the meridian: w_rz (sqrt(1 + m^2) - 1) / r.
double SegmentForecast::sliding_change(bool actuated) const {
  const double excess = gap_ / inner_, swell = excess * (2 + excess);
  const double x = 0.5 * std::log1p(swell * std::exp(-0.5 * log_area_)), stretch = std::exp(x);
  double push = 0, coupling = 0, axial = 0, difference_slope = 0;  // w_r, w_rz, w_zz, (D/r)' r
  for (const model::OgdenTerm& term : scene_.bandage.ogden) {
    const double a = term.alpha, up = std::exp(std::clamp(a * x, -300.0, 300.0)), down = 1 / up;
    push += term.mu * (up - down) / stretch;
    coupling += term.mu * a * down / stretch;
    axial += term.mu * ((a - 1) + (a + 1) * down);
    difference_slope += term.mu * ((a - 2) * up + (a + 2) * (1 + a) * down) / (stretch * stretch);
  }
  if (actuated) {
    // Energy -1/2 eps V^2 z'^2 r^2/(A h): in units of h, with r = stretch A.
    const double voltage = module_.voltage * scene_.bandage.layers / scene_.bandage.thickness;
    const double drive = vacuum_permittivity * scene_.bandage.permittivity * voltage * voltage;
    push -= drive * stretch;
    coupling -= 2 * drive * stretch;
    axial -= drive * stretch * stretch;
  }
  if (!(push > 0)) return std::numeric_limits<double>::quiet_NaN();
  const double slope = (leg_.upper_radius - leg_.lower_radius) / leg_.height;
  const double rise = leg_.upper_radius - leg_.lower_radius;
  double change = (std::hypot(1.0, slope) - 1) * coupling / push;
  if (scene_.contact_axial == model::ContactAxial::free) {
    if (!(axial > 0)) return std::numeric_limits<double>::quiet_NaN();  // wrinkles
    change -= rise * rise * (push - coupling) * difference_slope / (12 * axial * push * inner_ * inner_);
  }
  return change;
}

template <typename Measure>
double SegmentForecast::worst(Measure&& measure) const {
  double error = 0;
  for (const State* state : {&rest_, &actuated_})
    if (state->wanted) {
      const double one = measure(*state);
      if (!(one <= error)) error = one;  // NaN, not known, is the worst
    }
  return error;
}

double SegmentForecast::compliance_error() const {
  return worst([](const State& s) {
    return s.rigid > 0 ? caution_of_mean * std::fabs(s.rigid / s.pressure - 1) : 0.0;
  });
}

double SegmentForecast::first_order_error() const {
  return worst([&](const State& s) {
    if (!(s.rigid > 0)) return 0.0;
    // It goes with a high power of the pressure, so that the wide end outweighs the middle.
    const double spread = std::min(3 * std::fabs(taper_ * s.slope / s.pressure), 20.0);
    return caution * std::fabs(s.first / s.pressure - 1) * (spread > 1e-3 ? std::sinh(spread) / spread : 1.0);
  });
}

double SegmentForecast::gain() const {
  return worst([](const State& s) { return s.gain; });
}

double SegmentForecast::height_error(const State& s, int n) const {
  if (!(s.rigid > 0) || taper_ == 0) return 0;
  const double constant = gauss_error_constant(n), span = 2 * std::fabs(taper_);
  const auto bandage = [&](int points) {
    double derivative = 0;
    for (const Power& power : powers_)
      derivative += power.size * falling_factorial(power.exponent, 2 * points);
    return gauss_error_constant(points) * std::fabs(derivative) * std::pow(span, 2 * points);
  };
  const double softened = 1 / (1 + s.gain);
  const double rise = s.slope * softened * span;  // of the pressure over the height
  const double leg =
      constant * s.gain * softened * std::fabs(rise) * std::pow(s.bending * std::fabs(rise), 2 * n - 1);
  return caution * ((bandage(n) + bandage(n + 1)) * softened + leg) / s.pressure;
}

double SegmentForecast::height_error(int slices) const {
  return worst([&](const State& s) { return height_error(s, slices); });
}

double SegmentForecast::wall_error(int points) const {
  if (!(wall_[0] > 0)) return 0;
  const double pole = 2 * M_PI / log_area_, closeness = 1 / pole;
  const double passive = caution_of_wall *
                         (points == 1 ? 0.5 * std::fabs(wall_[2])
                                      : gauss_tail({wall_[1], wall_[2], wall_[3]}, 3, closeness, points)) /
                         wall_[0];
  // P_a is closed form: the error is the passive pressure's.
  return worst(
      [&](const State& s) { return s.rigid > 0 ? passive * s.passive / s.pressure / (1 + s.gain) : 0.0; });
}

double SegmentForecast::sliding_error() const {
  return worst([](const State& s) { return std::fabs(s.sliding); });
}

double SegmentForecast::drop_factor() const {
  const double drop = rest_.pressure - std::max(0.0, actuated_.pressure);
  return drop > 0 ? rest_.pressure / drop : 1;
}

double SegmentForecast::volume_factor() const {
  return worst([](const State& s) {
    return s.strain != 0 ? std::max(1.0, std::fabs(s.pressure * s.response / s.strain)) : 1.0;
  });
}

}  // namespace gaiter::physics
