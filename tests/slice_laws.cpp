// SPDX-License-Identifier: BSD-2-Clause
#include <gtest/gtest.h>

#include "gaiter/physics/leg_law.hpp"
#include "gaiter/physics/slice_kernel.hpp"
#include "random_slices.hpp"

// The laws of a slice against the paper's printed equations in 50 digits (reference.hpp), and against closed
// forms.
namespace {

using namespace gaiter;
using model::LegMaterial;
using physics::Pack;
using physics::pack_width;
using physics::SliceShape;
using physics::SliceSystem;
using reference::Real;
using samples::Sampler;

std::vector<model::Scene> random_scenes(unsigned seed, LegMaterial material, int layers) {
  Sampler sampler(seed);
  std::vector<model::Scene> scenes;
  for (int i = 0; i < pack_width; ++i) scenes.push_back(sampler.scene(material, layers));
  return scenes;
}

double relative(Real value, Real expected) {
  return static_cast<double>(abs(value - expected) / abs(expected));
}

double scale_of(const SliceSystem& system, int i) {
  return system.constant(i, SliceShape::pressure_scale);
}

// Compares P_m, P_a and their difference with the reference at the given strains. The radius carries the
// rounding of gap/A and of A, of one unit of 1e-16 each, and P_m passes it on with its own slope; sums and
// exponentials cost the rest.
void compare_bandage(const std::vector<model::Scene>& scenes, const Pack& strain, int points,
                     double tolerance) {
  SliceSystem system = samples::system_of(scenes, points);
  Pack passive, passive_slope, total, slope, actuation, actuation_slope;
  physics::bandage_pressure(system.shape(), system.pack(0), strain, total, slope);
  physics::actuation_pressure(system.shape(), system.pack(0), strain, actuation, actuation_slope);
  system.energise(false);
  physics::bandage_pressure(system.shape(), system.pack(0), strain, passive, passive_slope);
  for (std::size_t i = 0; i < scenes.size(); ++i) {
    const reference::Slice slice = reference::slice_of(scenes[i], 0, 0.5);
    const Real radius = slice.leg_radius * (1 - Real(strain[i]));
    const Real expected = reference::mechanical_pressure<Real>(slice.tube, radius);
    const Real expected_actuation =
        slice.voltage * slice.voltage * reference::unit_actuation<Real>(slice.tube, radius);
    const double scale = scale_of(system, i);
    const double radius_rounding =
        2e-16 * (system.constant(i, SliceShape::gap) / system.constant(i, SliceShape::leg_radius) +
                 std::fabs(strain[i]));
    const double allowed = tolerance * static_cast<double>(abs(expected)) +
                           radius_rounding * std::fabs(passive_slope[i]) * scale;
    EXPECT_NEAR(passive[i] * scale, static_cast<double>(expected), allowed) << "slice " << i;
    if (expected_actuation == 0) continue;
    EXPECT_LT(relative(Real(actuation[i]) * scale, expected_actuation), tolerance) << "slice " << i;
    EXPECT_NEAR(total[i] * scale, static_cast<double>(expected - expected_actuation),
                allowed + tolerance * static_cast<double>(expected_actuation))
        << "slice " << i;
  }
}

TEST(LegStrain, IsEquationTwoAsPublished) {
  auto scenes = random_scenes(1, LegMaterial::compliance, 1);
  for (auto& scene : scenes) scene.leg.variant = model::ComplianceVariant::published;
  const SliceSystem system = samples::system_of(scenes, 2);
  Sampler sampler(2);
  for (int round = 0; round < 20; ++round) {
    Pack pressure, strain, slope;
    for (int i = 0; i < pack_width; ++i) pressure[i] = sampler.logarithmic(1e-6, 10);
    physics::leg_strain(system.shape(), system.pack(0), pressure, strain, slope);
    for (int i = 0; i < pack_width; ++i) {
      const Real expected = reference::strain_law<Real>(reference::slice_of(scenes[i], 0, 0.5),
                                                        Real(pressure[i]) * scale_of(system, i));
      // Rounding of the exponents and of a + c; the law itself crosses zero.
      const double size = 0.02 + scenes[0].leg.segments[0].compliance.a * std::exp(pressure[i]);
      EXPECT_NEAR(strain[i], static_cast<double>(expected), 1e-15 * (5 + pressure[i]) * size);
    }
  }
}

TEST(LegStrain, AnchoredKeepsItsDigitsAtTinyPressures) {
  auto scenes = random_scenes(3, LegMaterial::compliance, 1);
  for (auto& scene : scenes) scene.leg.variant = model::ComplianceVariant::anchored;
  const SliceSystem system = samples::system_of(scenes, 2);
  Sampler sampler(4);
  for (int round = 0; round < 20; ++round) {
    Pack pressure, strain, slope;
    for (int i = 0; i < pack_width; ++i) pressure[i] = sampler.logarithmic(1e-15, 4);
    physics::leg_strain(system.shape(), system.pack(0), pressure, strain, slope);
    for (int i = 0; i < pack_width; ++i) {
      const Real expected = reference::strain_law<Real>(reference::slice_of(scenes[i], 0, 0.5),
                                                        Real(pressure[i]) * scale_of(system, i));
      // Both terms are positive, so only rounding is left: a few units of 2e-16.
      EXPECT_LT(relative(strain[i], expected), 5e-15) << "pressure " << pressure[i];
    }
  }
}

TEST(LegStrain, NeoHookeanCylinderInvertsItsClosedForm) {
  const auto scenes = random_scenes(5, LegMaterial::neo_hookean, 1);
  const SliceSystem system = samples::system_of(scenes, 2);
  Sampler sampler(6);
  for (int round = 0; round < 30; ++round) {
    Pack pressure, strain, slope;
    for (int i = 0; i < pack_width; ++i) pressure[i] = sampler.logarithmic(1e-14, 1e6);
    physics::leg_strain(system.shape(), system.pack(0), pressure, strain, slope);
    for (int i = 0; i < pack_width; ++i) {
      const Real wanted = Real(pressure[i]) * scale_of(system, i);
      const Real got = reference::neo_hookean_pressure<Real>(scenes[i].leg, Real(strain[i]));
      // The error of the strain, through the slope of the law; exponents of up to 10 carry some 20 roundings.
      const Real error = (got - wanted) / scale_of(system, i) * slope[i];
      EXPECT_LT(static_cast<double>(abs(error)), 5e-15 * strain[i]) << "pressure " << pressure[i];
      ASSERT_GT(strain[i], 0);
      ASSERT_LT(strain[i], 1);
    }
  }
}

TEST(PressureBound, ReachesTheStrainAndNotMuchMore) {
  for (const LegMaterial material : {LegMaterial::compliance, LegMaterial::neo_hookean}) {
    const auto scenes = random_scenes(7, material, 1);
    const SliceSystem system = samples::system_of(scenes, 2);
    Sampler sampler(8);
    for (int round = 0; round < 20; ++round) {
      Pack wanted, bound, strain, slope;
      for (int i = 0; i < pack_width; ++i) {
        wanted[i] = round % 2 ? sampler.uniform(1e-3, 0.98) : sampler.logarithmic(1e-12, 1e-2);
        const auto constants = physics::leg_constants(scenes[i].leg, scenes[i].leg.segments[0]);
        bound[i] = physics::pressure_bound(scenes[i].leg, constants, wanted[i]);
        ASSERT_GT(bound[i], 0);
      }
      physics::leg_strain(system.shape(), system.pack(0), bound, strain, slope);
      for (int i = 0; i < pack_width; ++i) {
        EXPECT_GE(strain[i], wanted[i]);
        // What the bound leaves out is c exp(dP), at most 0.017.
        EXPECT_LT(strain[i], wanted[i] + 0.0171);
      }
    }
    const auto constants = physics::leg_constants(scenes[0].leg, scenes[0].leg.segments[0]);
    for (const double strain : {1.0, 7.0, std::numeric_limits<double>::infinity()})
      EXPECT_TRUE(std::isfinite(physics::pressure_bound(scenes[0].leg, constants, strain)));
    EXPECT_LE(physics::pressure_bound(scenes[0].leg, constants, -0.1), 0);
  }
}

TEST(BandagePressure, IsEquationsFourAndEightOfRandomTubes) {
  for (const int layers : {1, 2, 7}) {
    const auto scenes = random_scenes(10 + layers, LegMaterial::compliance, layers);
    Sampler sampler(20 + layers);
    Pack strain;
    for (int i = 0; i < pack_width; ++i) strain[i] = sampler.uniform(-0.05, 0.2);
    // 1e-13: exponents alpha ln lambda up to 20 carry some 20 roundings.
    compare_bandage(scenes, strain, 24, 1e-13);
  }
}

TEST(BandagePressure, KeepsItsDigitsNearTheReferenceRadius) {
  auto scenes = random_scenes(30, LegMaterial::compliance, 1);
  Sampler sampler(31);
  for (auto& scene : scenes) {
    scene.bandage.length_at = model::LengthAt::inner;
    const double off = sampler.logarithmic(1e-15, 1e-3);
    scene.bandage.modules[0].stretch = sampler.uniform(0, 1) < 0.5 ? 1 + off : 1 - off;
  }
  Pack none{};
  compare_bandage(scenes, none, 24, 1e-13);
}

TEST(BandagePressure, OfThinAndThickWalls) {
  Sampler sampler(40);
  for (const bool thin : {true, false}) {
    auto scenes = random_scenes(41, LegMaterial::compliance, thin ? 1 : 3);
    Pack strain;
    for (int i = 0; i < pack_width; ++i) {
      const double outer = scenes[i].leg.segments[0].lower_radius / scenes[i].bandage.modules[0].stretch;
      scenes[i].bandage.thickness = thin ? 1e-9 : 0.9 * outer;
      strain[i] = sampler.uniform(-0.05, 0.2);
    }
    // A stretch of up to 20 at the inner face, and exponents of up to 10: 128 points, and 60 roundings.
    compare_bandage(scenes, strain, thin ? 2 : 128, 1e-12);
  }
}

// lambda^30 of a sixfold stretch is 1e23, its inverse is lost beside 1: both signs of alpha need both powers.
TEST(BandagePressure, OfSteepTermsOfEitherSign) {
  auto scenes = random_scenes(45, LegMaterial::compliance, 1);
  Sampler sampler(46);
  for (auto& scene : scenes) {
    const double alpha = sampler.uniform(10, 30), mu = sampler.logarithmic(1e-6, 1e6);
    scene.bandage.modules[0].stretch = sampler.uniform(0.6, 6);
    scene.bandage.ogden = {{-mu, -alpha}, {0.5 * mu, alpha}};
  }
  Pack none{};
  compare_bandage(scenes, none, 40, 1e-12);  // exponents of up to 54, and a slope of 30 in the radius
}

TEST(ActuationPressure, OfManyLayersIsTheSumOverSingleOnes) {
  const int layers = 5;
  const auto scenes = random_scenes(50, LegMaterial::compliance, layers);
  const SliceSystem stacked = samples::system_of(scenes, 2);
  Pack strain, all, slope, sum{};
  Sampler sampler(51);
  for (int i = 0; i < pack_width; ++i) strain[i] = sampler.uniform(-0.05, 0.2);
  physics::actuation_pressure(stacked.shape(), stacked.pack(0), strain, all, slope);
  for (int k = 0; k < layers; ++k) {
    // Layer k as a tube of its own: its inner face goes where the incompressible wall takes it, so the leg
    // that it sits on has another radius and does not give way.
    SliceShape shape;
    shape.wall = physics::gauss_legendre(2);
    shape.ogden_terms = 2;
    shape.layers = 1;
    SliceSystem single(shape, pack_width);
    Pack none{}, one;
    for (int i = 0; i < pack_width; ++i) {
      model::Bandage bandage = scenes[i].bandage;
      const auto& segment = scenes[i].leg.segments[0];
      const double radius = segment.lower_radius * (1 - strain[i]);
      const double thickness = bandage.thickness / layers;
      const double inner = segment.lower_radius / bandage.modules[0].stretch - bandage.thickness;
      const double layer_inner = inner + k * thickness;
      const double deformed = std::sqrt(radius * radius + layer_inner * layer_inner - inner * inner);
      bandage.layers = 1;
      bandage.thickness = thickness;
      single.set(i, scenes[i].leg, segment, bandage, {layer_inner, thickness, deformed - layer_inner},
                 deformed, bandage.modules[0].voltage);
    }
    physics::actuation_pressure(single.shape(), single.pack(0), none, one, slope);
    for (int i = 0; i < pack_width; ++i) sum[i] += one[i];
  }
  // Thicknesses of 1e-5 m on radii of 0.05 m: forming the layers' radii costs up to 4 digits.
  for (int i = 0; i < pack_width; ++i) EXPECT_NEAR(all[i], sum[i], 1e-11 * all[i]) << i;
}

// Melnikov and Ogden (2016), ZAMP 67:140: neo-Hookean tube of inner radius 1 with closed ends held; mu is 1.
TEST(ElectroelasticTube, HasThePublishedPressuresAndVoltages) {
  struct Row {
    double outer, stretch, pressure, voltage;
  };
  for (const Row& row : {Row{2, 1.5, 0.428228, 0.777981}, Row{2, 2, 0.574054, 0.915945},
                         Row{1.1, 1.5, 0.074407, 0.088361}, Row{1.05, 2.2, 0.046539, 0.048837}}) {
    model::Scene scene = paper::cylinder(row.stretch, 1, 1);
    scene.bandage.ogden = {{1, 2}};
    scene.bandage.permittivity = 1 / 8.8541878128e-12;
    scene.bandage.thickness = row.outer - 1;
    SliceShape shape;
    shape.wall = physics::gauss_legendre(20);
    shape.layers = 1;
    SliceSystem system(shape, 1);
    system.set(0, scene.leg, scene.leg.segments[0], scene.bandage, {1, row.outer - 1, row.stretch - 1},
               row.stretch, 1);
    Pack none{}, actuation, slope, pressure;
    physics::actuation_pressure(system.shape(), system.pack(0), none, actuation, slope);
    system.energise(false);
    physics::bandage_pressure(system.shape(), system.pack(0), none, pressure, slope);
    const double scale = scale_of(system, 0);
    EXPECT_NEAR(pressure[0] * scale, row.pressure, 5e-7);  // all printed digits
    EXPECT_NEAR(std::sqrt(pressure[0] / actuation[0]), row.voltage, 5e-7);
    // And the closed form, to rounding.
    const double inner = row.stretch;
    const double outer = std::sqrt(1 + (inner * inner - 1) / (row.outer * row.outer));
    EXPECT_NEAR(pressure[0] * scale,
                std::log(inner / outer) - 0.5 * (1 / (inner * inner) - 1 / (outer * outer)), 1e-15);
  }
}

TEST(LargestField, IsThatAtTheInnermostFaceOfTheThinnestLayer) {
  for (const int layers : {1, 4}) {
    const auto scenes = random_scenes(60 + layers, LegMaterial::compliance, layers);
    const SliceSystem system = samples::system_of(scenes, 2);
    Pack strain, field;
    Sampler sampler(61);
    for (int i = 0; i < pack_width; ++i) strain[i] = sampler.uniform(-0.05, 0.2);
    physics::largest_field(system.shape(), system.pack(0), strain, field);
    for (int i = 0; i < pack_width; ++i) {
      const reference::Slice slice = reference::slice_of(scenes[i], 0, 0.5);
      const Real expected =
          reference::unit_field(slice.tube, slice.leg_radius * (1 - Real(strain[i]))) * slice.tube.inner;
      EXPECT_LT(relative(field[i], expected), 1e-13);
    }
  }
}

TEST(Quadrature, GaussIsExactToItsDegreeAndNotBeyond) {
  for (int points = 1; points <= 64; ++points) {
    const physics::Quadrature rule = physics::gauss_legendre(points);
    for (int degree = 0; degree < 2 * points; ++degree) {
      double sum = 0;
      for (int k = 0; k < points; ++k) sum += rule.weights[k] * std::pow(rule.nodes[k], degree);
      EXPECT_NEAR(sum, 1.0 / (degree + 1), 2e-15) << points << " points, degree " << degree;
    }
    for (int k = 1; k < points; ++k) EXPECT_LT(rule.nodes[k - 1], rule.nodes[k]);
    if (points > 6) continue;
    // The error on x^(2n) is (n!)^4 / ((2n + 1) ((2n)!)^2).
    double sum = 0;
    for (int k = 0; k < points; ++k) sum += rule.weights[k] * std::pow(rule.nodes[k], 2 * points);
    const double error =
        std::exp(4 * std::lgamma(points + 1.0) - 2 * std::lgamma(2.0 * points + 1)) / (2 * points + 1);
    EXPECT_NEAR(1.0 / (2 * points + 1) - sum, error, 1e-15);
  }
}

TEST(Quadrature, MidpointsAreThePapersSlices) {
  const physics::Quadrature rule = physics::slice_quadrature(model::SliceRule::midpoint, 4);
  for (int k = 0; k < 4; ++k) {
    EXPECT_DOUBLE_EQ(rule.nodes[k], 0.125 + 0.25 * k);
    EXPECT_DOUBLE_EQ(rule.weights[k], 0.25);
  }
}

TEST(Quadrature, ErrorOfTheExponentialIsABoundAndNotAWildOne) {
  int told = 0;
  for (int points = 1; points <= 6; ++points)
    for (const double rate : {0.05, 0.3, 1.0, 3.0, 6.0, 12.0}) {
      const physics::Quadrature rule = physics::gauss_legendre(points);
      double sum = 0;
      for (int k = 0; k < points; ++k) sum += rule.weights[k] * std::exp(rate * rule.nodes[k]);
      const double integral = std::expm1(rate) / rate;
      const double error = std::fabs(sum - integral) / integral;
      const double bound = physics::gauss_error_of_exponential(points, rate);
      if (error < 1e-13 || bound == 1) continue;  // rounding; beyond 1 it only says "useless"
      EXPECT_GE(bound, 0.999 * error) << points << " " << rate;
      EXPECT_LE(bound, 1.001 * error * std::exp(rate)) << points << " " << rate;
      ++told;
    }
  EXPECT_GT(told, 15);
  EXPECT_EQ(physics::gauss_error_of_exponential(3, 0), 0);
}

TEST(ReferenceWall, OfEveryWayToGiveIt) {
  model::Bandage bandage;
  bandage.thickness = 2e-3;
  for (const auto at : {model::LengthAt::outer, model::LengthAt::middle, model::LengthAt::inner})
    for (const bool by_length : {false, true}) {
      bandage.length_at = at;
      model::Module module{.stretch = 1.6, .length = by_length ? 0.16 : 0.0, .voltage = 0};
      const double mean = 40e-3, here = 41e-3;
      const double reference = by_length ? 0.16 / (2 * M_PI) : mean / 1.6;
      const double inner = reference - (at == model::LengthAt::outer    ? 2e-3
                                        : at == model::LengthAt::middle ? 1e-3
                                                                        : 0);
      const physics::Wall wall = physics::reference_wall(bandage, module, mean, here);
      EXPECT_NEAR(wall.inner_radius, inner, 1e-17);
      EXPECT_DOUBLE_EQ(wall.thickness, 2e-3);
      EXPECT_NEAR(wall.gap, here - inner, 1e-17);
    }
  // A gap of 1e-14 m between radii of 0.04 m has all its digits; formed from them it would have two.
  bandage.length_at = model::LengthAt::inner;
  const double stretch = 1 + 1e-12;
  const physics::Wall wall =
      physics::reference_wall(bandage, {.stretch = stretch, .length = 0, .voltage = 0}, 40e-3, 40e-3);
  const Real expected = Real(40e-3) * (Real(stretch) - 1) / Real(stretch);
  EXPECT_LT(relative(wall.gap, expected), 4e-16);
}

}  // namespace
