// SPDX-License-Identifier: BSD-2-Clause
// The axisymmetric model against CalculiX's and exact values (the project's reference values), on any number
// of ranks that share the mesh.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "gaiter/petsc/session.hpp"
#include "gaiter/solvers/axisym_case.hpp"
#include "gaiter/solvers/axisym_model.hpp"
#include "paper_scene.hpp"

namespace {

using namespace gaiter;

// Neo-Hookean leg, E = 80 kPa, nu = 0.4, and the surrogate elastomer, 35 mm high.
model::Scene case_of(double lower_radius, double upper_radius, double stretch, double bulk_modulus) {
  model::Scene scene = paper::cylinder(lower_radius, stretch);
  scene.leg.segments[0].upper_radius = upper_radius;
  scene.leg.material = model::LegMaterial::neo_hookean;
  scene.bandage.bulk_modulus = bulk_modulus;
  scene.fidelity = model::Fidelity::axisym;
  return scene;
}

model::SegmentResult solve(const model::Scene& scene) {
  const solvers::SegmentTask task{&scene, 0};
  return solvers::solve_axisym(PETSC_COMM_WORLD, {&task, 1})[0];
}

TEST(Cylinder, EqualsTheExactPressFit) {
  struct Exact {
    double bulk_modulus, pressure;  // [Pa]
  };
  // The digits given: half a unit of the last.
  for (const Exact& exact : {Exact{INFINITY, 6091.27}, Exact{37e6, 6034.64}, Exact{370e6, 6085.49}}) {
    const auto result = solve(case_of(39.6e-3, 39.6e-3, 2.2, exact.bulk_modulus));
    EXPECT_EQ(result.status, model::Status::contact);
    EXPECT_NEAR(result.pressure_rest, exact.pressure, 0.01);
    EXPECT_NEAR(result.pressure_rest_area_mean, exact.pressure, 0.01);
    EXPECT_LE(result.iterations, 5);
    EXPECT_LT(result.slip_max, 1e-9);
  }
  EXPECT_NEAR(solve(case_of(39.6e-3, 39.6e-3, 2.2, INFINITY)).volume_rest, 165112.6e-9, 0.1e-9);
}

TEST(Cylinder, OfANearlyRigidLeg) {
  model::Scene scene = case_of(39.6e-3, 39.6e-3, 2.2, 37e6);
  scene.leg.young_modulus = 80e6;
  EXPECT_NEAR(solve(scene).pressure_rest, 6642.30, 0.01);
}

TEST(Cylinder, OfTheComplianceMaterialEqualsTheSlice) {
  for (double voltage : {0.0, 5e3}) {
    model::Scene scene = paper::cylinder(39.6e-3, 1.8, voltage);
    scene.leg.variant = model::ComplianceVariant::anchored;
    const solvers::SegmentTask task{&scene, 0};
    const auto slice = solvers::solve_segments(PETSC_COMM_SELF, {&task, 1})[0];
    const auto result = solve(scene);
    // The mesh resolves the smooth fields of a cylinder to better than this.
    EXPECT_NEAR(result.pressure_rest, slice.pressure_rest, 1e-5 * slice.pressure_rest);
    EXPECT_NEAR(result.pressure_actuated, slice.pressure_actuated, 1e-5 * slice.pressure_actuated);
    EXPECT_NEAR(result.volume_actuated, slice.volume_actuated, 1e-6 * slice.volume_actuated);
  }
}

TEST(Cone, AgreesWithCalculiX) {
  struct Reference {
    double bulk_modulus, pressure, volume;  // [Pa, Pa, m3]
  };
  for (const Reference& reference :
       {Reference{37e6, 1219.6, 171381.3e-9}, Reference{370e6, 1220.8, 171379.8e-9}})
    for (auto side : {model::ContactSide::tube, model::ContactSide::leg}) {
      model::Scene scene = case_of(36.1e-3, 43.1e-3, 1.4, reference.bulk_modulus);
      scene.axisym.multipliers = side;
      const auto result = solve(scene);
      EXPECT_EQ(result.status, model::Status::contact);
      // 0.1 % as asked; CalculiX itself is 0.03 to 0.05 % low.
      EXPECT_NEAR(result.pressure_rest_area_mean, reference.pressure, 1e-3 * reference.pressure);
      EXPECT_NEAR(result.volume_rest, reference.volume, 5e-5 * reference.volume);
      EXPECT_NEAR(result.slip_max, 0.40e-3, 0.02e-3);
    }
}

// Change of the leg's radius at mid-height.
TEST(Leg, GivesWayAtMidHeightAsInCalculiX) {
  struct Reference {
    double lower_radius, upper_radius, stretch, bulk_modulus, displacement;  // [m, m, 1, Pa, m]
  };
  for (const Reference& reference : {Reference{39.6e-3, 39.6e-3, 2.2, 37e6, -0.84087e-3},
                                     Reference{39.6e-3, 39.6e-3, 2.2, 370e6, -0.84799e-3},
                                     Reference{36.1e-3, 43.1e-3, 1.4, 37e6, -0.16502e-3},
                                     Reference{36.1e-3, 43.1e-3, 1.4, 370e6, -0.16519e-3}}) {
    const model::Scene scene =
        case_of(reference.lower_radius, reference.upper_radius, reference.stretch, reference.bulk_modulus);
    solvers::AxisymCase<2> problem(PETSC_COMM_WORLD, scene, 0, 0, 1);
    ASSERT_TRUE(problem.rest()[0].converged);
    const auto& space = problem.system().space();
    const auto& skin = space.leg.nodes;
    // At the height in space, to which the material of a cone has moved from a little below; between two
    // nodes the skin is straight enough.
    const auto& leg = problem.system().leg();
    const double height = 0.5 * skin.back().height;
    const std::size_t above = std::ranges::upper_bound(leg.height, height) - leg.height.begin();
    const double place = (height - leg.height[above - 1]) / (leg.height[above] - leg.height[above - 1]);
    const double radius = (1 - place) * leg.radius[above - 1] + place * leg.radius[above];
    const double moved = radius * space.mesh.length - 0.5 * (reference.lower_radius + reference.upper_radius);
    EXPECT_NEAR(moved, reference.displacement, 1e-3 * std::fabs(reference.displacement));
  }
}

TEST(Cone, SteepOnesConvergeOnEveryMesh) {
  model::Scene scene = paper::scene(2.2, 0);
  scene.leg.variant = model::ComplianceVariant::anchored;
  double pressure = 0;
  for (int refine : {0, 1, 2}) {
    scene.axisym.refine = refine;
    const auto result = solve(scene);
    ASSERT_TRUE(model::trustworthy(result.status));
    EXPECT_LE(result.iterations, 15);
    if (refine > 0) {
      EXPECT_NEAR(result.pressure_rest, pressure, 1e-4 * pressure);
    }
    pressure = result.pressure_rest;
  }
}

TEST(Cone, ErrorEstimateDoesNotDependOnTheRanks) {
  model::Scene scene = paper::scene(1.4, 6e3);
  scene.leg.variant = model::ComplianceVariant::anchored;
  const solvers::SegmentTask task{&scene, 0};
  for (int refine : {0, 1}) {
    scene.axisym.refine = refine;
    const double alone = solvers::solve_axisym(PETSC_COMM_SELF, {&task, 1})[0].error_estimate;
    const double shared = solvers::solve_axisym(PETSC_COMM_WORLD, {&task, 1})[0].error_estimate;
    EXPECT_GT(alone, 0);
    EXPECT_NEAR(shared, alone, 1e-9 + 1e-6 * alone);
  }
}

TEST(Cone, OrdersAgree) {
  model::Scene scene = paper::scene(1.8, 0);
  scene.leg.variant = model::ComplianceVariant::anchored;
  const double second = solve(scene).pressure_rest;
  for (int order : {3, 4}) {
    scene.axisym.order = order;
    scene.axisym.refine = 0;
    EXPECT_NEAR(solve(scene).pressure_rest, second, 1e-4 * second) << "order " << order;
  }
}

TEST(Cone, HeldEqualsTheSlicesButForTheTaper) {
  model::Scene scene = paper::scene(2.2, 0);
  scene.leg.variant = model::ComplianceVariant::anchored;
  const solvers::SegmentTask task{&scene, 0};
  const double slices = solvers::solve_segments(PETSC_COMM_SELF, {&task, 1})[0].pressure_rest;
  scene.contact_axial = model::ContactAxial::held;
  EXPECT_NEAR(solve(scene).pressure_rest, slices, 0.03 * slices);
}

}  // namespace
