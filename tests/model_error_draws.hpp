// SPDX-License-Identifier: BSD-2-Clause
#pragma once

#include <algorithm>
#include <boost/random/sobol.hpp>
#include <cmath>
#include <cstdint>
#include <vector>

#include "gaiter/model/scene.hpp"
#include "paper_scene.hpp"

namespace gaiter {

// A conical segment of mean radius 40 mm, told by what the differences between the models depend on.
struct ConeCase {
  double taper = 0;         // angle of the leg's surface with its axis [rad]
  double stretch = 1.4;     // of the bandage
  double slenderness = 1;   // height over mean radius
  double compliance = 1;    // times that of the leg: of its strain law, or 80 kPa / E
  double wall = 0.025;      // over mean radius
  double stiffness = 1;     // of the bandage, times that of the paper's surrogate
  double alpha = 0;         // Ogden exponent of a bandage of one term; 0: the surrogate
  double mooney = 0;        // with alpha = 2, part of the shear modulus of a second term, of exponent -2
  double leg_shear = 10e3;  // shear modulus of the leg with a strain law [Pa]
  double poisson = 0;       // of a neo-Hookean leg; 0: the strain law of region `region` of the paper
  int region = 0;
  double voltage_part = 0.5;  // of the last stable one
};

inline model::Scene scene_of(const ConeCase& c) {
  constexpr double radius = 40e-3;
  model::Scene scene = paper::scene(c.stretch, 0);
  model::Segment segment = scene.leg.segments[c.region];
  segment.height = c.slenderness * radius;
  const double rise = 0.5 * segment.height * std::tan(c.taper);
  segment.lower_radius = radius - rise;
  segment.upper_radius = radius + rise;
  segment.compliance.a *= c.compliance;
  segment.compliance.c *= c.compliance;
  scene.leg.segments = {segment};
  scene.leg.variant = model::ComplianceVariant::anchored;
  scene.leg.data_limit = INFINITY;
  scene.leg.shear_modulus = c.leg_shear;
  if (c.poisson > 0) {
    scene.leg.material = model::LegMaterial::neo_hookean;
    scene.leg.young_modulus = 80e3 / c.compliance;
    scene.leg.poisson_ratio = c.poisson;
  }
  scene.bandage.modules.resize(1);
  scene.bandage.thickness = c.wall * radius;
  if (c.alpha != 0) {
    double shear = 0;  // the surrogate's initial one
    for (const model::OgdenTerm& term : scene.bandage.ogden) shear += 0.5 * term.mu * term.alpha;
    scene.bandage.ogden = {{2 * shear * (1 - c.mooney) / c.alpha, c.alpha}};
    if (c.mooney > 0) scene.bandage.ogden.push_back({-shear * c.mooney, -2});
  }
  for (model::OgdenTerm& term : scene.bandage.ogden) term.mu *= c.stiffness;
  return scene;
}

// Of a thin wall on a leg that does not give way, at mean radius [Pa].
inline double thin_pressure(const ConeCase& c) {
  double hoop = 0;
  for (const model::OgdenTerm& term : scene_of(c).bandage.ogden)
    hoop += term.mu * (std::pow(c.stretch, term.alpha) - std::pow(c.stretch, -term.alpha));
  return hoop * c.wall / c.stretch;
}

// Strain of the leg of compliance 1 under a pressure [Pa].
inline double leg_strain(const ConeCase& c, double pressure) {
  if (c.poisson > 0) return pressure * (1 - 2 * c.poisson) * (1 + c.poisson) / 80e3;
  const model::Compliance& law = paper::scene(1).leg.segments[c.region].compliance;
  return law.a * (std::exp(law.b * pressure) - std::exp(law.d * pressure));
}

// Points `first` to `first + count` of a Sobol sequence in the box that model_error is calibrated in.
inline std::vector<ConeCase> draw_cones(std::uint64_t first, std::size_t count) {
  constexpr unsigned axes = 11;
  boost::random::sobol engine(axes);
  engine.discard(first * axes);
  std::vector<ConeCase> cases;
  const auto draw = [&] { return std::ldexp(static_cast<double>(engine()), -64); };
  const auto uniform = [&](double low, double high) { return low + (high - low) * draw(); };
  const auto logarithmic = [&](double low, double high) { return low * std::pow(high / low, draw()); };
  for (std::size_t k = 0; k < count; ++k) {
    ConeCase c;
    c.slenderness = logarithmic(0.3, 5);
    c.taper = uniform(0, std::min(20 * M_PI / 180, std::atan(1.2 / c.slenderness)));
    c.stretch = uniform(1.06, 2.2);
    c.compliance = logarithmic(0.01, 20);
    c.wall = logarithmic(0.0025, 0.05);
    const double pressure = logarithmic(200, 15e3);
    const double material = draw();
    c.alpha = material < 0.3 ? 0 : material < 0.45 ? 2 : 1.5 + 4.5 * (material - 0.45) / 0.55;
    c.mooney = material < 0.3 || material >= 0.45 ? 0 : 0.4 * (material - 0.3) / 0.15;
    const double shear_part = logarithmic(0.04, 1);  // of the leg's stiffness
    const double leg = draw();
    c.poisson = leg < 0.6 ? 0 : 0.3 + 0.17 * (leg - 0.6) / 0.4;
    c.region = std::min(5, static_cast<int>(6 * draw()));
    c.voltage_part = uniform(0.2, 0.9);
    c.stiffness = pressure / thin_pressure(c);
    c.compliance = std::min(c.compliance, 0.3 / leg_strain(c, pressure));
    c.leg_shear = shear_part / (leg_strain(c, 1) * c.compliance);
    cases.push_back(c);
  }
  return cases;
}

}  // namespace gaiter
