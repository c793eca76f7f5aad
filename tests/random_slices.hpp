// SPDX-License-Identifier: BSD-2-Clause
#pragma once

#include <cmath>
#include <random>
#include <vector>

#include "gaiter/model/scene.hpp"
#include "gaiter/physics/slice_system.hpp"
#include "paper_scene.hpp"
#include "reference.hpp"

namespace gaiter::samples {

// Admissible slices drawn at random, far beyond the paper's, and the same for every run: a failure can be
// repeated.
class Sampler {
 public:
  explicit Sampler(unsigned seed) : generator_(seed) {}

  double uniform(double low, double high) {
    return low + (high - low) * (static_cast<double>(generator_()) / generator_.max());
  }
  double logarithmic(double low, double high) { return std::exp(uniform(std::log(low), std::log(high))); }

  // A cylinder of leg and its bandage. Stiffening terms only: |alpha| >= 2 and mu alpha > 0.
  model::Scene scene(model::LegMaterial material, int layers) {
    model::Scene scene = paper::cylinder(uniform(20e-3, 80e-3), 1 + logarithmic(1e-3, 2), uniform(0, 15e3));
    scene.leg.material = material;
    scene.leg.variant =
        uniform(0, 1) < 0.5 ? model::ComplianceVariant::published : model::ComplianceVariant::anchored;
    scene.leg.young_modulus = logarithmic(10e3, 1e6);
    scene.leg.poisson_ratio = uniform(0.1, 0.49);
    scene.leg.segments[0].compliance = {uniform(0.008, 0.014), uniform(2e-5, 8e-5), -uniform(0.014, 0.017),
                                        -uniform(8e-4, 14e-4)};
    scene.bandage.thickness = logarithmic(1e-4, 5e-3);
    scene.bandage.permittivity = uniform(2, 10);
    scene.bandage.layers = layers;
    const double exponent = uniform(2, 10);
    scene.bandage.ogden = {{logarithmic(1e3, 1e5), exponent}, {-logarithmic(1, 1e4), -uniform(2, 8)}};
    return scene;
  }

 private:
  std::mt19937 generator_;
};

// The scenes' only slices as one system with `points` through the wall.
inline physics::SliceSystem system_of(const std::vector<model::Scene>& scenes, int points) {
  physics::SliceShape shape;
  shape.wall = physics::gauss_legendre(points);
  shape.ogden_terms = static_cast<int>(scenes[0].bandage.ogden.size());
  shape.material = scenes[0].leg.material;
  for (const model::Scene& scene : scenes) shape.layers = std::max(shape.layers, scene.bandage.layers);
  physics::SliceSystem system(shape, scenes.size());
  for (std::size_t i = 0; i < scenes.size(); ++i) {
    const model::Segment& segment = scenes[i].leg.segments[0];
    const model::Module& module = scenes[i].bandage.modules[0];
    const double radius = segment.lower_radius;
    system.set(i, scenes[i].leg, segment, scenes[i].bandage,
               physics::reference_wall(scenes[i].bandage, module, segment.mean_radius(), radius), radius,
               module.voltage);
  }
  return system;
}

}  // namespace gaiter::samples
