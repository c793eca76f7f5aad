// SPDX-License-Identifier: BSD-2-Clause
// The slices' and sliding slices' distance from the finite elements: estimated, and from solving these.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "gaiter/petsc/session.hpp"
#include "gaiter/solvers/axisym_model.hpp"
#include "gaiter/solvers/residual_estimate.hpp"
#include "gaiter/solvers/sliding_model.hpp"
#include "paper_scene.hpp"

namespace {

using namespace gaiter;
using paper::cone;

struct Compared {
  solvers::ResidualEstimate estimated;
  double pressure_rest = 0, actuation_drop = 0, volume_change = 0;  // true errors, relative
};

Compared compare(const model::Scene& scene, model::Fidelity fidelity) {
  const solvers::SegmentTask task{&scene, 0};
  const model::SegmentResult own = fidelity == model::Fidelity::slice
                                       ? solvers::solve_segments(PETSC_COMM_SELF, {&task, 1})[0]
                                       : solvers::solve_sliding(task).result;
  const model::SegmentResult exact = solvers::solve_axisym(PETSC_COMM_SELF, {&task, 1})[0];
  EXPECT_TRUE(model::trustworthy(exact.status));
  Compared compared{.estimated = solvers::estimate_by_residual(task, own, fidelity)};
  compared.pressure_rest = own.pressure_rest / exact.pressure_rest - 1;
  compared.actuation_drop = own.actuation_drop / exact.actuation_drop - 1;
  compared.volume_change = own.volume_change / exact.volume_change - 1;
  return compared;
}

void expect_ratio(double estimate, double error, double low, double high, double degrees, double stretch) {
  EXPECT_GT(estimate / error, low) << degrees << " degrees, stretch " << stretch << ", error " << error;
  EXPECT_LT(estimate / error, high) << degrees << " degrees, stretch " << stretch << ", error " << error;
}

// Errors of 2e-4 to 0.17, of either sign. The ends of steep cones at small stretch lift off over several
// millimetres, more than a step of Newton's method sees.
TEST(Slices, ErrorIsFoundWithoutSolvingTheFiniteElements) {
  for (double degrees : {2.0, 5.0, 10.0, 15.0, 20.0})
    for (double stretch : {1.05, 1.1, 1.4, 1.8, 2.0, 2.1}) {
      const Compared compared = compare(cone(degrees, stretch), model::Fidelity::slice);
      // Further away than 4 % a whole step may end in an inverted element.
      if (stretch < 2) {
        EXPECT_TRUE(compared.estimated.reliable);
      }
      const bool steep = degrees > 12;
      expect_ratio(compared.estimated.pressure_rest, compared.pressure_rest, steep ? 0.75 : 0.9,
                   steep ? 1.2 : 1.1, degrees, stretch);
    }
}

// Errors to 0.03 of the sliding slices. Below a stretch of 1.4 it is the lift-off again, and an error that
// changes sign between 10 and 20 degrees.
TEST(SlidingSlices, ErrorIsFoundWithoutSolvingTheFiniteElements) {
  for (double degrees : {2.0, 5.0, 10.0, 15.0, 20.0})
    for (double stretch : {1.4, 1.8, 2.0, 2.1}) {
      const Compared compared = compare(cone(degrees, stretch), model::Fidelity::sliding);
      EXPECT_TRUE(compared.estimated.reliable);
      expect_ratio(compared.estimated.pressure_rest, compared.pressure_rest, 0.95, 1.25, degrees, stretch);
    }
}

TEST(Estimates, WithTheirSpreadCoverTheErrors) {
  for (double degrees : {5.0, 10.0, 20.0})
    for (double stretch : {1.05, 1.2, 1.8})
      for (auto fidelity : {model::Fidelity::slice, model::Fidelity::sliding}) {
        const Compared compared = compare(cone(degrees, stretch, 4e3), fidelity);
        const double error = std::max({std::fabs(compared.pressure_rest), std::fabs(compared.actuation_drop),
                                       std::fabs(compared.volume_change)});
        EXPECT_GT(compared.estimated.largest() + compared.estimated.spread, error)
            << degrees << " degrees, stretch " << stretch;
      }
}

// Up to 0.3 of the drop: the slices do not see the bandage slide further under voltage.
TEST(Slices, ErrorOfTheActuationDrop) {
  for (double degrees : {2.0, 5.0, 10.0, 20.0})
    for (double stretch : {1.4, 1.8, 2.0}) {
      const Compared compared = compare(cone(degrees, stretch, 4e3), model::Fidelity::slice);
      if (stretch < 2) {
        EXPECT_TRUE(compared.estimated.reliable);
      }
      expect_ratio(compared.estimated.actuation_drop, compared.actuation_drop, 0.75, 1.2, degrees, stretch);
    }
}

TEST(Cylinder, HasNoModelError) {
  for (double voltage : {0.0, 4e3}) {
    const Compared compared = compare(cone(0, 1.8, voltage), model::Fidelity::slice);
    EXPECT_TRUE(compared.estimated.reliable);
    EXPECT_LT(compared.estimated.largest(), voltage > 0 ? 1e-4 : 1e-6);
    EXPECT_LT(compared.estimated.spread, 1e-6);
  }
}

// Here the finite elements have no stable state, and the way to it says so.
TEST(Estimates, AreNotReliableBeyondTheFold) {
  const model::Scene scene = cone(20, 2.2);
  const solvers::SegmentTask task{&scene, 0};
  ASSERT_EQ(solvers::solve_axisym(PETSC_COMM_SELF, {&task, 1})[0].status, model::Status::no_equilibrium);
  const auto slices = solvers::solve_segments(PETSC_COMM_SELF, {&task, 1})[0];
  ASSERT_TRUE(model::trustworthy(slices.status));
  EXPECT_FALSE(solvers::estimate_by_residual(task, slices, model::Fidelity::slice).reliable);
}

TEST(Estimates, SayNothingOfASlackBandage) {
  const model::Scene scene = cone(5, 0.9);
  const solvers::SegmentTask task{&scene, 0};
  const auto slices = solvers::solve_segments(PETSC_COMM_SELF, {&task, 1})[0];
  const solvers::ResidualEstimate error = solvers::estimate_by_residual(task, slices, model::Fidelity::slice);
  EXPECT_FALSE(error.reliable);
  EXPECT_TRUE(std::isnan(error.largest()));
}

}  // namespace
