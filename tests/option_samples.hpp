// SPDX-License-Identifier: BSD-2-Clause
#pragma once

#include <fmt/format.h>

#include <map>
#include <sstream>
#include <string>

#include "gaiter/base/error.hpp"
#include "gaiter/studies/scene_options.hpp"

namespace gaiter::tests {

using Given = std::map<std::string, std::string>;

// Two segments, mean radii 40 and 50 mm, stretch 2: what a scene cannot do without and nothing else.
inline Given two_segments() {
  return {{"leg_segments", "low,high"},
          {"leg_low_height", "35 mm"},
          {"leg_low_radius", "35 mm, 45 mm"},
          {"leg_low_compliance", "0.013,8e-5,-0.016,-1e-3"},
          {"leg_high_height", "35 mm"},
          {"leg_high_radius", "45 mm, 55 mm"},
          {"leg_high_compliance", "0.010,5e-5,-0.014,-1e-3"},
          {"bandage_stretch", "2"},
          {"bandage_ogden_mu", "20 kPa, 10 Pa"},
          {"bandage_ogden_alpha", "3.5, 12"}};
}

inline Given two_segments_with(const Given& more) {
  Given all = more;
  all.merge(two_segments());
  return all;
}

// Every value of a scene in one text, to compare scenes exactly.
inline std::string describe(const model::Scene& scene) {
  const auto& [leg, bandage, fidelity, contact_axial, how, axisym, goal] = scene;
  std::string text;
  for (const model::Segment& s : leg.segments) {
    text += fmt::format("{} {} {} {} {} {} {} {}\n", s.name, s.height, s.lower_radius, s.upper_radius,
                        s.compliance.a, s.compliance.b, s.compliance.c, s.compliance.d);
  }
  text += fmt::format("{} {} {} {} {} {}\n", int(leg.model), int(leg.material), int(leg.variant),
                      leg.data_limit, leg.young_modulus, leg.poisson_ratio);
  for (const model::Module& m : bandage.modules) {
    text += fmt::format("{} {} {}\n", m.stretch, m.length, m.voltage);
  }
  for (const model::OgdenTerm& t : bandage.ogden) text += fmt::format("{} {}\n", t.mu, t.alpha);
  text += fmt::format("{} {} {} {} {}\n", bandage.thickness, int(bandage.length_at), bandage.permittivity,
                      bandage.layers, bandage.breakdown_field);
  text += fmt::format("{} {} {} {} {} {} {}\n", int(fidelity), int(how.slice_precision), int(how.slice_rule),
                      how.slice_count, how.wall_points, int(how.slice_solver), how.fixed_point_tolerance);
  text +=
      fmt::format("{} {} {} {} {} {} {}\n", int(contact_axial), how.sliding_count, int(axisym.electrostatics),
                  int(axisym.multipliers), axisym.order, axisym.refine, axisym.ranks_per_case);
  text += fmt::format("{} {}\n", leg.shear_modulus, bandage.bulk_modulus);
  text += fmt::format("{} {} {} {} {} {}\n", goal.accuracy, int(goal.up_to), goal.pressure_rest,
                      goal.pressure_actuated, goal.actuation_drop, goal.volume_change);
  for (const model::Wanted& of : goal.of_segment)
    text += fmt::format("{} {} {} {}\n", of.pressure_rest, of.pressure_actuated, of.actuation_drop,
                        of.volume_change);
  text += fmt::format("{} {}\n", leg.radius_scale, leg.compliance_scale);
  return text;
}

// What PETSc's YAML loader makes of flat `key: value` lines: a list becomes its items with commas.
inline Given flat_yaml(const std::string& text) {
  Given given;
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) {
    const auto colon = line.find(": ");
    std::string value = line.substr(colon + 2);
    if (value.front() == '[') value = value.substr(1, value.size() - 2);
    given[line.substr(0, colon)] = value;
  }
  return given;
}

// The message of the InputError that reading these options ends with; empty where there is none.
inline std::string error_of(const Given& given, studies::Command command = studies::Command::solve) {
  try {
    studies::parse_request(command, given);
  } catch (const base::InputError& error) {
    return error.what();
  }
  return "";
}

}  // namespace gaiter::tests
