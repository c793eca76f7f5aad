// SPDX-License-Identifier: BSD-2-Clause
#pragma once

#include <cmath>

#include "gaiter/model/scene.hpp"

namespace gaiter::paper {

// The leg and bandage of Pourazadi, Ahmadi and Menon (2015): Table 1 as published, the end radii and Ogden
// constants (`paper-surrogate`) those of options/scenes/paper.yaml, which says where they come from.
inline model::Scene scene(double stretch, double voltage = 11.3e3) {
  const double radii[] = {35.85e-3, 43.37e-3, 49.95e-3, 55.59e-3, 60.17e-3, 62.35e-3, 63.15e-3};
  const char* names[] = {"r6", "r5", "r4", "r3", "r2", "r1"};
  const model::Compliance compliances[] = {
      {0.013392, 7.898e-5, -0.01600, -0.001137}, {0.009989, 4.967e-5, -0.01465, -0.001386},
      {0.008678, 7.532e-5, -0.00913, -0.000828}, {0.01373, 3.492e-5, -0.01686, -0.001133},
      {0.01188, 5.511e-5, -0.01466, -0.001392},  {0.012223, 2.731e-5, -0.01513, -0.001263}};
  model::Scene scene;
  for (int i = 0; i < 6; ++i) {
    scene.leg.segments.push_back({names[i], 35e-3, radii[i], radii[i + 1], compliances[i]});
    scene.bandage.modules.push_back({.stretch = stretch, .length = 0, .voltage = voltage});
  }
  scene.bandage.thickness = 1e-3;
  scene.bandage.ogden = {{21.193e3, 3.507}, {10.514, 12.147}};
  scene.bandage.permittivity = 7.41;
  return scene;
}

// One cylinder of leg with the paper's ankle compliance and bandage: a single slice tells all about it.
inline model::Scene cylinder(double radius, double stretch, double voltage = 0) {
  model::Scene scene = paper::scene(stretch, voltage);
  scene.leg.segments.resize(1);
  scene.bandage.modules.resize(1);
  scene.leg.segments[0].lower_radius = scene.leg.segments[0].upper_radius = radius;
  scene.discretisation.slice_count = 1;
  return scene;
}

// The paper's radius, height and ankle compliance (anchored) on a cone.
inline model::Scene cone(double degrees, double stretch, double voltage = 0) {
  model::Scene scene = paper::cylinder(39.6e-3, stretch, voltage);
  model::Segment& segment = scene.leg.segments[0];
  const double half = 0.5 * segment.height * std::tan(degrees * M_PI / 180);
  segment.lower_radius -= half;
  segment.upper_radius += half;
  scene.leg.variant = model::ComplianceVariant::anchored;
  scene.discretisation.slice_count = 6;
  return scene;
}

}  // namespace gaiter::paper
