// SPDX-License-Identifier: BSD-2-Clause
#include "gaiter/solvers/axisym_profile.hpp"

// Boost 1.74 names isnan without a namespace.
#include <math.h>

#include <algorithm>
#include <boost/math/interpolators/pchip.hpp>

#include "gaiter/physics/slice_kernel.hpp"
#include "gaiter/solvers/slice_solver.hpp"

namespace gaiter::solvers {

namespace {

using physics::pack_width;
using physics::PackState;
using physics::SliceShape;

constexpr int wall_points = 8;
constexpr double shortest_opening = 1.5;  // of a beam, over its thickness; shorter ones the leg closes
constexpr double longest_opening = 0.25;  // over the segment's height

using Curve = boost::math::interpolators::pchip<std::vector<double>>;  // keeps monotone data monotone

// Values at slices, which reach neither end of a segment, carried on linearly to its ends.
std::vector<double> to_ends(const std::vector<double>& at, const std::vector<double>& values, double bottom,
                            double top) {
  const std::size_t n = at.size();
  const auto beyond = [&](std::size_t end, std::size_t inside, double place) {
    return values[end] + (place - at[end]) * (values[inside] - values[end]) / (at[inside] - at[end]);
  };
  std::vector<double> extended{beyond(0, 1, bottom)};
  extended.insert(extended.end(), values.begin(), values.end());
  extended.push_back(beyond(n - 1, n - 2, top));
  return extended;
}

}  // namespace

RadialState slice_states(const model::Scene& scene, std::size_t segment,
                         std::span<const double> relative_heights, bool actuated) {
  const model::Segment& leg = scene.leg.segments[segment];
  const model::Module& module = scene.bandage.modules[segment];
  const std::size_t count = relative_heights.size();
  SliceShape shape{physics::gauss_legendre(wall_points), static_cast<int>(scene.bandage.ogden.size()),
                   scene.bandage.layers, scene.leg.material};
  physics::SliceSystem system(shape, count);
  RadialState result;
  std::vector<double> leg_radius;
  for (std::size_t i = 0; i < count; ++i) {
    const double radius = leg.lower_radius + relative_heights[i] * (leg.upper_radius - leg.lower_radius);
    const physics::Wall wall = physics::reference_wall(scene.bandage, module, leg.mean_radius(), radius);
    system.set(i, scene.leg, leg, scene.bandage, wall, radius, module.voltage);
    result.height.push_back(relative_heights[i] * leg.height);
    result.axial_stretch.push_back(1);
    leg_radius.push_back(radius);
    result.tube_radius.push_back(wall.inner_radius);
  }
  std::vector<PackState> states(system.packs());
  SliceSolver solver(PETSC_COMM_SELF, system.packs(), model::SliceSolver::newton, 0);
  system.energise(false);
  physics::Pack rigid;
  solver.solve(system, states, [&](std::size_t k) {
    physics::start_at_rest(system.shape(), system.pack(k), states[k], rigid);
  });
  if (actuated) {
    system.energise(true);
    const auto start = [&](std::size_t k) {
      physics::start_actuated(system.shape(), system.pack(k), states[k]);
    };
    solver.solve(system, states, start, SliceSolver::FirstResidual::known);
  }
  for (std::size_t i = 0; i < count; ++i) {
    const PackState& state = states[i / pack_width];
    const int place = static_cast<int>(i % pack_width);
    result.pressure.push_back(state.pressure[place] * system.constant(i, SliceShape::pressure_scale));
    result.leg_strain.push_back(state.strain[place]);
    leg_radius[i] *= 1 - state.strain[place];
    if (state.pressure[place] > 0) result.tube_radius[i] = leg_radius[i];
    result.tube_radius[i] = std::max(result.tube_radius[i], leg_radius[i]);
  }
  return result;
}

RadialState sliding_states(const model::Scene& scene, std::size_t segment, const SlidingProfile& profile,
                           std::span<const double> relative_heights, bool of_tube) {
  const model::Segment& leg = scene.leg.segments[segment];
  const double top = leg.height;
  const auto undeformed = [&](double height) {
    return leg.lower_radius + height / top * (leg.upper_radius - leg.lower_radius);
  };
  // The tube's ends stay where they are, and no slice passes them.
  std::vector<double> material{0}, height{0}, strain;
  material.insert(material.end(), profile.reference_height.begin(), profile.reference_height.end());
  height.insert(height.end(), profile.height.begin(), profile.height.end());
  material.push_back(top);
  height.push_back(top);
  for (std::size_t i = 0; i < profile.height.size(); ++i)
    strain.push_back(1 - profile.leg_radius[i] / undeformed(profile.height[i]));

  const std::vector<double>& at = of_tube ? profile.reference_height : profile.height;
  const auto curve = [&](const std::vector<double>& values) {
    return Curve(of_tube ? std::vector(material) : std::vector(height), to_ends(at, values, 0, top));
  };
  const Curve path{std::vector(material), std::vector(height)};
  const Curve tube_radius = curve(profile.tube_radius), leg_strain = curve(strain),
              pressure = curve(profile.pressure);
  RadialState result;
  for (const double relative : relative_heights) {
    const double place = std::clamp(relative, 0.0, 1.0) * top;
    result.height.push_back(of_tube ? path(place) : place);
    result.axial_stretch.push_back(of_tube ? path.prime(place) : 1);
    result.tube_radius.push_back(tube_radius(place));
    result.leg_strain.push_back(leg_strain(place));
    result.pressure.push_back(std::max(0.0, pressure(place)));
  }
  return result;
}

// The open part is a beam under the load P that was the contact pressure, turned by the slope t at its free
// end and touching without moment at the other: P L^3 / 3 = D t, D = h^3/12 sum mu alpha (1 + hoop^-alpha), h
// and hoop the deformed wall and the hoop stretch.
void open_ends(const model::Scene& scene, std::size_t segment, RadialState& state) {
  const model::Segment& leg = scene.leg.segments[segment];
  const double slope = std::fabs(leg.upper_radius - leg.lower_radius) / leg.height;
  const bool bottom = leg.upper_radius > leg.lower_radius;  // it is always the narrow end
  const double pressure = bottom ? state.pressure.front() : state.pressure.back();
  if (slope == 0 || pressure <= 0) return;
  const physics::Wall reference = physics::reference_wall(scene.bandage, scene.bandage.modules[segment],
                                                          leg.mean_radius(), leg.mean_radius());
  const double hoop =
      (bottom ? state.tube_radius.front() : state.tube_radius.back()) / reference.inner_radius;
  const double wall = scene.bandage.thickness / hoop;
  double modulus = 0;
  for (const auto& term : scene.bandage.ogden)
    modulus += term.mu * term.alpha * (1 + std::pow(hoop, -term.alpha));
  const double stiffness = modulus * wall * wall * wall / 12;
  const double open = std::min(longest_opening * leg.height, std::cbrt(3 * slope * stiffness / pressure));
  if (open < shortest_opening * wall) return;
  for (std::size_t i = 0; i < state.height.size(); ++i) {
    const double x = (bottom ? state.height[i] : leg.height - state.height[i]) / open;
    if (x >= 1) continue;
    const double deflection = 2.0 / 3 * (1 - x) - (1 - x * x) / 2 + (1 - x * x * x * x) / 12;  // over 1.5 t L
    state.tube_radius[i] += 1.5 * slope * open * deflection;
    state.pressure[i] = 0;
  }
}

}  // namespace gaiter::solvers
