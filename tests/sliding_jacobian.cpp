// SPDX-License-Identifier: BSD-2-Clause
// Energy, residual and tangent of sliding slices agree: Taylor remainders of second order, over random
// admissible states of random segments, 64 at a time; and the banded solve inverts the tangent.
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "gaiter/physics/sliding_newton.hpp"
#include "paper_scene.hpp"

namespace gaiter::physics {
namespace {

struct Law {
  const char* name;
  model::LegMaterial material;
  model::ComplianceVariant variant;
  bool rigid;
  int layers;
  std::vector<model::OgdenTerm> ogden;
  bool held = false;
};

void PrintTo(const Law& law, std::ostream* out) {
  *out << law.name;
}

class SlidingTaylor : public testing::TestWithParam<Law> {
 protected:
  static constexpr int elements = 4;
  static constexpr int slices = sliding_degree * elements;

  SlidingTaylor() : system_(make()), random_(7) {
    for (std::size_t i = 0; i < pack_width; ++i) {
      const Law& law = GetParam();
      model::Scene scene = paper::scene(uniform(1.1, 2.4), uniform(2e3, 12e3));
      scene.leg.material = law.material;
      scene.leg.variant = law.variant;
      scene.leg.segments[0].upper_radius = scene.leg.segments[0].lower_radius * uniform(0.7, 1.4);
      scene.leg.segments[0].height = uniform(0.02, 0.2);
      scene.leg.poisson_ratio = uniform(0.1, 0.45);
      scene.bandage.ogden = law.ogden;
      scene.bandage.thickness = uniform(2e-4, 3e-3);
      scene.bandage.layers = law.layers;
      scene.contact_axial = law.held ? model::ContactAxial::held : model::ContactAxial::free;
      system_.set(i, scene, 0, gauss_legendre(i % 2 == 0 ? 3 : 2));
    }
  }

  static SlidingSystem make() {
    const Law& law = GetParam();
    SliceShape shape;
    shape.wall = gauss_legendre(3);
    shape.ogden_terms = static_cast<int>(law.ogden.size());
    shape.layers = law.layers;
    shape.material = law.material;
    return SlidingSystem({elements, law.rigid}, shape, pack_width);
  }

  double uniform(double low, double high) {
    return low + (high - low) * (static_cast<double>(random_()) / random_.max());
  }

  // Slips that keep dz/dZ between about 0.6 and 1.6; slices on and off the leg, none so near to touching that
  // a Taylor step crosses there.
  std::vector<Pack> random_state() {
    std::vector<Pack> unknown(2 * slices);
    for (int i = 0; i < pack_width; ++i) {
      const double height = system_.pack(0)[SlidingSystem::element_height][i];
      for (int row = 0; row + 1 < slices; ++row) unknown[row][i] = uniform(-0.03, 0.03) * height;
      unknown[slices - 1][i] = 0;
      for (int slice = 0; slice < slices; ++slice)
        unknown[slices + slice][i] = uniform(0, 1) < 0.8 ? uniform(0.01, 0.3) : -uniform(0.01, 0.1);
    }
    return unknown;
  }

  std::vector<Pack> random_direction() {
    std::vector<Pack> direction = random_state();
    for (int row = 0; row < slices; ++row)
      for (int i = 0; i < pack_width; ++i) {
        if (GetParam().held) direction[row][i] = 0;
        direction[slices + row][i] = uniform(-0.1, 0.1);
      }
    return direction;
  }

  static std::vector<Pack> moved(const std::vector<Pack>& from, double step,
                                 const std::vector<Pack>& direction) {
    std::vector<Pack> to = from;
    for (std::size_t row = 0; row < to.size(); ++row)
      for (int i = 0; i < pack_width; ++i) to[row][i] += step * direction[row][i];
    return to;
  }

