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
constexpr double caution_of_wall = 1.2;
constexpr double caution_of_leg = 6;
constexpr double caution_of_mean = 1.3;  // where the value at mid-height stands for the mean over the height
constexpr double vacuum_permittivity = 8.8541878128e-12;  // [F/m]

}  // namespace

SegmentForecast::SegmentForecast(const model::Scene& scene, std::size_t segment)
    : scene_(&scene), leg_(&scene.leg.segments[segment]), module_(&scene.bandage.modules[segment]) {
  mean_radius_ = leg_->mean_radius();
  taper_ = 0.5 * (leg_->upper_radius - leg_->lower_radius) / mean_radius_;
  const Wall wall = reference_wall(scene.bandage, *module_, mean_radius_, mean_radius_);
  inner_ = wall.inner_radius;
  gap_ = wall.gap;
  log_area_ = std::log1p(wall.thickness * (2 * inner_ + wall.thickness) / (inner_ * inner_));
  actuated_.wanted = module_->voltage != 0;
}

void SegmentForecast::put(ForecastInput& input, int lane) const {
  const model::Leg& leg = scene_->leg;
  const double electric = vacuum_permittivity * scene_->bandage.permittivity;
  const double voltage = module_->voltage * scene_->bandage.layers;
  const double field = voltage / scene_->bandage.thickness;
  input.gap[lane] = gap_ / inner_;
  input.leg_radius[lane] = mean_radius_ / inner_;
  input.log_area[lane] = log_area_;
  input.taper[lane] = taper_;
  input.slope[lane] = (leg_->upper_radius - leg_->lower_radius) / leg_->height;
  input.rise[lane] = (leg_->upper_radius - leg_->lower_radius) / inner_;
  input.drive[lane] = 2 * electric * (voltage / inner_) * (voltage / inner_);
  input.membrane_drive[lane] = electric * field * field;
  input.gives_way[lane] = leg.model == model::LegModel::rigid ? 0 : 1;
  input.slides[lane] = scene_->contact_axial == model::ContactAxial::free ? 1 : 0;
  const LegConstants constants = leg_constants(leg, *leg_);
  input.pressure_limit[lane] = pressure_bound(leg, constants, gap_ / mean_radius_) * constants.pressure_scale;
  if (leg.material == model::LegMaterial::neo_hookean) {
    const double bulk = constants.value[0] * constants.pressure_scale,
                 shear = constants.value[1] * constants.pressure_scale;
    const std::array<double, 4> law{bulk, shear, bulk + shear, 0};
    for (int k = 0; k < 4; ++k) input.leg[k][lane] = law[k];
  } else {
    const model::Compliance& law = leg_->compliance;
    const std::array<double, 4> values{law.a, law.b, constants.value[1], law.d};
    for (int k = 0; k < 4; ++k) input.leg[k][lane] = values[k];
  }
  for (std::size_t term = 0; term < input.terms.size(); ++term) {
    input.terms[term].mu[lane] = scene_->bandage.ogden[term].mu;
    input.terms[term].alpha[lane] = scene_->bandage.ogden[term].alpha;
  }
}

void SegmentForecast::take(const ForecastState& found, int lane, State& state) const {
  state.rigid = found.rigid[lane];
  state.first = found.first[lane];
  state.pressure = found.pressure[lane];
  state.passive = found.passive[lane];
  state.slope = found.slope[lane];
  state.gain = found.gain[lane];
  state.strain = found.strain[lane];
  state.response = found.response[lane];
  state.narrow = found.narrow[lane];
  const bool widens = taper_ >= 0;
  state.lower_end_open = !((widens ? found.narrow_net : found.wide_net)[lane] > 0);
  state.upper_end_open = !((widens ? found.wide_net : found.narrow_net)[lane] > 0);
}

