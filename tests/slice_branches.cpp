// SPDX-License-Identifier: BSD-2-Clause
#include <gtest/gtest.h>

#include <cmath>

#include "gaiter/physics/branch.hpp"
#include "random_slices.hpp"
#include "reference.hpp"
#include "slice_tasks.hpp"

// Which equilibrium: lift-off, pull-in, limit points, and bandages that have several. Critical voltages come
// from the reference, which maximises the voltage along the path instead of solving for it.
namespace {

using namespace gaiter;
using model::Status;
using reference::Expected;
using reference::Real;
using reference::Slice;

model::Scene cylinder(double stretch, std::vector<model::OgdenTerm> ogden) {
  model::Scene scene = paper::cylinder(39.6e-3, stretch);
  scene.leg.data_limit = 1e300;
  scene.bandage.ogden = std::move(ogden);
  scene.bandage.ogden.resize(2, {0, 2});
  return scene;
}

model::Scene on_soft_leg(model::Scene scene, double young, double ratio) {
  scene.leg.material = model::LegMaterial::neo_hookean;
  scene.leg.young_modulus = young;
  scene.leg.poisson_ratio = ratio;
  return scene;
}

model::Scene with_voltage(model::Scene scene, double voltage) {
  scene.bandage.modules[0].voltage = voltage;
  return scene;
}

std::string text(double value) {
  char buffer[32];
  std::snprintf(buffer, sizeof buffer, "%.17g", value);
  return buffer;
}

void check(const model::Scene& scene, bool stiffens, const std::string& what) {
  SCOPED_TRACE(what);
  const auto result = tasks::solve_one(scene);
  const Slice slice = reference::slice_of(scene, 0, 0.5);
  const Expected expected = reference::expectation(slice, stiffens, 3000);
  const double rest = static_cast<double>(expected.rest), actuated = static_cast<double>(expected.actuated);
  EXPECT_EQ(result.status, expected.status);
  EXPECT_NEAR(result.pressure_rest, rest, 1e-8 * rest);
  // A difference of P_m and P_a, whose rounding a small one keeps.
  EXPECT_NEAR(result.pressure_actuated, actuated, 1e-8 * actuated + 1e-13 * rest);
  if (!(slice.voltage > 0)) return;
  EXPECT_EQ(std::isnan(result.electric_field_max), expected.status == Status::pulled_in);
  if (expected.bandage_radius == 0) return;
  const double field =
      static_cast<double>(slice.voltage * reference::unit_field(slice.tube, expected.bandage_radius));
  EXPECT_NEAR(result.electric_field_max, field, 1e-8 * field);
}

// The voltage at which a bandage just touches the free leg.
double lift_off_voltage(const model::Scene& scene) {
  const Slice slice = reference::slice_of(scene, 0, 0.5);
  const Real radius = reference::leg_at<Real>(slice, 0).radius;
  return static_cast<double>(sqrt(reference::mechanical_pressure<Real>(slice.tube, radius) /
                                  reference::unit_actuation<Real>(slice.tube, radius)));
}

TEST(LiftOff, IsFoundOnBothSides) {
  for (const double stretch : {1.1, 1.4, 2.2}) {
    const model::Scene scene = cylinder(stretch, {{21.193e3, 3.507}, {10.514, 12.147}});
    const double critical = lift_off_voltage(scene);
    const auto below = tasks::solve_one(with_voltage(scene, critical * (1 - 1e-6)));
    const auto above = tasks::solve_one(with_voltage(scene, critical * (1 + 1e-6)));
    EXPECT_EQ(below.status, Status::contact);
    EXPECT_GT(below.pressure_actuated, 0);
    EXPECT_EQ(above.status, Status::lifted);
    EXPECT_EQ(above.pressure_actuated, 0);
    for (const double factor : {1 - 1e-6, 1 + 1e-6, 0.9, 1.1, 1.5, 3.0})
      check(with_voltage(scene, critical * factor), true, "stretch " + text(stretch) + " " + text(factor));
  }
}

// With alpha = 1 the voltage that a free tube can bear has its maximum near a stretch of sqrt(3).
TEST(PullIn, OfABandageThatFloatsComesAtItsLargestVoltage) {
  for (const double thickness : {1e-4, 1e-3, 5e-3}) {
    model::Scene scene = cylinder(1.3, {{20e3, 1}});
    scene.bandage.thickness = thickness;
    const Slice slice = reference::slice_of(scene, 0, 0.5);
    const Real start = reference::leg_at<Real>(slice, 0).radius;
    const auto peak = reference::largest_floating_voltage(slice.tube, start, 4 * start);
    ASSERT_GT(peak.parameter, 1.05 * start);
    const double critical = static_cast<double>(peak.voltage);
    ASSERT_GT(critical, 1.001 * lift_off_voltage(scene));
    const auto below = tasks::solve_one(with_voltage(scene, critical * (1 - 1e-6)));
    EXPECT_EQ(below.status, Status::lifted);
    EXPECT_FALSE(std::isnan(below.electric_field_max));
    const auto above = tasks::solve_one(with_voltage(scene, critical * (1 + 1e-6)));
    EXPECT_EQ(above.status, Status::pulled_in);
    EXPECT_EQ(above.pressure_actuated, 0);
    EXPECT_TRUE(std::isnan(above.electric_field_max));
    EXPECT_FALSE(std::isnan(above.pressure_rest));
    EXPECT_FALSE(std::isnan(above.radius_actuated));
  }
}

// Stretched beyond that maximum it is pulled in the moment it leaves the leg.
TEST(PullIn, FollowsLiftOffAtOnceBeyondTheMaximum) {
  const model::Scene scene = cylinder(3, {{20e3, 1}});
  const double critical = lift_off_voltage(scene);
  EXPECT_EQ(tasks::solve_one(with_voltage(scene, critical * (1 - 1e-6))).status, Status::contact);
  EXPECT_EQ(tasks::solve_one(with_voltage(scene, critical * (1 + 1e-6))).status, Status::pulled_in);
}

// The neo-Hookean tube approaches its largest voltage only as it becomes infinite (no maximum in plane
// strain).
TEST(PullIn, OfTheNeoHookeanTubeIsBeyondItsLimit) {
  const model::Scene scene = cylinder(1.3, {{20e3, 2}});
  const Slice slice = reference::slice_of(scene, 0, 0.5);
  const Real start = reference::leg_at<Real>(slice, 0).radius;
  const auto far = reference::largest_floating_voltage(slice.tube, start, 1000 * start);
  const double limit = static_cast<double>(far.voltage);
  EXPECT_EQ(tasks::solve_one(with_voltage(scene, 0.999 * limit)).status, Status::lifted);
  EXPECT_EQ(tasks::solve_one(with_voltage(scene, 1.001 * limit)).status, Status::pulled_in);
}

// On a soft leg the path can turn back before the bandage has left the leg.
TEST(LimitPoint, OnTheLegIsFoundOnBothSides) {
  int found = 0;
  for (const double young : {300.0, 600.0, 1000.0, 3000.0})
    for (const double alpha : {0.3, 1.0, 1.5})
      for (const double mu : {1e3, 3e3, 6e3, 1e4, 2e4, 4e4, 8e4}) {
        const model::Scene scene = on_soft_leg(cylinder(3.5, {{mu, alpha}}), young, 0.2);
        const Slice slice = reference::slice_of(scene, 0, 0.5);
        const Real high = reference::slack_parameter(slice);
        const auto rest = reference::first_change(slice, 0, 0, high, false, 1000);
        ASSERT_TRUE(rest);
        const auto peak = reference::largest_voltage(slice, *rest, 0);
        if (peak.parameter < 0.02 * *rest || peak.parameter > 0.98 * *rest) continue;
        ++found;
        const double critical = static_cast<double>(peak.voltage);
        const std::string what = "E " + text(young) + " alpha " + text(alpha) + " mu " + text(mu);
        SCOPED_TRACE(what);
        const auto below = tasks::solve_one(with_voltage(scene, critical * (1 - 1e-6)));
        const auto above = tasks::solve_one(with_voltage(scene, critical * (1 + 1e-6)));
        EXPECT_EQ(below.status, Status::contact);
        // The equilibrium near the turning point goes with the square root of the distance to it.
        const double turning = static_cast<double>(reference::leg_at<Real>(slice, peak.parameter).pressure);
        EXPECT_NEAR(below.pressure_actuated, turning, 0.05 * turning);
        EXPECT_LT(above.pressure_actuated, 0.9 * turning);
        for (const double factor : {0.3, 0.9, 1 - 1e-6, 1 + 1e-6, 1.2})
          check(with_voltage(scene, critical * factor), false, text(factor));
      }
  EXPECT_GT(found, 2);
}

// A soft leg in a tube with alpha < 2 can rest in contact at several radii. Let down on the leg, the bandage
// stops at the one of the least pressure.
TEST(SeveralEquilibria, TheFirstOneFromRestIsReported) {
  int found = 0;
  for (const double stretch : {6.0, 8.0})
    for (const double alpha : {0.3, 1.0})
      for (double mu = 0.5e6 / alpha; mu < 2e6 / alpha; mu *= 1.15) {
        const model::Scene scene = cylinder(stretch, {{mu, alpha}});
        const Slice slice = reference::slice_of(scene, 0, 0.5);
        const Real high = reference::slack_parameter(slice);
        const auto first = reference::first_change(slice, 0, 0, high, false, 600);
        const auto last = reference::first_change(slice, 0, high, 0, true, 600);
        ASSERT_TRUE(first && last);
        if (*last < 1.01 * *first) continue;
        ++found;
        check(scene, false, "stretch " + text(stretch) + " alpha " + text(alpha) + " mu " + text(mu));
        check(with_voltage(scene, 0.7 * lift_off_voltage(scene)), false, "under voltage, mu " + text(mu));
      }
  EXPECT_GT(found, 8);
}

TEST(Branches, OfRandomSofteningBandages) {
  samples::Sampler sampler(900);
  for (int i = 0; i < 60; ++i) {
    model::Scene scene = cylinder(1 + sampler.logarithmic(0.01, 5), {{sampler.logarithmic(1e3, 3e5), 0}});
    scene.bandage.ogden[0].alpha = sampler.uniform(0.1, 2);
    scene.bandage.thickness = sampler.logarithmic(1e-4, 3e-3);
    if (i % 2) scene = on_soft_leg(scene, sampler.logarithmic(300, 1e5), sampler.uniform(0, 0.45));
    const double critical = lift_off_voltage(scene);
    check(with_voltage(scene, critical * sampler.uniform(0.2, 1.3)), false, "sample " + std::to_string(i));
  }
}

// The search along the path is made only where Newton's method met a flat equation: it must not be missed.
TEST(Branches, OfRandomStiffeningBandagesUnderVoltage) {
  samples::Sampler sampler(901);
  for (int i = 0; i < 60; ++i) {
    model::Scene scene = cylinder(1 + sampler.logarithmic(0.01, 5), {{sampler.logarithmic(1e3, 1e5), 0}});
    scene.bandage.ogden[0].alpha = sampler.uniform(2, 6);
    scene.bandage.thickness = sampler.logarithmic(1e-4, 3e-3);
    if (i % 2) scene = on_soft_leg(scene, sampler.logarithmic(300, 1e5), sampler.uniform(0, 0.45));
    const double critical = lift_off_voltage(scene);
    check(with_voltage(scene, critical * sampler.uniform(0.5, 1.3)), true, "sample " + std::to_string(i));
  }
}

// A voltage that changes nothing must not lift the bandage, whatever rounding or a loose tolerance left of
// the state at rest.
TEST(Branches, VoltagesLostInRoundingLeaveTheStateAtRest) {
  for (const char* tolerance : {"1e-12", "1e-3"}) {
    const tasks::Option option("-slice_snes_rtol", tolerance);
    for (const double alpha : {1.0, 1.5, 3.5})
      for (double voltage = 1e-9; voltage < 100; voltage *= 3) {
        SCOPED_TRACE("alpha " + text(alpha) + " " + text(voltage) + " V, tolerance " + tolerance);
        const auto result = tasks::solve_one(with_voltage(cylinder(1.6, {{20e3, alpha}}), voltage));
        EXPECT_EQ(result.status, Status::contact);
        // 100 V take 3e-5 of the pressure.
        EXPECT_NEAR(result.pressure_actuated, result.pressure_rest,
                    (1e-4 + 2 * std::stod(tolerance)) * result.pressure_rest);
      }
  }
}

TEST(ContactInterval, HoldsTheFirstRootOfEachDirection) {
  int several = 0;
  for (double mu = 2e6; mu < 8e6; mu *= 1.1) {
    const model::Scene scene = cylinder(6, {{mu, 0.3}});
    auto system = samples::system_of({scene}, 12);
    system.energise(false);
    const Slice slice = reference::slice_of(scene, 0, 0.5);
    const Real high = reference::slack_parameter(slice);
    const double scale = system.constant(0, physics::SliceShape::pressure_scale);
    const double highest = system.constant(0, physics::SliceShape::pressure_limit);
    const auto first = reference::first_change(slice, 0, 0, high, false, 1000);
    const auto last = reference::first_change(slice, 0, high, 0, true, 1000);
    ASSERT_TRUE(first && last);
    const auto up = physics::contact_interval(system, 0, highest, true);
    const auto down = physics::contact_interval(system, 0, highest, false);
    ASSERT_TRUE(up && down);
    EXPECT_LE(up->from * scale, static_cast<double>(*first) * (1 + 1e-12));
    EXPECT_GE(up->to * scale, static_cast<double>(*first) * (1 - 1e-12));
    EXPECT_GE(down->from * scale, static_cast<double>(*last) * (1 - 1e-12));
    EXPECT_LE(down->to * scale, static_cast<double>(*last) * (1 + 1e-12));
    if (*last > 1.01 * *first) ++several;
  }
  EXPECT_GT(several, 3);
}

TEST(ContactInterval, IsNoneWithoutContact) {
  const model::Scene slack = cylinder(0.9, {{20e3, 1}});
  auto system = samples::system_of({slack}, 6);
  system.energise(false);
  EXPECT_FALSE(physics::contact_interval(system, 0, 1, true));
  const model::Scene lifted = with_voltage(cylinder(1.4, {{20e3, 3}}), 40e3);
  EXPECT_FALSE(physics::contact_interval(samples::system_of({lifted}, 6), 0, 0.1, false));
}

TEST(FloatingStrain, IsWhereFieldAndBandageBalance) {
  for (const double factor : {1.0001, 1.05, 1.1}) {
    const model::Scene scene = cylinder(1.3, {{20e3, 1}});
    const Slice slice = reference::slice_of(scene, 0, 0.5);
    const Real start = reference::leg_at<Real>(slice, 0).radius;
    const double voltage = factor * lift_off_voltage(scene);
    const auto system = samples::system_of({with_voltage(scene, voltage)}, 8);
    const double strain = static_cast<double>(1 - start / slice.leg_radius);
    const auto floating = physics::floating_strain(system, 0, strain);
    const auto expected = reference::floating_radius(slice.tube, voltage, start);
    ASSERT_EQ(floating.has_value(), expected.has_value());
    if (!expected) continue;
    const double radius = static_cast<double>(*expected / slice.leg_radius);
    EXPECT_NEAR(1 - *floating, radius, 1e-11) << factor;
  }
}

// Of many slices at once, from far below the voltage at which the bandage expands without end to beyond it.
TEST(FloatingStrain, OfAPackIsThatOfTheSearch) {
  std::vector<model::Scene> scenes;
  std::vector<double> starts;
  for (const bool stiff : {false, true})
    for (int k = 0; k < 32; ++k) {
      const double stretch = k % 2 == 0 ? 1.1 : 1.8;
      const model::Scene scene = stiff ? cylinder(stretch, {{21.193e3, 3.507}, {10.514, 12.147}})
                                       : cylinder(stretch, {{20e3, 2}, {10, 2.5}});
      const Slice slice = reference::slice_of(scene, 0, 0.5);
      starts.push_back(static_cast<double>(1 - reference::leg_at<Real>(slice, 0).radius / slice.leg_radius));
      scenes.push_back(with_voltage(scene, (1 + std::pow(10, -12 + 0.4 * k)) * lift_off_voltage(scene)));
    }
  const auto system = samples::system_of(scenes, 8);
  ASSERT_EQ(starts.size(), static_cast<std::size_t>(physics::pack_width));
  physics::Pack start, strain, found;
  for (int i = 0; i < physics::pack_width; ++i) start[i] = starts[i];
  physics::floating_strains(system.shape(), system.pack(0), start, strain, found);
  int together = 0, alone = 0;
  for (int i = 0; i < physics::pack_width; ++i) {
    const auto expected = physics::floating_strain(system, i, starts[i]);
    alone += expected.has_value();
    if (!(found[i] > 0)) continue;
    ++together;
    ASSERT_TRUE(expected.has_value()) << i;
    EXPECT_NEAR(strain[i], *expected, 1e-14) << i;
  }
  EXPECT_GT(together, 0.8 * alone) << alone;
  EXPECT_LT(alone, physics::pack_width);
}

}  // namespace
