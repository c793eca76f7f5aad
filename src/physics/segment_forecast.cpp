// SPDX-License-Identifier: BSD-2-Clause
#include "gaiter/physics/segment_forecast.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "gaiter/physics/forecast_laws.hpp"

namespace gaiter::physics {

namespace {

using forecast::caution;
using forecast::caution_of_mean;
using forecast::caution_of_wall;

}  // namespace

SegmentForecast::SegmentForecast(const model::Scene& scene, std::size_t segment)
    : scene_(&scene), segment_(segment), energised_(scene.bandage.modules[segment].voltage != 0) {
  actuated_.wanted = energised_;
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
  for (int k = 0; k < 2; ++k) state.poles[k] = {found.poles.part[k][lane], found.poles.fall[k][lane]};
  const bool widens = taper_ >= 0;
  state.lower_end_open = !((widens ? found.narrow_net : found.wide_net)[lane] > 0);
  state.upper_end_open = !((widens ? found.wide_net : found.narrow_net)[lane] > 0);
}

void SegmentForecast::analyse(std::span<SegmentForecast> forecasts, Depth depth) {
  // Large, so that it is kept for the next batch.
  thread_local ForecastInput<double> input;
  thread_local ForecastState rest, actuated;
  thread_local ForecastErrors<double> errors;
  if (forecasts.empty()) return;
  for (std::size_t first = 0; first < forecasts.size(); first += pack_width) {
    const auto some = forecasts.subspan(first, std::min<std::size_t>(pack_width, forecasts.size() - first));
    const int count = static_cast<int>(some.size());
    input.start(*some[0].scene_);
    for (int lane = 0; lane < count; ++lane) input.set(lane, *some[lane].scene_, some[lane].segment_);
    input.close(count);
    const bool voltage = input.energised;
    Pack at_rest, under_voltage;
    forecast_sliding(input, false, at_rest);
    if (voltage) forecast_sliding(input, true, under_voltage);
    for (int lane = 0; lane < count; ++lane) {
      some[lane].rest_.sliding = some[lane].actuated_.sliding = at_rest[lane];
      if (some[lane].energised_) some[lane].actuated_.sliding = under_voltage[lane];
    }
    if (depth == Depth::sliding) continue;
    forecast_state(input, false, nullptr, rest);
    if (voltage) forecast_state(input, true, &rest, actuated);
    // Where the bandage is stretched most: the leg is wider under voltage.
    Pack strain = rest.strain;
    for (int lane = 0; voltage && lane < pack_width; ++lane)
      if (actuated.pressure[lane] > 0) strain[lane] = std::min(strain[lane], actuated.strain[lane]);
    forecast_errors(input, strain, errors);
    Pack partly{}, cut{};
    double cut_somewhere = 0;
    for (int lane = 0; voltage && lane < count; ++lane) {
      partly[lane] = (actuated.narrow_net[lane] > 0) != (actuated.wide_net[lane] > 0) ? 1 : 0;
      cut_somewhere += partly[lane];
    }
    if (cut_somewhere > 0) forecast_cut(input, actuated, partly, cut);
    for (int lane = 0; lane < count; ++lane) {
      SegmentForecast& one = some[lane];
      one.taper_ = input.taper[lane];
      one.take(rest, lane, one.rest_);
      if (one.energised_) one.take(actuated, lane, one.actuated_);
      for (std::size_t n = 0; n < one.wall_.size(); ++n) {
        one.height_[n] = errors.height[n][lane];
        one.wall_[n] = errors.wall[n][lane];
      }
      one.find_cuts(input, lane, cut[lane]);
    }
  }
}

void SegmentForecast::want(bool rest, bool actuated) {
  rest_.wanted = rest;
  actuated_.wanted = actuated && energised_;
  if (!rest && !actuated_.wanted) rest_.wanted = true;
}

// Heights at which the pressure on a leg without pressure, which decides there, changes its sign.
void SegmentForecast::find_cuts(const ForecastInput<double>& input, int lane, double actuated_cut) {
  cuts_.clear();
  open_everywhere_ = rest_.lower_end_open && rest_.upper_end_open &&
                     (!energised_ || (actuated_.lower_end_open && actuated_.upper_end_open));
  const bool cut_at_rest = rest_.lower_end_open != rest_.upper_end_open;
  const bool cut_actuated = energised_ && actuated_.lower_end_open != actuated_.upper_end_open;
  if (!cut_at_rest && !cut_actuated) return;
  const bool law = input.material == model::LegMaterial::compliance && input.gives_way[lane] > 0;
  const double left = law ? 1 - input.leg[0][lane] - input.leg[2][lane] : 1.0;  // of the leg's radius
  const double gap = input.gap[lane], leg = input.leg_radius[lane];
  const auto excess = [&](double height) { return gap - leg + leg * (1 + taper_ * (2 * height - 1)) * left; };
  if (cut_at_rest && (excess(0) > 0) != (excess(1) > 0)) cuts_.push_back(excess(0) / (excess(0) - excess(1)));
  if (cut_actuated) cuts_.push_back(actuated_cut);
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
    const double raised = std::fabs(taper_ * s.slope / s.pressure);
    const double of_middle = std::fabs(s.rigid / s.pressure - 1);
    return s.rigid > 0 ? caution_of_mean(raised) * spread(s, 1) * of_middle : 0.0;
  });
}

double SegmentForecast::first_order_error() const {
  return worst([&](const State& s) {
    if (!(s.rigid > 0)) return 0.0;
    // It may be small by chance in the middle, and is not at the ends.
    const double fall = std::log(s.rigid / s.pressure);
    const double at_ends = taper_ * s.response * s.slope * s.slope / (s.pressure * (1 + s.gain));
    const double typical = 0.3 * fall * fall + 0.1 * at_ends * at_ends;
    return spread(s, 3) * std::max(caution * std::fabs(s.first / s.pressure - 1), typical);
  });
}

double SegmentForecast::gain() const {
  return worst([](const State& s) { return s.gain; });
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

LoadedLeg SegmentForecast::loaded() const {
  const State& s = energised_ ? actuated_ : rest_;
  return {s.pressure, s.strain, s.response, s.slope / (1 + s.gain)};
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
