// SPDX-License-Identifier: BSD-2-Clause
#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <random>

#include "gaiter/physics/slice_newton.hpp"
#include "gaiter/solvers/slice_model.hpp"
#include "gaiter/solvers/slice_solver.hpp"
#include "random_slices.hpp"
#include "slice_tasks.hpp"

// The solvers of the slice model: Newton where the paper's iteration fails, PETSc options that lead elsewhere
// to the same answer, and slices that leave each other alone. On any number of ranks.
namespace {

using namespace gaiter;
using model::Status;
using tasks::Option;

// The leg of verification values: mean radius of the paper's ankle segment.
model::Scene stiff_cylinder(double factor, double stretch) {
  model::Scene scene = paper::cylinder(39.6e-3, stretch);
  for (auto& term : scene.bandage.ogden) term.mu *= factor;
  scene.leg.data_limit = 1e9;
  return scene;
}

struct Stiff {
  double factor, stretch, pressure, radius;  // P [Pa], r/R_c; digits shown are right
  bool contracts;                            // the paper's iteration
};
const Stiff stiff_cases[] = {{10, 2.2, 33454.7, 0.81191, false},
                             {30, 1.4, 27190.4, 0.88532, true},
                             {100, 1.05, 13316.0, 0.96167, false}};

TEST(StiffBandage, NewtonFindsTheEquilibriumInTwelveSteps) {
  for (const Stiff& stiff : stiff_cases) {
    const model::Scene scene = stiff_cylinder(stiff.factor, stiff.stretch);
    const auto result = tasks::solve_one(scene);
    EXPECT_EQ(result.status, Status::contact);
    EXPECT_NEAR(result.pressure_rest, stiff.pressure, 0.05);  // half a unit of the last digit
    EXPECT_NEAR(result.radius_actuated / 39.6e-3, stiff.radius, 5e-6);
    EXPECT_LE(result.iterations, 12);
    const double expected =
        static_cast<double>(reference::only_equilibrium(reference::slice_of(scene, 0, 0.5), 0));
    EXPECT_NEAR(result.pressure_rest, expected, 1e-8 * expected);
  }
}

TEST(StiffBandage, ThePapersIterationDivergesWhereItDoesNotContract) {
  for (const Stiff& stiff : stiff_cases) {
    model::Scene scene = stiff_cylinder(stiff.factor, stiff.stretch);
    scene.discretisation.slice_solver = model::SliceSolver::fixed_point;
    scene.discretisation.fixed_point_tolerance = 1e-12;
    const auto result = tasks::solve_one(scene);
    if (stiff.contracts) {
      EXPECT_EQ(result.status, Status::contact);
      EXPECT_NEAR(result.pressure_rest, stiff.pressure, 0.05);
      EXPECT_NEAR(result.iterations, 152, 2);  // counted to 1e-12; where counting starts is a convention
    } else {
      EXPECT_EQ(result.status, Status::diverged);
      EXPECT_TRUE(std::isnan(result.pressure_rest));
      EXPECT_TRUE(std::isnan(result.electric_field_max));
      EXPECT_FALSE(std::isnan(result.pressure_rest_rigid));
    }
  }
}

// It stops when r changes by less than 1e-4 R_c: what is missing then is at most g/(1 - g) times that, with
// the contraction g. To that the pressure answers with the slope of the leg's law.
TEST(PapersIteration, AtItsToleranceIsWithinWhatThatPromises) {
  struct Case {
    double factor, stretch;
  };
  for (const Case& c : {Case{1, 1.4}, Case{1, 2.2}, Case{5, 1.8}, Case{30, 1.4}}) {
    model::Scene scene = stiff_cylinder(c.factor, c.stretch);
    const auto exact = tasks::solve_one(scene);
    scene.discretisation.slice_solver = model::SliceSolver::fixed_point;
    const auto rough = tasks::solve_one(scene);
    ASSERT_EQ(rough.status, Status::contact);
    scene.discretisation.fixed_point_tolerance = 1e-12;
    const auto fine = tasks::solve_one(scene);
    EXPECT_NEAR(fine.pressure_rest, exact.pressure_rest, 1e-8 * exact.pressure_rest);
    EXPECT_LT(rough.iterations, fine.iterations);

    // Contraction from the reference, by differences.
    const reference::Slice slice = reference::slice_of(scene, 0, 0.5);
    const reference::Quick p = exact.pressure_rest, h = 1e-5L * p;
    const auto bandage = [&](reference::Quick x) {
      return x - reference::imbalance<reference::Quick>(slice, x, 0);
    };
    const double contraction = static_cast<double>(std::fabs((bandage(p + h) - bandage(p - h)) / (2 * h)));
    ASSERT_LT(contraction, 1);
    const double missing = 1.1 * 1e-4 * contraction / (1 - contraction);
    EXPECT_LT(std::fabs(rough.radius_actuated - exact.radius_actuated) / 39.6e-3, missing);
    const double slope = scene.leg.segments[0].compliance.a * scene.leg.segments[0].compliance.b *
                         std::exp(scene.leg.segments[0].compliance.b * exact.pressure_rest);
    EXPECT_LT(std::fabs(rough.pressure_rest - exact.pressure_rest), 1.1e-4 / (1 - contraction) / slope);
    EXPECT_GT(rough.pressure_rest, 0);
  }
}

// A bandage cannot pull: where the voltage overcomes it, the iteration ends without contact, as Newton does.
TEST(PapersIteration, KnowsLiftOffAndSlackness) {
  for (const double stretch : {0.9, 1.1, 1.4})
    for (const double voltage : {0.0, 11.3e3, 20e3, 40e3}) {
      model::Scene scene = stiff_cylinder(1, stretch);
      scene.bandage.modules[0].voltage = voltage;
      const auto newton = tasks::solve_one(scene);
      scene.discretisation.slice_solver = model::SliceSolver::fixed_point;
      scene.discretisation.fixed_point_tolerance = 1e-12;
      const auto iterated = tasks::solve_one(scene);
      EXPECT_EQ(iterated.status, newton.status) << stretch << " " << voltage;
      EXPECT_NEAR(iterated.pressure_actuated, newton.pressure_actuated, 1e-8 * newton.pressure_rest)
          << stretch << " " << voltage;
    }
}

// The whole of the paper's leg and some stiff ones, on all ranks.
std::vector<model::Scene> many_scenes() {
  std::vector<model::Scene> scenes = {paper::scene(1.4), paper::scene(1.8), paper::scene(2.2),
                                      paper::scene(1.6)};
  for (auto& term : scenes[3].bandage.ogden) term.mu *= 10;
  for (auto& scene : scenes) {
    scene.leg.data_limit = 1e9;
    scene.discretisation.wall_points = 6;
  }
  return scenes;
}

std::vector<model::SegmentResult> solve_mine(const std::vector<model::Scene>& scenes) {
  const auto all = tasks::all_segments(scenes);
  std::vector<solvers::SegmentTask> mine;
  for (std::size_t i = 0; i < all.size(); ++i)
    if (static_cast<int>(i % petsc::size(PETSC_COMM_WORLD)) == petsc::rank(PETSC_COMM_WORLD))
      mine.push_back(all[i]);
  return solvers::solve_segments(PETSC_COMM_WORLD, mine);
}

using Options = std::vector<std::pair<std::string, std::string>>;

class OptionPath : public testing::TestWithParam<Options> {};

TEST_P(OptionPath, LeadsToTheSameAnswer) {
  const auto scenes = many_scenes();
  const auto expected = solve_mine(scenes);
  std::vector<std::unique_ptr<Option>> options;
  for (const auto& [name, value] : GetParam()) options.push_back(std::make_unique<Option>(name, value));
  const auto results = solve_mine(scenes);
  ASSERT_EQ(results.size(), expected.size());
  for (std::size_t i = 0; i < results.size(); ++i) {
    EXPECT_EQ(results[i].status, Status::contact);
    EXPECT_NEAR(results[i].pressure_rest, expected[i].pressure_rest, 1e-9 * expected[i].pressure_rest);
    EXPECT_NEAR(results[i].pressure_actuated, expected[i].pressure_actuated,
                1e-9 * expected[i].pressure_actuated);
    EXPECT_NEAR(results[i].volume_actuated, expected[i].volume_actuated, 1e-9 * expected[i].volume_actuated);
    EXPECT_GT(results[i].iterations, 0);
  }
}

const std::pair<std::string, std::string> gmres{"-slice_ksp_type", "gmres"},
    tight{"-slice_ksp_rtol", "1e-12"};
INSTANTIATE_TEST_SUITE_P(
    Slices, OptionPath,
    testing::Values(Options{{"-slice_mat_type", "shell"}}, Options{{"-slice_mat_type", "baij"}},
                    Options{{"-slice_mat_type", "aij"}},
                    Options{{"-slice_mat_type", "aij"}, {"-slice_pc_type", "pbjacobi"}},
                    Options{{"-slice_mat_type", "baij"}, {"-slice_pc_type", "pbjacobi"}, gmres, tight},
                    Options{gmres, tight},
                    Options{{"-slice_mat_type", "aij"},
                            {"-slice_pc_type", "none"},
                            gmres,
                            tight,
                            {"-slice_ksp_gmres_restart", "200"}},
                    Options{{"-slice_snes_linesearch_type", "basic"}},
                    Options{{"-slice_snes_linesearch_type", "bt"}},
                    Options{{"-slice_snes_linesearch_type", "bt"}, {"-slice_mat_type", "baij"}},
                    Options{{"-slice_snes_type", "newtontr"}, gmres, tight}));

TEST(Neighbours, AreNeitherSlowedNorSpoiltByAHardSlice) {
  const auto easy = many_scenes();
  std::vector<model::Scene> hard = easy;
  // One that Newton's method alone would step over, one that crushes the leg, one that is lifted off.
  hard.push_back(stiff_cylinder(1e4, 3));
  hard.push_back(stiff_cylinder(1, 1.1));
  hard.back().bandage.modules[0].voltage = 20e3;
  hard.push_back(stiff_cylinder(5, 4));
  hard.back().bandage.ogden = {{60e3, 0.5}, {0, 2}};
  hard.back().bandage.modules[0].voltage = 8e3;
  for (auto& scene : hard) scene.discretisation.wall_points = 6;
  const auto alone = solvers::solve_segments(PETSC_COMM_SELF, tasks::all_segments(easy));
  auto tasks_of_all = tasks::all_segments(hard);
  // The hard ones in the middle of the packs.
  std::rotate(tasks_of_all.begin() + 7, tasks_of_all.begin() + 24, tasks_of_all.end());
  const auto beside = solvers::solve_segments(PETSC_COMM_SELF, tasks_of_all);
  for (std::size_t i = 0; i < 24; ++i) {
    const std::size_t place = i < 7 ? i : i + 3;
    EXPECT_TRUE(tasks::same_bits(tasks::numbers_of(beside[place]), tasks::numbers_of(alone[i]))) << i;
  }

  // Cut short, a slice is lost or it has its result; some are lost where others are done.
  bool mixed = false;
  for (int steps = 1; steps < 10; ++steps) {
    const Option few("-slice_snes_max_it", std::to_string(steps));
    const auto cut = solvers::solve_segments(PETSC_COMM_SELF, tasks_of_all);
    std::size_t lost = 0;
    for (std::size_t i = 0; i < cut.size(); ++i) {
      if (cut[i].status == Status::diverged) {
        ++lost;
        EXPECT_TRUE(std::isnan(cut[i].pressure_rest));
        EXPECT_TRUE(std::isnan(cut[i].error_estimate));
      } else {
        // One whose path was searched starts again from there, so it may have lost steps without harm.
        auto cut_numbers = tasks::numbers_of(cut[i]);
        cut_numbers[16] = beside[i].iterations;
        EXPECT_TRUE(tasks::same_bits(cut_numbers, tasks::numbers_of(beside[i]))) << i;
      }
    }
    mixed = mixed || (lost > 0 && lost < cut.size());
  }
  EXPECT_TRUE(mixed);
}

TEST(Tolerance, LoosenedCostsLessAndKeepsItsPromise) {
  const auto scenes = many_scenes();
  const auto tight_results = solve_mine(scenes);
  for (const double tolerance : {1e-10, 1e-6, 1e-3}) {
    const Option loose("-slice_snes_rtol",
                       "1e-" + std::to_string(static_cast<int>(-std::log10(tolerance) + 0.5)));
    const auto results = solve_mine(scenes);
    for (std::size_t i = 0; i < results.size(); ++i) {
      EXPECT_LE(results[i].iterations, tight_results[i].iterations);
      EXPECT_NEAR(results[i].pressure_rest, tight_results[i].pressure_rest,
                  (tolerance + 1e-12) * tight_results[i].pressure_rest);
      // The actuated state starts from one at rest that is as rough.
      EXPECT_NEAR(results[i].pressure_actuated, tight_results[i].pressure_actuated,
                  (2 * tolerance + 1e-12) * tight_results[i].pressure_actuated);
    }
  }
}

// The product of the matrix-free Jacobian and that of the assembled one, at the same iterate, against
// differences of the residual. The solver has room for a pack more than it is given.
TEST(Jacobian, IsTheSameMatrixFreeAndAssembledAndThatOfTheResidual) {
  samples::Sampler sampler(7 + petsc::rank(PETSC_COMM_WORLD));
  std::vector<model::Scene> scenes;
  for (int i = 0; i < 100; ++i) scenes.push_back(sampler.scene(model::LegMaterial::compliance, 1));
  const physics::SliceSystem system = samples::system_of(scenes, 3);
  std::vector<std::vector<double>> products;
  for (const char* type : {"shell", "baij", "aij"}) {
    const Option matrix("-slice_mat_type", type);
    solvers::SliceSolver solver(PETSC_COMM_WORLD, 3, model::SliceSolver::newton, 1e-4);
    std::vector<physics::PackState> states(system.packs());
    physics::Pack unused;
    for (std::size_t k = 0; k < states.size(); ++k)
      physics::start_at_rest(system.shape(), system.pack(k), states[k], unused);
    solver.solve(system, states);

    Vec x = nullptr, direction = nullptr, product = nullptr, up = nullptr, down = nullptr;
    Mat jacobian = nullptr;
    ASSERT_EQ(SNESGetSolution(solver.snes(), &x), 0);
    ASSERT_EQ(SNESGetJacobian(solver.snes(), &jacobian, nullptr, nullptr, nullptr), 0);
    for (Vec* vector : {&direction, &product, &up, &down}) ASSERT_EQ(VecDuplicate(x, vector), 0);
    PetscScalar *values = nullptr, *iterate = nullptr;
    PetscInt size = 0;
    ASSERT_EQ(VecGetLocalSize(x, &size), 0);
    ASSERT_EQ(VecGetArray(direction, &values), 0);
    ASSERT_EQ(VecGetArray(x, &iterate), 0);
    std::mt19937 generator(3);
    for (PetscInt i = 0; i < size; ++i) {
      // Away from the solution, where the residual is not small and contact is sure.
      const double share = 0.5 + 0.5 * static_cast<double>(generator()) / generator.max();
      values[i] = (i % 2 ? iterate[i] : 1) * share;
      iterate[i] *= i % 2 ? 1.1 : 1;
    }
    ASSERT_EQ(VecRestoreArray(x, &iterate), 0);
    ASSERT_EQ(VecRestoreArray(direction, &values), 0);
    ASSERT_EQ(SNESComputeFunction(solver.snes(), x, up), 0);
    ASSERT_EQ(SNESComputeJacobian(solver.snes(), x, jacobian, jacobian), 0);
    ASSERT_EQ(MatMult(jacobian, direction, product), 0);

    const double step = 1e-6;
    ASSERT_EQ(VecAXPY(x, step, direction), 0);
    ASSERT_EQ(SNESComputeFunction(solver.snes(), x, up), 0);
    ASSERT_EQ(VecAXPY(x, -2 * step, direction), 0);
    ASSERT_EQ(SNESComputeFunction(solver.snes(), x, down), 0);
    const PetscScalar *got = nullptr, *plus = nullptr, *minus = nullptr;
    ASSERT_EQ(VecGetArrayRead(product, &got), 0);
    ASSERT_EQ(VecGetArrayRead(up, &plus), 0);
    ASSERT_EQ(VecGetArrayRead(down, &minus), 0);
    double largest = 0;
    for (PetscInt i = 0; i < 200; ++i) {
      const double difference = (plus[i] - minus[i]) / (2 * step);
      const double rounding = 1e-15 * (1 + std::fabs(plus[i]) + std::fabs(got[i])) / step;
      EXPECT_NEAR(got[i], difference, 1e-6 * std::fabs(difference) + rounding) << type << " row " << i;
      largest = std::max(largest, std::fabs(plus[i]));
    }
    EXPECT_GT(largest, 0);
    products.emplace_back(got, got + 200);
    ASSERT_EQ(VecRestoreArrayRead(product, &got), 0);
    ASSERT_EQ(VecRestoreArrayRead(up, &plus), 0);
    ASSERT_EQ(VecRestoreArrayRead(down, &minus), 0);
    for (Vec* vector : {&direction, &product, &up, &down}) ASSERT_EQ(VecDestroy(vector), 0);
  }
  for (std::size_t i = 0; i < 200; ++i) {
    const double allowed = 1e-14 * (1 + std::fabs(products[0][i]));  // sums of two terms in another order
    EXPECT_NEAR(products[0][i], products[1][i], allowed) << i;
    EXPECT_NEAR(products[0][i], products[2][i], allowed) << i;
  }
}

}  // namespace