  SlidingSystem system_;
  std::mt19937 random_;
};

TEST_P(SlidingTaylor, ResidualIsTheDerivativeOfTheEnergy) {
  const std::vector<Pack> at = random_state(), along = random_direction();
  SlidingTangent here(slices);
  evaluate_sliding(system_, 0, at, here);
  const double steps[] = {0.02, 0.01, 0.005};
  double remainder[3][pack_width];
  for (int k = 0; k < 3; ++k) {
    SlidingTangent ahead(slices), behind(slices);
    evaluate_sliding(system_, 0, moved(at, steps[k], along), ahead);
    evaluate_sliding(system_, 0, moved(at, -steps[k], along), behind);
    for (int i = 0; i < pack_width; ++i) {
      ASSERT_EQ(here.admissible[i], 1);
      double slope = 0;
      for (int row = 0; row + 1 < slices; ++row) slope += here.residual[row][i] * along[row][i];
      for (int slice = 0; slice < slices; ++slice)
        slope += slice_share(system_.shape(), slice) * elements *
                 system_.pack(0)[SlidingSystem::element_height][i] * here.residual[slices + slice][i] *
                 here.strain_slope[slice][i] * along[slices + slice][i];
      ASSERT_NE(slope, 0);
      // The central difference leaves the third order, and that only by the third derivative.
      remainder[k][i] =
          std::fabs((ahead.energy[i] - behind.energy[i]) / (2 * steps[k]) - slope) / std::fabs(slope);
    }
  }
  int clear = 0;
  for (int i = 0; i < pack_width; ++i) {
    EXPECT_LT(remainder[2][i], 0.02) << "segment " << i;
    if (remainder[2][i] < 1e-9) continue;  // rounding of the energies
    ++clear;
    EXPECT_NEAR(remainder[0][i] / remainder[1][i], 4, 0.6) << "segment " << i;
    EXPECT_NEAR(remainder[1][i] / remainder[2][i], 4, 0.6) << "segment " << i;
  }
  EXPECT_GT(clear, pack_width / 2);
}

TEST_P(SlidingTaylor, TangentIsTheDerivativeOfTheResidual) {
  const std::vector<Pack> at = random_state(), along = random_direction();
  SlidingTangent here(slices);
  evaluate_sliding(system_, 0, at, here);
  std::vector<Pack> predicted(2 * slices);
  multiply_sliding(system_, 0, here, along, predicted);
  const double steps[] = {4e-3, 2e-3, 1e-3};
  double remainder[3][pack_width], size[pack_width];
  for (int k = 0; k < 3; ++k) {
    SlidingTangent ahead(slices);
    evaluate_sliding(system_, 0, moved(at, steps[k], along), ahead);
    for (int i = 0; i < pack_width; ++i) {
      remainder[k][i] = size[i] = 0;
      for (int row = 0; row < 2 * slices; ++row) {
        if (row == slices - 1 || (GetParam().held && row < slices)) continue;
        const double change = ahead.residual[row][i] - here.residual[row][i];
        remainder[k][i] += std::pow(change - steps[k] * predicted[row][i], 2);
        size[i] += std::pow(steps[k] * predicted[row][i], 2);
      }
      remainder[k][i] = std::sqrt(remainder[k][i] / size[i]) * steps[k];
    }
  }
  for (int i = 0; i < pack_width; ++i) {
    EXPECT_GT(size[i], 0);
    EXPECT_GT(remainder[0][i], 0) << "a linear residual is no test";
    if (remainder[2][i] < 1e-12) continue;
    EXPECT_NEAR(remainder[0][i] / remainder[1][i], 4, 0.4) << "segment " << i;
    EXPECT_NEAR(remainder[1][i] / remainder[2][i], 4, 0.4) << "segment " << i;
  }
}

TEST_P(SlidingTaylor, BandedSolveInvertsTheTangent) {
  const std::vector<Pack> at = random_state(), wanted = random_direction();
  SlidingTangent here(slices);
  evaluate_sliding(system_, 0, at, here);
  std::vector<Pack> right(2 * slices), found(2 * slices);
  multiply_sliding(system_, 0, here, wanted, right);
  Pack negative;
  solve_sliding_tangent(system_, 0, here, right, found, negative);
  int solved = 0;
  for (int i = 0; i < pack_width; ++i) {
    if (negative[i] > 0) continue;  // then it is another matrix
    ++solved;
    double error = 0, size = 0;
    for (int row = 0; row < 2 * slices; ++row) {
      error = std::max(error, std::fabs(found[row][i] - wanted[row][i]));
      size = std::max(size, std::fabs(wanted[row][i]));
    }
    EXPECT_LT(error, 1e-9 * size) << "segment " << i;
  }
  EXPECT_GT(solved, pack_width / 4);
}

const std::vector<model::OgdenTerm> surrogate = {{21.193e3, 3.507}, {10.514, 12.147}};
const std::vector<model::OgdenTerm> three_terms = {{10e3, 2}, {-4e3, -3.1}, {300, 6.2}};
using enum model::ComplianceVariant;
constexpr auto strain_law = model::LegMaterial::compliance;
constexpr auto neo_hookean = model::LegMaterial::neo_hookean;

INSTANTIATE_TEST_SUITE_P(
    Laws, SlidingTaylor,
    testing::Values(Law{"published", strain_law, published, false, 0, surrogate},
                    Law{"anchored_voltage", strain_law, anchored, false, 1, surrogate},
                    Law{"published_layers_three_terms", strain_law, published, false, 3, three_terms},
                    Law{"neo_hookean", neo_hookean, anchored, false, 0, {{37e3, 2}}},
                    Law{"neo_hookean_voltage", neo_hookean, anchored, false, 2, three_terms},
                    Law{"rigid_voltage", strain_law, anchored, true, 1, surrogate},
                    Law{"held", strain_law, published, false, 1, surrogate, true}),
    [](const auto& law) { return std::string(law.param.name); });

}  // namespace
}  // namespace gaiter::physics
