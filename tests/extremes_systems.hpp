// SPDX-License-Identifier: BSD-2-Clause
#pragma once

#include <fmt/core.h>

#include <array>
#include <cstring>

#include "extremes_table.hpp"
#include "gaiter/studies/scene_options.hpp"

// Two more extremes, of whole systems: the same scene in units of very different size, and very many slices
// of very different scale in one system.
namespace gaiter::extremes {

// The digits of a quantity and what may follow them for the same value; the first is plain SI.
struct Spelling {
  std::string option, digits;
  std::array<std::string, 4> units;
};

inline std::map<std::string, std::string> spelt(std::size_t way) {
  const std::array<std::string, 4> length{"e-3", " mm", "e3 um", "e-6 km"};
  const std::vector<Spelling> all = {
      {"leg_ankle_height", "35", length},
      {"bandage_thickness", "1.1", length},
      {"bandage_ogden_mu", "21.193", {"e3", " kPa", "e-3 MPa", "e6 mPa"}},
      {"voltage", "9.3", {"e3", " kV", "e-3 MV", "e6 mV"}},
      {"leg_compliance_data_limit", "7", {"e3", " kPa", "e-3 N mm-2", "e9 uPa"}}};
  const std::array<std::string, 4> rate{"e-5", "e-2 kPa-1", "e1 MPa-1", "e-8 mPa-1"},
      decay{"e-3", " kPa-1", "e3 MPa-1", "e-6 mPa-1"};
  std::map<std::string, std::string> given = {{"leg_segments", "ankle"},
                                              {"bandage_stretch", "1.7"},
                                              {"bandage_ogden_alpha", "3.507"},
                                              {"bandage_permittivity", "7.41"},
                                              {"slice_count", "1"}};
  for (const Spelling& one : all) given[one.option] = one.digits + one.units[way];
  given["leg_ankle_radius"] = "39.6" + length[way] + ",39.6" + length[way];
  given["leg_ankle_compliance"] = "0.013392,7.898" + rate[way] + ",-0.016,-1.137" + decay[way];
  return given;
}

struct UnitsFinding {
  double ulps = 0;           // the most by which a value of the scene differs
  double amplification = 0;  // of a result's change, by its condition number
};

inline UnitsFinding compare_units() {
  const auto scene_of = [](std::size_t way) {
    return studies::parse_request(studies::Command::solve, spelt(way)).scene;
  };
  const auto values = [](const Scene& s) {
    const auto& leg = s.leg.segments[0];
    return std::array{
        leg.height,       leg.lower_radius,    leg.compliance.b,      leg.compliance.d,
        s.leg.data_limit, s.bandage.thickness, s.bandage.ogden[0].mu, s.bandage.modules[0].voltage};
  };
  const Scene plain = scene_of(0);
  const auto exact =
      reference::conditioned(plain, reference::expectation(reference::slice_of(plain, 0, 0.5), true, 300));
  const auto base = tasks::solve_one(plain);
  UnitsFinding found;
  for (std::size_t way = 1; way < 4; ++way) {
    const Scene other = scene_of(way);
    for (std::size_t i = 0; i < values(plain).size(); ++i) {
      const double a = values(plain)[i], b = values(other)[i];
      const double ulp = std::fabs(std::nextafter(a, 2 * a) - a);
      found.ulps = std::max(found.ulps, std::fabs(a - b) / ulp);
    }
    const auto result = tasks::solve_one(other);
    const std::pair<reference::Output, double> changes[] = {
        {reference::pressure_rest, result.pressure_rest / base.pressure_rest - 1},
        {reference::pressure_actuated, result.pressure_actuated / base.pressure_actuated - 1},
        {reference::drop, result.actuation_drop / base.actuation_drop - 1},
        {reference::volume_change, result.volume_change / base.volume_change - 1},
        {reference::field, result.electric_field_max / base.electric_field_max - 1}};
    for (const auto& [output, change] : changes)
      found.amplification = std::max(
          found.amplification, std::fabs(change) / (2.2e-16 * static_cast<double>(exact.condition[output])));
  }
  return found;
}

struct SystemFinding {
  double error = 0;  // of the sampled pressures, against 50 digits
  int sampled = 0;
  std::size_t other_bits = 0;  // slices whose pressure alone has other bits than among the others
  double unsolved = 0;
};

// Stiffnesses over ten and walls over four decades.
inline Scene one_of_many(std::size_t i) {
  Sampler draw(static_cast<unsigned>(i));
  Scene scene = paper_case(draw, 1 + draw.logarithmic(1e-3, 3), 0).scene;
  scene.bandage.thickness = draw.logarithmic(1e-7, 1e-3);
  scene.bandage.ogden = {{draw.logarithmic(1, 1e10), 3.5}};
  return scene;
}

// The slices [first, first + count) of these in one system at rest; `sampled` of them against the reference
// and against themselves alone.
inline SystemFinding solve_many(std::size_t first, std::size_t count, int sampled) {
  const auto scene_of = [&](std::size_t i) { return one_of_many(first + i); };
  physics::SliceShape shape;
  shape.wall = physics::gauss_legendre(6);
  const auto put = [&](physics::SliceSystem& system, std::size_t place, const Scene& scene) {
    const model::Segment& segment = scene.leg.segments[0];
    const model::Module& module = scene.bandage.modules[0];
    system.set(place, scene.leg, segment, scene.bandage,
               physics::reference_wall(scene.bandage, module, segment.mean_radius(), segment.lower_radius),
               segment.lower_radius, 0);
  };
  const auto solve = [](const physics::SliceSystem& system, SystemFinding& found) {
    std::vector<physics::PackState> states(system.packs());
    solvers::SliceSolver solver(PETSC_COMM_SELF, system.packs(), model::SliceSolver::newton, 0);
    physics::Pack rigid;
    found.unsolved += solver
                          .solve(system, states,
                                 [&](std::size_t k) {
                                   physics::start_at_rest(system.shape(), system.pack(k), states[k], rigid);
                                 })
                          .unsolved;
    return states;
  };
  SystemFinding found;
  physics::SliceSystem system(shape, count);
  for (std::size_t i = 0; i < count; ++i) put(system, i, scene_of(i));
  const auto states = solve(system, found);
  Sampler pick(7);
  for (int s = 0; s < sampled; ++s) {
    const std::size_t i = s == 0 ? count - 1 : static_cast<std::size_t>(pick.uniform(0, 0.999) * count);
    const Scene scene = scene_of(i);
    const double got = states[i / physics::pack_width].pressure[i % physics::pack_width];
    physics::SliceSystem alone(shape, 1);
    put(alone, 0, scene);
    const double same = solve(alone, found)[0].pressure[0];
    found.other_bits += std::memcmp(&got, &same, sizeof got) != 0;
    const auto expected = reference::expectation(reference::slice_of(scene, 0, 0.5), true, 300);
    const double pressure = got * system.constant(i, physics::SliceShape::pressure_scale);
    if (expected.rest > 0)
      found.error = std::max(found.error, static_cast<double>(fabs(pressure / expected.rest - 1)));
    else if (pressure > 0)
      found.error = std::numeric_limits<double>::infinity();
    ++found.sampled;
  }
  return found;
}

}  // namespace gaiter::extremes
