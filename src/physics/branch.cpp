// SPDX-License-Identifier: BSD-2-Clause
#include "gaiter/physics/branch.hpp"

#include <cmath>

#include "gaiter/physics/slice_kernel.hpp"

namespace gaiter::physics {

namespace {

constexpr int deepest = 9;  // 63^-9 of a path: nothing finer can be told apart
constexpr double rounding = 2.2e-16;
constexpr double largest_rise = 4;  // of a hump between two points over that of a tangent, with caution

// Of a bandage that floats free, in the logarithm of its radius: a first step along its path, twice as large
// each time.
constexpr double first_stride = 0.03;
constexpr int strides = 6, most_newton_steps = 40;

bool any(const Pack& flags) {
  int found = 0;
  for (int i = 0; i < pack_width; ++i) found |= flags[i] > 0;
  return found != 0;
}

void spread(double from, double to, Pack& points) {
  for (int i = 0; i < pack_width; ++i) points[i] = from + (to - from) * i / (pack_width - 1);
  points[pack_width - 1] = to;
}

// First interval, on the way from `from` to `to`, in which balance(points, value, slope) becomes >= 0; empty
// where it is so at `from` already.
template <typename Balance>
std::optional<Interval> first_crossing(const Balance& balance, double from, double to, int depth = 0) {
  Pack points, value, slope;
  spread(from, to, points);
  balance(points, value, slope);
  if (depth == 0 && value[0] >= 0) return Interval{from, from};
  const double direction = to > from ? 1 : -1;
  for (int i = 1; i < pack_width; ++i) {
    const bool crosses = value[i] >= 0;
    const bool approaches = direction * slope[i - 1] > 0 && direction * slope[i] < 0;
    if (!crosses && !approaches) continue;
    // What is still far from 0 does not get there between two close points; rounding alone makes such humps,
    // and there is no end to them.
    const double rise =
        std::fmax(std::fabs(slope[i - 1]), std::fabs(slope[i])) * std::fabs(points[i] - points[i - 1]);
    if (!crosses && depth > 0 && std::fmax(value[i - 1], value[i]) + largest_rise * rise < 0) continue;
    if (depth < (crosses ? 1 : deepest))
      if (auto inner = first_crossing(balance, points[i - 1], points[i], depth + 1)) return inner;
    if (crosses) return Interval{points[i - 1], points[i]};
  }
  return std::nullopt;
}

// Points of an interval close to where Newton's method from its end sees the crossing, and both ends.
void crowd(double from, double to, double value, double slope, Pack& points) {
  const double width = to - from, ahead = -value / (slope * width);
  const double aim = from + width * (ahead > 0 && ahead < 1 ? ahead : 0.5);
  const double part = std::fmin(0.02, 10 * std::fabs(width));
  spread(std::fmax(from, aim - part * width), std::fmin(to, aim + part * width), points);
  points[0] = from;
  points[pack_width - 1] = to;
}

// The crossing inside an ascending interval, to rounding.
template <typename Balance>
double section(const Balance& balance, Interval interval) {
  Pack points, value, slope;
  spread(interval.from, interval.to, points);
  for (int depth = 0; depth < deepest; ++depth) {
    balance(points, value, slope);
    int i = 1;
    while (i < pack_width - 1 && value[i] < 0) ++i;
    interval = {points[i - 1], points[i]};
    const double smallest = rounding * std::fabs(interval.to);
    if (!(interval.to - interval.from > smallest)) break;
    // The other end may stay where it is.
    if (slope[i - 1] > 0 && -value[i - 1] <= smallest * slope[i - 1]) return interval.from;
    crowd(interval.from, interval.to, value[i - 1], slope[i - 1], points);
  }
  return interval.to;
}

// Strains of legs whose radii have grown by the factor exp(expansion) from `start` on.
GAITER_MULTIVERSION
void expand(const Pack& start, const Pack& expansion, Pack& strain) {
  for (int i = 0; i < pack_width; ++i) strain[i] = start[i] - (1 - start[i]) * expm1(expansion[i]);
}

}  // namespace

std::optional<Interval> contact_interval(const SliceSystem& system, std::size_t slice, double highest,
                                         bool ascending) {
  const SliceSystem copies = system.replicate(slice);
  // P = highest q^3 gives small pressures their share of the points. Going down, the leg has too much
  // pressure.
  const double sign = ascending ? 1 : -1;
  const auto balance = [&](const Pack& q, Pack& value, Pack& slope) {
    Pack pressure, strain, strain_slope, bandage, bandage_slope;
    for (int i = 0; i < pack_width; ++i) pressure[i] = highest * q[i] * q[i] * q[i];
    leg_strain(copies.shape(), copies.pack(0), pressure, strain, strain_slope);
    bandage_pressure(copies.shape(), copies.pack(0), strain, bandage, bandage_slope);
    for (int i = 0; i < pack_width; ++i) {
      value[i] = sign * (pressure[i] - bandage[i]);
      slope[i] = sign * (1 - bandage_slope[i] * strain_slope[i]) * 3 * highest * q[i] * q[i];
    }
  };
  const auto found = first_crossing(balance, ascending ? 0 : 1, ascending ? 1 : 0);
  if (!found || (ascending && found->to == 0)) return std::nullopt;
  return Interval{highest * std::pow(found->from, 3), highest * std::pow(found->to, 3)};
}

void floating_strains(const SliceShape& shape, const Pack* rows, const Pack& start, Pack& strain,
                      Pack& found) {
  Pack low{}, high{}, place{}, value, slope, open;  // logarithms of the radius over where it starts
  for (int i = 0; i < pack_width; ++i) open[i] = 1;
  found = {};
  const auto balance = [&] {
    expand(start, place, strain);
    bandage_pressure(shape, rows, strain, value, slope);
    for (int i = 0; i < pack_width; ++i) slope[i] *= strain[i] - 1;
  };
  double stride = first_stride;
  for (int step = 0; step < strides && any(open); ++step, stride *= 2) {
    balance();
    for (int i = 0; i < pack_width; ++i) {
      const bool rises = open[i] > 0 && slope[i] > 0, crossed = rises && value[i] >= 0;
      found[i] = crossed ? 1 : found[i];
      high[i] = crossed ? place[i] : high[i];
      open[i] = rises && value[i] < 0 ? 1 : 0;
      low[i] = open[i] > 0 ? place[i] : low[i];
      place[i] += open[i] * stride;
    }
  }
  // Newton's method inside the bracket.
  place = high;
  open = found;
  for (int step = 0; step < most_newton_steps && any(open); ++step) {
    balance();
    for (int i = 0; i < pack_width; ++i) {
      const bool waits = open[i] > 0, above = value[i] >= 0;
      low[i] = waits && !above ? place[i] : low[i];
      high[i] = waits && above ? place[i] : high[i];
      const double newton = place[i] - value[i] / slope[i];
      const double next = newton > low[i] && newton < high[i] ? newton : 0.5 * (low[i] + high[i]);
      open[i] = waits && std::fabs(next - place[i]) > rounding ? 1 : 0;
      place[i] = waits ? next : place[i];
    }
  }
  for (int i = 0; i < pack_width; ++i) found[i] *= 1 - open[i];
  expand(start, place, strain);
}

std::optional<double> floating_strain(const SliceSystem& system, std::size_t slice, double start) {
  constexpr double largest_expansion = 9;  // logarithm of the radius over where it starts
  const SliceSystem copies = system.replicate(slice);
  Pack starts;
  for (int i = 0; i < pack_width; ++i) starts[i] = start;
  const auto balance = [&](const Pack& expansion, Pack& value, Pack& slope) {
    Pack strain;
    expand(starts, expansion, strain);
    bandage_pressure(copies.shape(), copies.pack(0), strain, value, slope);
    for (int i = 0; i < pack_width; ++i) slope[i] *= strain[i] - 1;
  };
  const auto found = first_crossing(balance, 0, largest_expansion);
  if (!found) return std::nullopt;
  return start - (1 - start) * std::expm1(section(balance, *found));
}

}  // namespace gaiter::physics