void SegmentForecast::analyse(std::span<SegmentForecast> forecasts, Depth depth) {
  // Large, so that it is kept for the next batch.
  thread_local ForecastInput input;
  thread_local ForecastState rest, actuated;
  thread_local ForecastErrors errors;
  if (forecasts.empty()) return;
  input.material = forecasts[0].scene_->leg.material;
  input.terms.resize(forecasts[0].scene_->bandage.ogden.size());
  for (std::size_t first = 0; first < forecasts.size(); first += pack_width) {
    const auto some = forecasts.subspan(first, std::min<std::size_t>(pack_width, forecasts.size() - first));
    const int count = static_cast<int>(some.size());
    bool voltage = false;
    // The last pack's spare places repeat the last segment.
    for (int lane = 0; lane < pack_width; ++lane) some[std::min(lane, count - 1)].put(input, lane);
    input.close();
    for (const SegmentForecast& one : some) voltage = voltage || one.module_->voltage != 0;
    Pack at_rest, under_voltage;
    forecast_sliding(input, false, at_rest);
    if (voltage) forecast_sliding(input, true, under_voltage);
    for (int lane = 0; lane < count; ++lane) {
      some[lane].rest_.sliding = some[lane].actuated_.sliding = at_rest[lane];
      if (some[lane].module_->voltage != 0) some[lane].actuated_.sliding = under_voltage[lane];
    }
    if (depth == Depth::sliding) continue;
    forecast_state(input, false, nullptr, rest);
    if (voltage) forecast_state(input, true, &rest, actuated);
    // Where the bandage is stretched most: the leg is wider under voltage.
    Pack strain = rest.strain;
    for (int lane = 0; voltage && lane < pack_width; ++lane)
      if (actuated.pressure[lane] > 0) strain[lane] = std::min(strain[lane], actuated.strain[lane]);
    forecast_errors(input, strain, errors);
    for (int lane = 0; lane < count; ++lane) {
      SegmentForecast& one = some[lane];
      const model::Leg& leg = one.scene_->leg;
      one.strain_of_none_ =
          leg.model == model::LegModel::rigid || leg.material == model::LegMaterial::neo_hookean
              ? 0
              : input.leg[0][lane] + input.leg[2][lane];
      one.take(rest, lane, one.rest_);
      if (one.module_->voltage != 0) one.take(actuated, lane, one.actuated_);
      for (std::size_t n = 0; n < one.wall_.size(); ++n) {
        one.height_[n] = errors.height[n][lane];
        one.wall_[n] = errors.wall[n][lane];
      }
      one.find_poles(one.rest_);
      if (one.module_->voltage != 0) one.find_poles(one.actuated_);
      one.find_cuts();
    }
  }
}

void SegmentForecast::want(bool rest, bool actuated) {
  rest_.wanted = rest;
  actuated_.wanted = actuated && module_->voltage != 0;
  if (!rest && !actuated_.wanted) rest_.wanted = true;
}

// By one point through the wall and a leg without pressure: only its sign counts, where the bandage is nearly
// slack.
double SegmentForecast::net_pressure(double height, bool voltage) const {
  const double radius = mean_radius_ * (1 + taper_ * (2 * height - 1)) * (1 - strain_of_none_);
  const double excess = (gap_ + (radius - mean_radius_)) / inner_, swell = excess * (2 + excess);
  if (!voltage) return excess;
  constexpr std::array<double, 4> nodes{0.06943184420297371, 0.33000947820757187, 0.66999052179242813,
                                        0.93056815579702629};
  constexpr std::array<double, 4> weights{0.17392742256872693, 0.32607257743127307, 0.32607257743127307,
                                          0.17392742256872693};
  double pressure = 0;
  for (std::size_t j = 0; j < nodes.size(); ++j) {
    const double square = swell * std::exp(-log_area_ * nodes[j]), x = 0.5 * std::log1p(square);
    double stress = 0;
    for (const model::OgdenTerm& term : scene_->bandage.ogden)
      stress += term.mu * std::sinh(std::clamp(term.alpha * x, -300.0, 300.0));
    pressure += weights[j] * stress / (1 + square);
  }
  const double inner = 1 + swell, area = std::expm1(log_area_);  // over A^2
  const double log_wall = std::log1p(area / inner);
  const double drive = module_->voltage * scene_->bandage.layers / inner_;
  return log_area_ * pressure - 2 * vacuum_permittivity * scene_->bandage.permittivity * drive * drive *
                                    area / (inner * (inner + area) * log_wall * log_wall);
}

