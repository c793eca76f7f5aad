// SPDX-License-Identifier: BSD-2-Clause
// Errors of the finite elements' outputs from dual solutions: against derivatives by finite difference,
// against Newton's method, and against the errors themselves.
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "gaiter/petsc/check.hpp"
#include "gaiter/petsc/session.hpp"
#include "gaiter/solvers/axisym_dual.hpp"
#include "gaiter/solvers/axisym_enriched.hpp"
#include "gaiter/solvers/axisym_model.hpp"
#include "gaiter/solvers/axisym_prolong.hpp"
#include "paper_scene.hpp"

namespace {

using namespace gaiter;
using solvers::AxisymOutput;

model::Scene cone(double degrees, double stretch, double voltage = 0) {
  model::Scene scene = paper::cone(degrees, stretch, voltage);
  scene.fidelity = model::Fidelity::axisym;
  return scene;
}

template <int P>
double output(const solvers::AxisymCase<P>& problem, const model::Scene& scene, AxisymOutput which) {
  const solvers::AxisymSummary summary = solvers::summarise_axisym<P>(scene, 0, problem.system(), 0, false);
  return which == AxisymOutput::pressure ? summary.pressure : summary.volume;
}

void fill_randomly(Vec x, double size) {
  std::mt19937 generator(5);
  std::uniform_real_distribution<double> uniform(-size, size);
  PetscInt count = 0;
  PetscScalar* values = nullptr;
  petsc::check(VecGetLocalSize(x, &count));
  petsc::check(VecGetArray(x, &values));
  for (PetscInt i = 0; i < count; ++i) values[i] = uniform(generator);
  petsc::check(VecRestoreArray(x, &values));
}

template <int P>
void expect_derivatives(model::Scene scene) {
  solvers::AxisymCase<P> problem(PETSC_COMM_SELF, scene, 0, 0, 0);
  ASSERT_TRUE(problem.rest()[0].converged);
  petsc::Vector direction, gradient, residual, trial;
  for (petsc::Vector* vector : {&direction, &gradient, &residual, &trial})
    petsc::check(VecDuplicate(problem.state(), vector->out()));
  fill_randomly(direction.get(), 1);
  const double step = 1e-6;
  for (AxisymOutput which : {AxisymOutput::pressure, AxisymOutput::volume}) {
    PetscScalar slope = 0;
    bool admissible = true;
    petsc::check(problem.system().evaluate(problem.state(), residual.get(), admissible));
    petsc::check(solvers::differentiate_output(problem.system(), 0, which, gradient.get()));
    petsc::check(VecDot(gradient.get(), direction.get(), &slope));
    double difference = 0;
    for (double sign : {1.0, -1.0}) {
      petsc::check(VecWAXPY(trial.get(), sign * step, direction.get(), problem.state()));
      petsc::check(problem.system().evaluate(trial.get(), residual.get(), admissible));
      ASSERT_TRUE(admissible);
      difference += sign * output(problem, scene, which) / (2 * step);
    }
    EXPECT_NEAR(slope, difference, 1e-7 * std::fabs(difference));
  }
}

TEST(Outputs, DerivativesEqualFiniteDifferences) {
  for (auto side : {model::ContactSide::tube, model::ContactSide::leg}) {
    model::Scene scene = cone(10, 1.4);
    scene.axisym.multipliers = side;
    expect_derivatives<2>(scene);
    expect_derivatives<3>(scene);
  }
}

// A state on a finer mesh, or at a higher order, is the same state.
template <int P, int Q>
void expect_same(const model::Scene& scene, bool actuated, int refinements) {
  solvers::AxisymCase<P> coarse(PETSC_COMM_SELF, scene, 0, 0, 0);
  ASSERT_TRUE(coarse.rest()[0].converged);
  if (actuated) {
    ASSERT_TRUE(coarse.actuated()[0].converged);
  }
  solvers::AxisymCase<Q> fine(PETSC_COMM_SELF, scene, 0, 0, refinements);
  fine.system().energise(actuated);
  petsc::check(solvers::prolongate<P, Q>(coarse.system(), coarse.state(), fine.system(), fine.state()));
  petsc::Vector residual;
  bool admissible = false;
  petsc::check(VecDuplicate(fine.state(), residual.out()));
  petsc::check(fine.system().evaluate(fine.state(), residual.get(), admissible));
  ASSERT_TRUE(admissible);
  for (AxisymOutput which : {AxisymOutput::pressure, AxisymOutput::volume})
    EXPECT_NEAR(output(fine, scene, which), output(coarse, scene, which),
                1e-13 * output(coarse, scene, which));
  // Integrals by more points are as much closer to the exact ones as the elements' own are.
  EXPECT_NEAR(fine.system().energy(), coarse.system().energy(), 1e-4 * std::fabs(coarse.system().energy()));
}

TEST(Prolongation, KeepsTheState) {
  const model::Scene scene = cone(10, 1.4, 5e3);
  for (bool actuated : {false, true}) {
    expect_same<2, 2>(scene, actuated, 1);
    expect_same<2, 2>(scene, actuated, 2);
    expect_same<2, 3>(scene, actuated, 0);
    expect_same<3, 4>(scene, actuated, 1);
  }
}

// To first order what the dual says of an output is what a step of Newton's method changes it by.
TEST(Dual, EqualsTheChangeAlongNewtonsStep) {
  const model::Scene scene = cone(5, 1.8);
  solvers::AxisymCase<2> coarse(PETSC_COMM_SELF, scene, 0, 0, 0), fine(PETSC_COMM_SELF, scene, 0, 0, 1);
  ASSERT_TRUE(coarse.rest()[0].converged);
  petsc::check(solvers::prolongate<2, 2>(coarse.system(), coarse.state(), fine.system(), fine.state()));
  solvers::AxisymDual<2> dual(fine.system(), fine.solver());
  petsc::Vector step, gradient;
  for (petsc::Vector* vector : {&step, &gradient}) petsc::check(VecDuplicate(fine.state(), vector->out()));
  for (AxisymOutput which : {AxisymOutput::pressure, AxisymOutput::volume}) {
    ASSERT_TRUE(dual.linearise(fine.state()));
    petsc::check(solvers::differentiate_output(fine.system(), 0, which, gradient.get()));
    const double expected = dual.error(0, which);
    petsc::check(VecCopy(fine.state(), step.get()));
    ASSERT_TRUE(dual.advance(fine.state()));
    petsc::check(VecAYPX(step.get(), -1, fine.state()));
    PetscScalar change = 0;
    petsc::check(VecDot(gradient.get(), step.get(), &change));
    EXPECT_NE(change, 0);
    EXPECT_NEAR(change, expected, 1e-7 * std::fabs(change));
  }
}

// Where the contacts stay as they are, one linear solution on the finer mesh tells what a solve there would.
TEST(Dual, TellsWhatTheFinerMeshWouldSay) {
  const model::Scene scene = cone(15, 1.1);
  solvers::AxisymCase<2> coarse(PETSC_COMM_SELF, scene, 0, 0, 0), fine(PETSC_COMM_SELF, scene, 0, 0, 1);
  const double pressure = coarse.rest()[0].pressure;
  const auto expected = solvers::expected_changes(coarse, fine);
  ASSERT_EQ(expected.size(), 1u);
  const double change = fine.rest()[0].pressure - pressure;
  EXPECT_GT(std::fabs(change), 1e-4 * pressure);
  EXPECT_NEAR(expected[0].pressure, change, 0.1 * std::fabs(change));
}

template <int P>
void expect_effective(double degrees, double stretch, double voltage, double low, double high) {
  const model::Scene scene = cone(degrees, stretch, voltage);
  solvers::AxisymCase<3> truth(PETSC_COMM_SELF, scene, 0, 0, 2);
  solvers::AxisymCase<P> solved(PETSC_COMM_SELF, scene, 0, 0, 0), finer(PETSC_COMM_SELF, scene, 0, 0, 1);
  for (bool actuated : {false, true}) {
    if (actuated && voltage == 0) continue;
    const auto exact = (actuated ? truth.actuated() : truth.rest())[0],
               summary = (actuated ? solved.actuated() : solved.rest())[0];
    ASSERT_TRUE(exact.converged && summary.converged);
    const auto changes = solvers::expected_changes(solved, finer);
    ASSERT_EQ(changes.size(), 1u);
    const double effectivity = changes[0].pressure / (exact.pressure - summary.pressure);
    EXPECT_GT(effectivity, low) << degrees << " degrees, stretch " << stretch << ", order " << P;
    EXPECT_LT(effectivity, high) << degrees << " degrees, stretch " << stretch << ", order " << P;
  }
}

// Errors of 1e-6 to 1e-4. Where the end lifts off near a vertex (most of the other cases of this range), the
// finer mesh's own error counts as well, and the effectivity is anything from 0.37 up: see expected_changes.
TEST(Effectivity, OfTheMeanPressureIsNearOne) {
  expect_effective<2>(5, 1.1, 6e3, 0.8, 1.4);
  expect_effective<2>(5, 1.4, 6e3, 0.8, 1.4);
  expect_effective<3>(5, 1.1, 6e3, 0.8, 1.4);
  expect_effective<3>(5, 1.4, 6e3, 0.8, 1.4);
  expect_effective<2>(20, 1.4, 0, 0.5, 2);
}

// Newton's method starts on a finer mesh from the coarser one's state. From the sliding slices' it has to
// move the lift-off of a steep cone vertex by vertex, in more steps the finer the mesh.
TEST(CoarserMesh, HasAllButFoundTheState) {
  model::Scene scene = cone(20, 1.1);
  for (int refine : {1, 2}) {
    solvers::AxisymCase<2> coarser(PETSC_COMM_SELF, scene, 0, 0, refine - 1),
        finer(PETSC_COMM_SELF, scene, 0, 0, refine), alone(PETSC_COMM_SELF, scene, 0, 0, refine);
    ASSERT_TRUE(coarser.rest()[0].converged);
    const auto from_coarser = finer.rest(coarser)[0], from_slices = alone.rest()[0];
    ASSERT_TRUE(from_coarser.converged && from_slices.converged);
    EXPECT_NEAR(from_coarser.pressure, from_slices.pressure, 1e-9 * from_slices.pressure);
    EXPECT_LE(from_coarser.iterations, 6);
    EXPECT_LT(from_coarser.iterations, from_slices.iterations);
  }
  scene = cone(10, 1.8, 5e3);
  solvers::AxisymCase<2> coarser(PETSC_COMM_SELF, scene, 0, 0, 0), finer(PETSC_COMM_SELF, scene, 0, 0, 1),
      alone(PETSC_COMM_SELF, scene, 0, 0, 1);
  ASSERT_TRUE(coarser.rest()[0].converged && coarser.actuated()[0].converged);
  ASSERT_TRUE(alone.rest()[0].converged);
  const auto rest = finer.rest(coarser)[0], actuated = finer.actuated(coarser)[0],
             by_itself = alone.actuated()[0];
  ASSERT_TRUE(rest.converged && actuated.converged && by_itself.converged);
  EXPECT_NEAR(actuated.pressure, by_itself.pressure, 1e-9 * by_itself.pressure);
  EXPECT_EQ(actuated.stable_voltage, 1);
}

// The coarsest mesh has no coarser one to compare with.
TEST(ErrorEstimate, OfTheCoarsestMeshCoversItsError) {
  for (double degrees : {2.0, 10.0, 20.0})
    for (double stretch : {1.1, 1.8})
      for (double wall : {1e-3, 3e-3}) {
        model::Scene scene = cone(degrees, stretch);
        scene.bandage.thickness = wall;
        const solvers::SegmentTask task{&scene, 0};
        scene.axisym.refine = 0;
        const auto result = solvers::solve_axisym(PETSC_COMM_SELF, {&task, 1})[0];
        scene.axisym.order = 4;
        scene.axisym.refine = 1;
        const auto exact = solvers::solve_axisym(PETSC_COMM_SELF, {&task, 1})[0];
        const double error = std::fabs(result.pressure_rest / exact.pressure_rest - 1);
        EXPECT_GT(result.error_estimate, error - 1e-6) << degrees << " " << stretch << " " << wall;
        EXPECT_LT(result.error_estimate, 1e-2);
      }
}

}  // namespace
