// SPDX-License-Identifier: BSD-2-Clause
// Potential, residual and tangent of the assembled axisymmetric system agree, contact included: Taylor
// remainders of random states of a cone whose contact is open at one end. And what follows from it: the last
// steps of Newton's method.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdio>
#include <random>
#include <tuple>

#include "axisym_problem.hpp"
#include "fitted_order.hpp"
#include "paper_scene.hpp"

namespace gaiter::axisym {
namespace {

using model::ContactSide;
using model::LegMaterial;

model::Scene cone(double stretch) {
  model::Scene scene = paper::cylinder(36.1e-3, stretch);
  scene.leg.segments[0].upper_radius = 43.1e-3;
  scene.leg.variant = model::ComplianceVariant::anchored;
  return scene;
}

petsc::Vector vector_of(Vec like, const std::vector<double>& values) {
  petsc::Vector result;
  PetscScalar* data = nullptr;
  petsc::check(VecDuplicate(like, result.out()));
  petsc::check(VecGetArray(result.get(), &data));
  std::copy(values.begin(), values.end(), data);
  petsc::check(VecRestoreArray(result.get(), &data));
  return result;
}

double relative_asymmetry(Mat matrix) {
  petsc::Matrix difference;
  PetscReal size = 0, norm = 0;
  petsc::check(MatTranspose(matrix, MAT_INITIAL_MATRIX, difference.out()));
  petsc::check(MatAXPY(difference.get(), -1, matrix, DIFFERENT_NONZERO_PATTERN));
  petsc::check(MatNorm(difference.get(), NORM_FROBENIUS, &size));
  petsc::check(MatNorm(matrix, NORM_FROBENIUS, &norm));
  return size / norm;
}

// What a Taylor series leaves, by the step; squares of what random states and directions give.
struct Remainders {
  std::vector<double> steps{0.125, 0.0625, 0.03125, 0.015625};
  std::vector<double> slope = std::vector<double>(4), curvature = slope, residual = slope;
};

template <int P>
class RandomStates {
 public:
  // `share`: of the field.
  RandomStates(const model::Scene& scene, double spring, double share)
      : scene_(scene), problem_(scene, resolution()), random_(5) {
    problem_.system.set_axial_spring(spring);
    problem_.system.energise(share);
  }

  // Adds the remainders of one state and direction.
  void add_to(Remainders& sums) {
    problem_.start(scene_);
    std::vector<double> state = problem_.values(), direction(state.size());
    disturb(state, direction);
    const petsc::Vector x = vector_of(problem_.x.get(), state), d = vector_of(problem_.x.get(), direction);
    petsc::Vector trial, residual, change, product;
    for (petsc::Vector* vector : {&trial, &residual, &change, &product})
      petsc::check(VecDuplicate(x.get(), vector->out()));

    auto& system = problem_.system;
    bool admissible = false;
    petsc::check(system.evaluate(x.get(), residual.get(), admissible));
    ASSERT_TRUE(admissible);
    petsc::check(system.assemble());
    EXPECT_LT(relative_asymmetry(system.matrix()), 1e-14);
    const double energy = system.energy();
    const auto& carrier = system.space().choice.multipliers_on_tube ? system.tubes()[0] : system.leg();
    int active = 0, vertices = 0;
    for (std::size_t i = 0; i < carrier.active.size(); i += P, ++vertices) active += carrier.active[i];
    EXPECT_GT(active, 0);
    EXPECT_LT(active, vertices);

    PetscScalar slope = 0, curvature = 0;
    petsc::check(VecDot(residual.get(), d.get(), &slope));
    petsc::check(MatMult(system.matrix(), d.get(), product.get()));
    petsc::check(VecDot(product.get(), d.get(), &curvature));
    for (std::size_t k = 0; k < sums.steps.size(); ++k) {
      const double h = sums.steps[k];
      petsc::check(VecWAXPY(trial.get(), h, d.get(), x.get()));
      petsc::check(system.evaluate(trial.get(), change.get(), admissible));
      ASSERT_TRUE(admissible);
      // The potential is smooth as long as no contact opens or closes.
      ASSERT_EQ(system.active_changes(), 0);
      const double first = system.energy() - energy - h * slope;
      petsc::check(VecAXPY(change.get(), -1, residual.get()));
      petsc::check(VecAXPY(change.get(), -h, product.get()));
      PetscReal norm = 0;
      petsc::check(VecNorm(change.get(), NORM_2, &norm));
      sums.slope[k] += first * first;
      sums.curvature[k] += std::pow(first - 0.5 * h * h * curvature, 2);
      sums.residual[k] += norm * norm;
    }
  }