void SegmentForecast::find_cuts() {
  cuts_.clear();
  const bool voltage = module_->voltage != 0;
  open_everywhere_ = rest_.lower_end_open && rest_.upper_end_open &&
                     (!voltage || (actuated_.lower_end_open && actuated_.upper_end_open));
  for (const bool under_voltage : {false, true}) {
    const State& state = under_voltage ? actuated_ : rest_;
    if (under_voltage && !voltage) break;
    if (state.lower_end_open == state.upper_end_open) continue;
    double from = 0, to = 1;
    const bool low = net_pressure(0, under_voltage) > 0;
    if (low == (net_pressure(1, under_voltage) > 0)) continue;
    for (int k = 0; k < 50; ++k) {
      const double middle = 0.5 * (from + to);
      ((net_pressure(middle, under_voltage) > 0) == low ? from : to) = middle;
    }
    cuts_.push_back(0.5 * (from + to));
  }
  std::sort(cuts_.begin(), cuts_.end());
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

// An error that goes with a power of the pressure is larger at the wide end than it is small at the narrow
// one: the mean over the height over the value in the middle.
double SegmentForecast::spread(const State& s, double power) const {
  const double x = std::min(power * std::fabs(taper_ * s.slope / s.pressure), 20.0);
  return x > 1e-3 ? std::sinh(x) / x : 1.0;
}

double SegmentForecast::compliance_error() const {
  return worst([&](const State& s) {
    return s.rigid > 0 ? caution_of_mean * spread(s, 1) * std::fabs(s.rigid / s.pressure - 1) : 0.0;
  });
}

double SegmentForecast::first_order_error() const {
  return worst([&](const State& s) {
    if (!(s.rigid > 0)) return 0.0;
    // It may be small by chance in the middle.
    const double fall = std::log(s.rigid / s.pressure);
    const double typical = 0.3 * fall * fall;
    return spread(s, 3) * std::max(caution * std::fabs(s.first / s.pressure - 1), typical);
  });
}

double SegmentForecast::gain() const {
  return worst([](const State& s) { return s.gain; });
}

// The pressure has singularities over the (complex) height where the gain is -1, and Gauss's rule converges
// as the ellipse through them says. With an exponential of rate d in the leg's law these lie where the gain
// that it gives is 1 in size, pi/|d| off the real pressures; the part that they have in the pressure is
// 1/|d|.
void SegmentForecast::find_poles(State& s) const {
  const model::Leg& leg = scene_->leg;
  s.poles = {};
  if (leg.model == model::LegModel::rigid || !(s.pressure > 0)) return;
  const double half = std::max(s.pressure - s.narrow, 1e-3 * s.pressure);
  const auto pole_of = [&](double size, double rate) -> Pole {
    if (!(size != 0 && rate != 0)) return {};
    const double strength = std::fabs(s.slope * size * rate);
    const double where = -std::log(std::max(strength, 1e-300)) / rate;  // pressure at which the gain is 1
    // |z + sqrt(z^2 - 1)| by the sum of the distances of z from -1 and 1.
    const double x = (where - s.pressure) / half, y = M_PI / (rate * half);
    const double sum = 0.5 * (std::sqrt((x + 1) * (x + 1) + y * y) + std::sqrt((x - 1) * (x - 1) + y * y));
    const double ellipse = sum + std::sqrt(std::max(sum * sum - 1, 0.0));
    return {caution_of_leg / (std::fabs(rate) * s.pressure), 1 / (ellipse * ellipse)};
  };
  if (leg.material == model::LegMaterial::neo_hookean) {
    s.poles[0] = pole_of(1, 2 * s.response);
  } else {
    const model::Compliance& law = leg_->compliance;
    s.poles[0] = pole_of(law.a, law.b);
    s.poles[1] = pole_of(leg.variant == model::ComplianceVariant::anchored ? -law.a : law.c, law.d);
  }
}

double SegmentForecast::leg_error(const State& s, int n) const {
  double error = 0;
  for (const Pole& pole : s.poles) {
    double part = pole.size;
    for (int k = 0; k < n; ++k) part *= pole.fall;
    error += part;
  }
  return error;
}

double SegmentForecast::height_error(const State& s, int n) const {
  if (!(s.rigid > 0) || taper_ == 0) return 0;
  const int known = std::min(n, forecast_points);
  const double bandage = caution * (height_[known] + height_[known + 1]) / (s.pressure * (1 + s.gain));
  return bandage + leg_error(s, n);
}

double SegmentForecast::height_error(int slices) const {
  return worst([&](const State& s) { return height_error(s, slices); });
}

double SegmentForecast::wall_error(int points) const {
  if (!(wall_[0] > 0)) return 0;
  double error = 0;
  if (points <= forecast_points) {
    // A term that is small by chance is not trusted.
    const double by_neighbours = 0.2 * std::sqrt(wall_[points - 1] * wall_[points + 1]);
    error = std::max(wall_[points], by_neighbours) + wall_[points + 1];
  } else {
    error = wall_[forecast_points] *
            std::pow(wall_[forecast_points + 1] / wall_[forecast_points], points - forecast_points);
  }
  // P_a is closed form: the error is the passive pressure's.
  return worst([&](const State& s) {
    return s.rigid > 0 ? caution_of_wall * error / (s.pressure * (1 + s.gain)) : 0.0;
  });
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
