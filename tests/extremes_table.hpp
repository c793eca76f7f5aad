// SPDX-License-Identifier: BSD-2-Clause
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "condition.hpp"
#include "random_slices.hpp"
#include "slice_tasks.hpp"

// The slice model at the ends of what options admit: lines of a table, each a quantity drawn over its whole
// range, and what the program's answers differ by from the 50-digit reference. benchmarks/extremes prints
// the table; tests/extremes.cpp draws fewer and asserts bounds.
namespace gaiter::extremes {

using model::LengthAt;
using model::Scene;
using reference::Expected;
using reference::Real;
using samples::Sampler;

struct Case {
  Scene scene;
  bool stiffens = true;             // one equilibrium at rest
  std::optional<Expected> known{};  // where the reference's scan could not tell two roots apart
};

struct Line {
  std::string quantity, range;
  std::function<std::optional<Case>(Sampler&, int draw)> draw;
};

inline Case paper_case(Sampler& draw, double stretch, double voltage) {
  Scene scene = paper::cylinder(39.6e-3, stretch, voltage);
  scene.leg.variant =
      draw.uniform(0, 1) < 0.5 ? model::ComplianceVariant::published : model::ComplianceVariant::anchored;
  scene.bandage.length_at = draw.uniform(0, 1) < 0.5 ? LengthAt::outer : LengthAt::inner;
  return {scene};
}

// Below and above a critical voltage, by parts from 1e-1 to 1e-9.
inline double beside(Sampler& draw, int number, double critical) {
  const double part = number < 2 ? 1e-9 : draw.logarithmic(1e-9, 1e-1);
  return critical * (number % 2 == 0 ? 1 - part : 1 + part);
}

// A bandage that softens on a soft leg: the path turns back before the bandage has left the leg.
inline std::optional<Case> limit_point_on_leg(Sampler& draw, int number) {
  Scene scene = paper::cylinder(39.6e-3, 3.5);
  scene.bandage.ogden = {{draw.logarithmic(1e3, 8e4), draw.uniform(0.3, 1.5)}};
  scene.leg.material = model::LegMaterial::neo_hookean;
  scene.leg.young_modulus = draw.logarithmic(300, 3000);
  scene.leg.poisson_ratio = 0.2;
  const auto slice = reference::slice_of(scene, 0, 0.5);
  const auto rest = reference::first_change(slice, 0, 0, reference::slack_parameter(slice), false, 1000);
  if (!rest) return std::nullopt;
  const auto peak = reference::largest_voltage(slice, *rest, 0);
  if (peak.parameter < 0.02 * *rest || peak.parameter > 0.98 * *rest) return std::nullopt;
  double& voltage = scene.bandage.modules[0].voltage;
  voltage = beside(draw, number, static_cast<double>(peak.voltage));
  Case found{scene, false};
  if (voltage < peak.voltage) {
    const auto balance = [&](const Real& p) { return reference::imbalance<Real>(slice, p, voltage); };
    const Real parameter = reference::root<Real>(balance, peak.parameter, *rest);
    const auto point = reference::leg_at<Real>(slice, parameter);
    found.known = Expected{reference::leg_at<Real>(slice, *rest).pressure, point.pressure, *rest, parameter,
                           point.radius};
  }
  return found;
}

// A bandage that has left the leg and bears a largest voltage, floating free.
inline std::optional<Case> pull_in_floating(Sampler& draw, int number) {
  Scene scene = paper::cylinder(39.6e-3, draw.uniform(1.1, 1.5));
  scene.leg.data_limit = 1e300;
  scene.bandage.ogden = {{draw.logarithmic(1e3, 1e6), draw.uniform(0.8, 1.4)}};
  scene.bandage.thickness = draw.logarithmic(1e-4, 5e-3);
  const auto slice = reference::slice_of(scene, 0, 0.5);
  const Real start = reference::leg_at<Real>(slice, 0).radius;
  const auto peak = reference::largest_floating_voltage(slice.tube, start, 6 * start);
  const Real lift_off = sqrt(reference::mechanical_pressure<Real>(slice.tube, start) /
                             reference::unit_actuation<Real>(slice.tube, start));
  if (peak.parameter < 1.05 * start || peak.parameter > 5.5 * start || peak.voltage < 1.15 * lift_off)
    return std::nullopt;
  double& voltage = scene.bandage.modules[0].voltage;
  voltage = beside(draw, number, static_cast<double>(peak.voltage));
  Case found{scene, false};
  found.known = reference::expectation(reference::slice_of(scene, 0, 0.5), false, 300);
  if (voltage < peak.voltage) {
    const Real square = Real(voltage) * Real(voltage);
    const auto pull = [&](const Real& r) {
      return Real(reference::mechanical_pressure<Real>(slice.tube, r) -
                  square * reference::unit_actuation<Real>(slice.tube, r));
    };
    found.known->bandage_radius = reference::root<Real>(pull, start, peak.parameter);
    found.known->status = model::Status::lifted;
  }
  return found;
}

// The voltage at which the bandage just leaves the leg.
inline std::optional<Case> lift_off(Sampler& draw, int number) {
  Case made = paper_case(draw, 1 + draw.logarithmic(1e-2, 3), 0);
  const auto slice = reference::slice_of(made.scene, 0, 0.5);
  const Real radius = reference::leg_at<Real>(slice, 0).radius;
  if (radius <= slice.tube.inner) return std::nullopt;
  const Real critical = sqrt(reference::mechanical_pressure<Real>(slice.tube, radius) /
                             reference::unit_actuation<Real>(slice.tube, radius));
  made.scene.bandage.modules[0].voltage = beside(draw, number, static_cast<double>(critical));
  return made;
}

inline double some_voltage(Sampler& draw) {
  return draw.uniform(0, 1) < 0.3 ? 0 : draw.logarithmic(1, 12e3);
}

inline std::vector<Line> lines() {
  return {
      {"stretch next to 1", "1 +- 1e-15 to 1e-3",
       [](Sampler& d, int number) {
         const double part = number < 4 ? 1e-15 : d.logarithmic(1e-15, 1e-3);
         return std::optional(paper_case(d, number % 2 == 0 ? 1 + part : 1 - part, some_voltage(d)));
       }},
      {"stretch", "1.001 to 20",
       [](Sampler& d, int number) {
         return std::optional(paper_case(d, number == 0 ? 20 : 1 + d.logarithmic(1e-3, 19), some_voltage(d)));
       }},
      {"thin wall", "1e-9 to 1e-3 m",
       [](Sampler& d, int number) {
         Case made = paper_case(d, 1 + d.logarithmic(1e-2, 2), 0);
         made.scene.bandage.thickness = number == 0 ? 1e-9 : d.logarithmic(1e-9, 1e-3);
         made.scene.bandage.modules[0].voltage = made.scene.bandage.thickness * d.uniform(0, 8e6);
         return std::optional(made);
       }},
      {"thick wall", "0.1 to 0.99 of its outer radius",
       [](Sampler& d, int number) {
         Case made = paper_case(d, 1 + d.logarithmic(1e-2, 2), some_voltage(d));
         made.scene.bandage.length_at = LengthAt::outer;
         const double part = number == 0 ? 0.99 : 1 - d.logarithmic(0.01, 0.9);
         made.scene.bandage.thickness = part * 39.6e-3 / made.scene.bandage.modules[0].stretch;
         return std::optional(made);
       }},
      {"Ogden exponent", "-50 to -2, 2 to 50",
       [](Sampler& d, int number) {
         Case made = paper_case(d, d.logarithmic(0.9, 6), some_voltage(d));
         const double size = number < 2 ? 50 : d.logarithmic(2, 50), sign = number % 2 == 0 ? 1 : -1;
         made.scene.bandage.ogden = {{sign * d.logarithmic(1e2, 1e5), sign * size}, {-1e3, -2.5}};
         return std::optional(made);
       }},
      {"softening exponent", "0.01 to 2",
       [](Sampler& d, int number) {
         Case made = paper_case(d, 1 + d.logarithmic(1e-2, 2), 0);
         made.stiffens = false;
         made.scene.bandage.ogden = {{d.logarithmic(1e3, 1e5), number == 0 ? 0.01 : d.logarithmic(0.01, 2)}};
         return std::optional(made);
       }},
      {"stiffness of the bandage", "1e-2 to 1e12 Pa",
       [](Sampler& d, int number) {
         Case made = paper_case(d, 1 + d.logarithmic(1e-3, 5), number % 2 == 0 ? 0 : 11.3e3);
         const double mu = number < 2 ? 1e-2 : number < 4 ? 1e12 : d.logarithmic(1e-2, 1e12);
         made.scene.bandage.ogden = {{mu, 3.5}};
         return std::optional(made);
       }},
      {"stiffness of a neo-Hookean leg", "1 to 1e13 Pa, Poisson's ratio 0 to 0.5 - 1e-7",
       [](Sampler& d, int number) {
         Case made = paper_case(d, 1 + d.logarithmic(1e-3, 2), some_voltage(d));
         made.scene.leg.material = model::LegMaterial::neo_hookean;
         made.scene.leg.young_modulus = number == 0 ? 1 : number == 1 ? 1e13 : d.logarithmic(1, 1e13);
         made.scene.leg.poisson_ratio = number % 3 == 0 ? 0 : 0.5 - d.logarithmic(1e-7, 0.4);
         return std::optional(made);
       }},
      {"radius", "1e-4 to 10 m",
       [](Sampler& d, int number) {
         Case made = paper_case(d, 1 + d.logarithmic(1e-2, 2), 0);
         const double radius = number == 0 ? 1e-4 : number == 1 ? 10 : d.logarithmic(1e-4, 10);
         auto& segment = made.scene.leg.segments[0];
         segment.lower_radius = segment.upper_radius = radius;
         made.scene.bandage.thickness = radius * d.logarithmic(1e-3, 0.1);
         made.scene.bandage.modules[0].voltage = made.scene.bandage.thickness * d.uniform(0, 8e6);
         return std::optional(made);
       }},
      {"compliance constants", "each over six decades",
       [](Sampler& d, int) {
         Case made = paper_case(d, 1 + d.logarithmic(1e-2, 2), some_voltage(d));
         auto& law = made.scene.leg.segments[0].compliance;
         law.a = std::min(0.99, law.a * d.logarithmic(1e-3, 1e3));
         law.b *= d.logarithmic(1e-3, 1e3);
         law.c = std::max(-0.99 - law.a, law.c * d.logarithmic(1e-3, 1e3));
         law.d *= d.logarithmic(1e-3, 1e3);
         return std::optional(made);
       }},
      {"voltage", "1e-6 to 1e9 V",
       [](Sampler& d, int number) {
         const double voltage = number == 0 ? 1e-6 : number == 1 ? 1e9 : d.logarithmic(1e-6, 1e9);
         return std::optional(paper_case(d, 1 + d.logarithmic(1e-2, 2), voltage));
       }},
      {"voltage beside lift-off", "off by 1e-9 to 1e-1", lift_off},
      {"voltage beside the limit point on the leg", "off by 1e-9 to 1e-1", limit_point_on_leg},
      {"voltage beside pull-in", "off by 1e-9 to 1e-1", pull_in_floating},
      {"layers", "1 to 1000",
       [](Sampler& d, int number) {
         Case made = paper_case(d, 1 + d.logarithmic(1e-1, 2), 0);
         const double layers = number == 0 ? 1000 : std::floor(d.logarithmic(1, 1000));
         made.scene.bandage.layers = static_cast<int>(layers);
         made.scene.bandage.modules[0].voltage = 8e3 / layers * d.uniform(0, 1);
         return std::optional(made);
       }},
  };
}

// What one case comes to: of the output that is furthest off, measured by its condition number.
struct Finding {
  bool same_status = true;
  model::Status status = model::Status::contact, expected = model::Status::contact;
  double error = 0, condition = 1;          // the largest relative error of all outputs, and its condition
  double amplification = 0;                 // largest error over condition times epsilon
  int output = 0;                           // the one of it
  double pressure_error = 0, estimate = 0;  // of the pressures, and the program's own estimate
};

inline Finding compare(const Case& one) {
  constexpr double epsilon = 2.220446049250313e-16;
  const auto result = tasks::solve_one(one.scene);
  const auto slice = reference::slice_of(one.scene, 0, 0.5);
  const Expected expected =
      one.known ? *one.known : reference::expectation(slice, one.stiffens, one.stiffens ? 300 : 1000);
  Finding finding;
  finding.status = result.status;
  finding.expected = expected.status;
  finding.same_status = result.status == expected.status;
  finding.estimate = result.discretisation_error;
  if (!finding.same_status || !model::trustworthy(result.status)) return finding;
  const auto exact = reference::conditioned(one.scene, expected);
  const Real volume = reference::pi<Real>() * Real(one.scene.leg.segments[0].height);
  const Real got[] = {result.pressure_rest,
                      result.pressure_actuated,
                      result.pressure_rest_rigid,
                      result.pressure_actuated_rigid,
                      result.actuation_drop,
                      Real(result.volume_rest) / volume,
                      Real(result.volume_actuated) / volume,
                      result.volume_change,
                      result.radius_actuated,
                      result.stretch_actual,
                      result.actuation_pressure,
                      result.electric_field_max};
  for (int k = 0; k < reference::output_count; ++k) {
    const bool pulled_in = expected.status == model::Status::pulled_in;
    if (pulled_in && (k == reference::field || k == reference::actuation_pressure)) continue;
    const Real difference = fabs(got[k] - exact.value[k]);
    const double error = difference == 0       ? 0
                         : exact.value[k] == 0 ? std::numeric_limits<double>::infinity()
                                               : static_cast<double>(difference / fabs(exact.value[k]));
    const double condition = std::max(1.0, static_cast<double>(exact.condition[k]));
    const double amplification =
        std::isnan(error) ? std::numeric_limits<double>::infinity() : error / (condition * epsilon);
    if (amplification > finding.amplification) finding.amplification = amplification, finding.output = k;
    if (!(error <= finding.error)) finding.error = error, finding.condition = condition;
    if (k <= reference::actuated_rigid) finding.pressure_error = std::max(finding.pressure_error, error);
  }
  return finding;
}

}  // namespace gaiter::extremes