 private:
  static solvers::AxisymResolution resolution() {
    solvers::AxisymResolution result;
    result.tube_rows = 5;
    result.leg_rows = 4;
    result.leg_columns = 2;
    return result;
  }

  double uniform(double low, double high) { return std::uniform_real_distribution(low, high)(random_); }

  // The lower half of the tube is lifted off, without pressure there: states as Newton's method meets them,
  // in which an open contact's multiplier is 0.
  void disturb(std::vector<double>& state, std::vector<double>& direction) {
    const auto& space = problem_.system.space();
    constexpr double small = 2e-3 / (P * P);  // displacement, over the leg's radius; the wall is 0.025
    constexpr double lift = 0.01, pressure = 0.05;
    const double middle = 0.5 * space.mesh.leg().height.back();
    for (std::size_t i = 0; i < state.size(); ++i) direction[i] = uniform(-pressure, pressure);
    std::vector<double> lifted(state.size(), 0.0);
    for (const auto& cell : space.cells)
      for (std::size_t a = 0; a < cell.geometry.position.size(); ++a)
        for (int component : {0, 1}) {
          const PetscInt place = cell.global[2 * a + component];
          if (place < 0) continue;
          const double above = 1 - cell.geometry.position[a][1] / middle;
          if (component == 0 && space.mesh.blocks[cell.block].tube && above > 0) lifted[place] = lift * above;
          direction[place] = uniform(-small, small);
        }
    std::vector<bool> multiplier(state.size(), false);
    const auto press = [&](const solvers::ContactSurface& carrier) {
      for (const auto& node : carrier.nodes)
        if (node.multiplier >= 0) {
          multiplier[node.multiplier] = true;
          state[node.multiplier] = node.height < 0.8 * middle ? 0 : uniform(0.2, 0.4);
          direction[node.multiplier] = uniform(-0.02, 0.02);
        }
    };
    for (const auto& tube : space.tubes) press(tube);
    press(space.leg);
    for (std::size_t i = 0; i < state.size(); ++i)
      state[i] += lifted[i] + (multiplier[i] ? 0 : uniform(-1, 1) * std::fabs(direction[i]));
  }

