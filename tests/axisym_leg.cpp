// SPDX-License-Identifier: BSD-2-Clause
// The whole leg as one body against its segments by themselves, on any number of ranks that share the mesh;
// and how few steps the start of the finite elements leaves to Newton's method.
#include <gtest/gtest.h>

#include <cmath>

#include "gaiter/petsc/session.hpp"
#include "gaiter/solvers/axisym_model.hpp"
#include "paper_scene.hpp"

namespace {

using namespace gaiter;

std::vector<model::SegmentResult> solve(const model::Scene& scene) {
  std::vector<solvers::SegmentTask> tasks;
  for (std::size_t s = 0; s < scene.leg.segments.size(); ++s) tasks.push_back({&scene, s});
  return solvers::solve_axisym(PETSC_COMM_WORLD, tasks);
}

model::Scene paper_leg(double stretch, model::AxisymScope scope) {
  model::Scene scene = paper::scene(stretch, 0);
  scene.fidelity = model::Fidelity::axisym;
  scene.leg.variant = model::ComplianceVariant::anchored;
  scene.axisym.scope = scope;
  return scene;
}

// Three equal pieces of one cylinder.
model::Scene cylinder_leg(double stretch) {
  model::Scene scene = paper_leg(stretch, model::AxisymScope::leg);
  scene.leg.segments.resize(3, scene.leg.segments[0]);
  scene.bandage.modules.resize(3);
  for (auto& segment : scene.leg.segments) {
    segment = scene.leg.segments[0];
    segment.lower_radius = segment.upper_radius = 39.6e-3;
  }
  return scene;
}

TEST(Leg, OfEqualCylindersIsEachOfThem) {
  for (auto side : {model::ContactSide::tube, model::ContactSide::leg}) {
    model::Scene scene = cylinder_leg(1.8);
    scene.axisym.multipliers = side;
    const auto whole = solve(scene);
    scene.axisym.scope = model::AxisymScope::segment;
    const auto alone = solve(scene);
    ASSERT_EQ(whole.size(), 3u);
    for (std::size_t s = 0; s < 3; ++s) {
      EXPECT_EQ(whole[s].status, model::Status::contact);
      EXPECT_NEAR(whole[s].pressure_rest, alone[s].pressure_rest, 1e-6 * alone[s].pressure_rest);
      EXPECT_NEAR(whole[s].pressure_rest_area_mean, alone[s].pressure_rest, 1e-6 * alone[s].pressure_rest);
      EXPECT_NEAR(whole[s].volume_rest, alone[s].volume_rest, 1e-6 * alone[s].volume_rest);
      EXPECT_NEAR(whole[s].stretch_actual, alone[s].stretch_actual, 1e-6);
      EXPECT_LT(whole[s].slip_max, 1e-9);
    }
  }
}

// One module wide open between two that press: it stays open, and the others hardly notice, although the
// leg below it is pushed out.
TEST(Leg, HoldsASlackModuleBetweenOthers) {
  model::Scene scene = cylinder_leg(1.4);
  scene.bandage.modules[1].stretch = 0.9;
  const auto result = solve(scene);
  EXPECT_EQ(result[1].status, model::Status::slack);
  EXPECT_EQ(result[1].pressure_rest, 0);
  for (std::size_t s : {0, 2}) {
    model::Scene one = scene;
    one.axisym.scope = model::AxisymScope::segment;
    const solvers::SegmentTask task{&one, s};
    const double alone = solvers::solve_axisym(PETSC_COMM_WORLD, {&task, 1})[0].pressure_rest;
    EXPECT_EQ(result[s].status, model::Status::contact);
    EXPECT_NEAR(result[s].pressure_rest, alone, 0.03 * alone);
    EXPECT_NE(result[s].pressure_rest, alone);
  }
  EXPECT_NEAR(result[0].pressure_rest, result[2].pressure_rest, 1e-5 * result[0].pressure_rest);
}

TEST(Leg, OfThePaperAgreesWithItsSegments) {
  const auto whole = solve(paper_leg(1.4, model::AxisymScope::leg));
  const auto alone = solve(paper_leg(1.4, model::AxisymScope::segment));
  for (std::size_t s = 0; s < 6; ++s) {
    EXPECT_EQ(whole[s].status, model::Status::contact);
    // The leg moves axially across the segments' ends, up to 1.2 % of the pressure.
    EXPECT_NEAR(whole[s].pressure_rest, alone[s].pressure_rest, 0.013 * alone[s].pressure_rest);
    EXPECT_LT(whole[s].discretisation_error, 5e-4);
    EXPECT_EQ(whole[s].iterations, whole[0].iterations);
    EXPECT_LE(whole[s].iterations, 15);
  }
}

// Steps of a start that knows slip and open end, on four meshes; from plain slices it takes 15 at
// stretch 1.2.
TEST(Start, LeavesFewSteps) {
  for (double stretch : {1.2, 1.4, 1.8, 2.2}) {
    model::Scene scene = paper_leg(stretch, model::AxisymScope::segment);
    scene.leg.segments.resize(1);
    scene.bandage.modules.resize(1);
    for (int refine : {0, 1, 2, 3}) {
      scene.axisym.refine = refine;
      const auto result = solve(scene)[0];
      EXPECT_EQ(result.status, model::Status::contact);
      EXPECT_LE(result.iterations, 8) << "stretch " << stretch << ", refined " << refine;
    }
  }
}

TEST(Start, ReachesFiniteBulkModuli) {
  model::Scene scene = paper_leg(2.2, model::AxisymScope::segment);
  scene.leg.segments.resize(1);
  scene.bandage.modules.resize(1);
  double last = INFINITY;
  for (double modulus : {double(INFINITY), 37e6, 3.7e6}) {
    scene.bandage.bulk_modulus = modulus;
    const auto result = solve(scene)[0];
    EXPECT_EQ(result.status, model::Status::contact);
    EXPECT_LE(result.iterations, 8);
    EXPECT_LT(result.pressure_rest, last);  // a tube that thins under its own stress presses less
    last = result.pressure_rest;
  }
}

}  // namespace
