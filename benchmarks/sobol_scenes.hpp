// SPDX-License-Identifier: BSD-2-Clause
#pragma once

#include <boost/random/sobol.hpp>
#include <cmath>
#include <vector>

#include "gaiter/solvers/slice_model.hpp"
#include "paper_scene.hpp"

namespace gaiter::sobol {

// The voltage that takes all pressure from a rigid leg at the mid-height of a scene's only segment [V].
inline double lift_off_voltage(const model::Scene& scene) {
  constexpr double unit = 1000;
  model::Scene probe = scene;
  model::Segment& leg = probe.leg.segments[0];
  leg.lower_radius = leg.upper_radius = leg.mean_radius();
  probe.fidelity = model::Fidelity::rigid;
  probe.discretisation.slice_count = 1;
  probe.bandage.modules[0].voltage = unit;
  const solvers::SegmentTask task{&probe, 0};
  const auto rigid = solvers::solve_segments(PETSC_COMM_SELF, {&task, 1})[0];
  return unit * std::sqrt(rigid.pressure_rest_rigid / rigid.actuation_pressure);
}

// Scenes of one segment, 35 mm high, of the paper's mean radii: a Sobol sequence over stretch 1.05 to 2.6,
// wall 0.1 to 3 mm (evenly in its logarithm, like the next), stiffness 1e3 to 1e7 Pa (first Ogden modulus;
// the second in proportion), taper 0 to 20 degrees, voltage 0 to 80 % of lift_off_voltage, and the paper's
// six compliances.
inline std::vector<model::Scene> scenes(int count, int skip = 0) {
  boost::random::sobol engine(6);
  engine.discard(6 * static_cast<boost::uintmax_t>(skip));
  const auto place = [&] { return (static_cast<double>(engine() >> 11) + 0.5) * 0x1p-53; };
  std::vector<model::Scene> all;
  while (static_cast<int>(all.size()) < count) {
    const double stretch = 1.05 + 1.55 * place(), wall = 1e-4 * std::pow(30, place()),
                 stiffness = 1e3 * std::pow(1e4, place()), angle = 20 * place() * M_PI / 180,
                 part = 0.8 * place();
    const auto segment = static_cast<std::size_t>(6 * place());
    model::Scene scene = paper::scene(stretch, 1000);
    model::Segment leg = scene.leg.segments[segment];
    const double radius = leg.mean_radius(), rise = leg.height * std::tan(angle);
    leg.lower_radius = radius - 0.5 * rise;
    leg.upper_radius = radius + 0.5 * rise;
    scene.leg.segments = {leg};
    scene.bandage.modules.resize(1);
    scene.bandage.thickness = wall;
    scene.bandage.ogden = {{stiffness, 3.507}, {stiffness * 10.514 / 21.193e3, 12.147}};
    scene.leg.data_limit = std::numeric_limits<double>::infinity();
    scene.bandage.modules[0].voltage = part * lift_off_voltage(scene);
    all.push_back(scene);
  }
  return all;
}

}  // namespace gaiter::sobol