  const model::Scene& scene_;
  Problem<P> problem_;
  std::mt19937 random_;
};

using Choice = std::tuple<int, LegMaterial, ContactSide, bool>;  // order, leg, multipliers, incompressible

template <int P>
Remainders remainders(const model::Scene& scene, double spring, double share) {
  Remainders sums;
  RandomStates<P> states(scene, spring, share);
  for (int k = 0; k < 12; ++k) states.add_to(sums);
  for (auto* squares : {&sums.slope, &sums.curvature, &sums.residual})
    for (double& square : *squares) square = std::sqrt(square);
  return sums;
}

void expect_orders_of_remainders(const model::Scene& scene, int order, double spring, double share) {
  const Remainders sums = order == 2   ? remainders<2>(scene, spring, share)
                          : order == 3 ? remainders<3>(scene, spring, share)
                                       : remainders<4>(scene, spring, share);
  const double slope = fitted_order(sums.steps, sums.slope),
               curvature = fitted_order(sums.steps, sums.curvature),
               residual = fitted_order(sums.steps, sums.residual);
  std::printf("  order of potential after residual %.3f, after tangent %.3f (left: %.1e), of residual %.3f\n",
              slope, curvature, sums.curvature.back(), residual);
  EXPECT_NEAR(slope, 2, 0.05);
  EXPECT_NEAR(curvature, 3, 0.05);
  EXPECT_NEAR(residual, 2, 0.05);
}

class AxisymTaylor : public testing::TestWithParam<Choice> {};

TEST_P(AxisymTaylor, RemaindersHaveTheirOrders) {
  const auto [order, material, side, incompressible] = GetParam();
  model::Scene scene = cone(1.4);
  scene.leg.material = material;
  scene.axisym.multipliers = side;
  if (!incompressible) scene.bandage.bulk_modulus = 2e6;
  expect_orders_of_remainders(scene, order, incompressible ? 0 : 0.3, 0);
}

INSTANTIATE_TEST_SUITE_P(All, AxisymTaylor,
                         testing::Combine(testing::Values(2, 3, 4),
                                          testing::Values(LegMaterial::neo_hookean, LegMaterial::compliance),
                                          testing::Values(ContactSide::tube, ContactSide::leg),
                                          testing::Bool()),
                         [](const auto& choice) {
                           return "order_" + std::to_string(std::get<0>(choice.param)) +
                                  (std::get<1>(choice.param) == LegMaterial::compliance ? "_compliance"
                                                                                        : "_neo_hookean") +
                                  (std::get<2>(choice.param) == ContactSide::tube ? "_on_tube" : "_on_leg") +
                                  (std::get<3>(choice.param) ? "_incompressible" : "_compressible");
                         });

using VoltageChoice = std::tuple<int, model::Electrostatics, int, double, bool>;

class AxisymTaylorOfVoltage : public testing::TestWithParam<VoltageChoice> {};

// Two modules on one leg: the lower one without voltage, or with half as much.
TEST_P(AxisymTaylorOfVoltage, RemaindersHaveTheirOrders) {
  const auto [order, electrostatics, layers, share, beside_none] = GetParam();
  model::Scene scene = cone(1.4);
  scene.leg.material = LegMaterial::neo_hookean;  // the compliance's curvature would hide the field's
  scene.axisym.electrostatics = electrostatics;
  scene.axisym.scope = model::AxisymScope::leg;
  scene.bandage.layers = layers;
  model::Segment above = scene.leg.segments[0];
  above.lower_radius = above.upper_radius;
  above.upper_radius = 47e-3;
  scene.leg.segments.push_back(above);
  scene.bandage.modules.push_back(scene.bandage.modules[0]);
  // The closed form depends on little that varies from node to node: only with much of it its errors show.
  const double voltage = (electrostatics == model::Electrostatics::radial ? 80e3 : 10e3) / layers;
  scene.bandage.modules[0].voltage = beside_none ? 0 : voltage / 2;
  scene.bandage.modules[1].voltage = voltage;
  expect_orders_of_remainders(scene, order, 0, share);
}

// At share 0 the potential does not couple to the displacement, and its equation is the undeformed wall's.
INSTANTIATE_TEST_SUITE_P(
    All, AxisymTaylorOfVoltage,
    testing::Combine(testing::Values(2, 3),
                     testing::Values(model::Electrostatics::field, model::Electrostatics::radial),
                     testing::Values(1, 3), testing::Values(0.0, 0.4, 1.0), testing::Bool()));

// Newton's method from ever closer to the solution: the second step, which is what the first one has left,
// over the first, largest displacements over the leg's radius. And the steps from the slice solution, of
// which the last is above rounding.
struct Newton {
  std::vector<double> first, second, steps;
};

template <int P>
Newton newton(const model::Scene& scene) {
  Newton result;
  Problem<P> problem(scene, {});
  problem.start(scene);
  const std::vector<double> start = problem.values();
  for (int solve = 0; solve < 2; ++solve) {  // the second takes what the first one's last step leaves
    const auto report = problem.solver.solve(problem.x.get());
    EXPECT_TRUE(report.converged && report.stable);
    result.steps.insert(result.steps.end(), report.steps.begin(), report.steps.end());
  }
  while (result.steps.back() < 1e-13) result.steps.pop_back();
  const std::vector<double> solution = problem.values();
  for (double distance : {0.02, 0.01, 0.005, 0.0025}) {
    std::vector<double> near = solution;
    for (std::size_t i = 0; i < near.size(); ++i) near[i] += distance * (start[i] - solution[i]);
    const petsc::Vector x = vector_of(problem.x.get(), near);
    const auto report = problem.solver.solve(x.get());
    EXPECT_TRUE(report.converged);
    result.first.push_back(report.steps[0]);
    result.second.push_back(report.steps[1]);
  }
  return result;
}

class NewtonsMethod : public testing::TestWithParam<std::tuple<int, LegMaterial, double>> {};

TEST_P(NewtonsMethod, IsQuadraticInTheEnd) {
  const auto [order, material, stretch] = GetParam();
  model::Scene scene = cone(stretch);
  scene.leg.material = material;
  const Newton found = order == 2 ? newton<2>(scene) : newton<3>(scene);
  const double exponent = fitted_order(found.first, found.second);
  std::printf("  stretch %.1f, order %d: exponent %.2f; steps", stretch, order, exponent);
  for (double step : found.steps) std::printf(" %.1e", step);
  std::printf("\n");
  EXPECT_NEAR(exponent, 2, 0.15);
  // Each of the last three, the first of which has found the contact.
  for (std::size_t k = found.steps.size() - 2; k < found.steps.size(); ++k) {
    EXPECT_LT(found.steps[k], 30 * std::pow(found.steps[k - 1], 1.5)) << "step " << k + 1;
  }
}

INSTANTIATE_TEST_SUITE_P(Cones, NewtonsMethod,
                         testing::Combine(testing::Values(2, 3),
                                          testing::Values(LegMaterial::neo_hookean, LegMaterial::compliance),
                                          testing::Values(1.4, 2.0, 2.2)));

}  // namespace
}  // namespace gaiter::axisym
