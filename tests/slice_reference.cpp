// SPDX-License-Identifier: BSD-2-Clause
#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>

#include "gaiter/physics/quadrature.hpp"
#include "gaiter/solvers/slice_model.hpp"
#include "paper_scene.hpp"
#include "reference.hpp"
#include "slice_tasks.hpp"

// The slice model of whole segments against values computed elsewhere, on any number of ranks, and how fast
// its slicings converge.
namespace {

using namespace gaiter;
using tasks::Numbers;

// Independent values (40-digit arithmetic, no code of the project) for the paper's inputs; digits shown are
// right. Pressures before and after actuation in Pa, volumes in mL.
struct Row {
  int segment;
  double stretch;
  double values[7];  // P_m rigid, P_m, P_t rigid, P_t, V0, V rest, V actuated
};
const Row table[] = {
    {0, 1.4, {1228.07094, 1199.23893, 926.606706, 903.209152, 173.033464, 169.361388, 170.036848}},
    {0, 1.8, {2764.20717, 2658.46359, 2374.6238, 2274.79276, 173.033464, 167.618337, 167.93651}},
    {0, 2.2, {7086.08634, 6325.20228, 6607.46602, 5871.21017, 173.033464, 165.345128, 165.61833}},
    {1, 1.4, {1031.07658, 1015.32504, 775.862689, 763.847737, 239.787485, 236.474953, 237.248367}},
    {1, 1.8, {2297.74389, 2240.39302, 1968.18737, 1913.78591, 239.787485, 234.775498, 235.042609}},
    {1, 2.2, {5696.79995, 5350.97155, 5292.24655, 4953.08996, 239.787485, 233.555993, 233.682896}},
    {2, 1.4, {905.125871, 895.234723, 679.862972, 672.05691, 306.482248, 303.459587, 304.091938}},
    {2, 1.8, {2006.30304, 1967.27522, 1715.56932, 1679.75299, 306.482248, 301.427266, 301.851063}},
    {2, 2.2, {4881.25142, 4612.98251, 4524.53897, 4264.4372, 306.482248, 299.103114, 299.341189}},
    {3, 1.4, {821.194428, 807.758041, 616.064598, 605.9795, 368.554325, 363.135059, 364.476384}},
    {3, 1.8, {1814.31386, 1762.76961, 1549.65488, 1501.86301, 368.554325, 359.533159, 360.203204}},
    {3, 2.2, {4362.07934, 4063.18461, 4037.47104, 3743.10442, 368.554325, 357.107263, 357.292853}},
    {4, 1.4, {773.8195, 761.265937, 580.139483, 570.469206, 412.684095, 406.673007, 408.046393}},
    {4, 1.8, {1705.13286, 1659.96964, 1455.29487, 1413.08959, 412.684095, 403.194741, 403.825197}},
    {4, 2.2, {4063.78459, 3807.05389, 3757.41458, 3505.36656, 412.684095, 400.736495, 400.964849}},
    {5, 1.4, {754.590026, 743.601386, 565.56121, 557.311836, 432.963474, 427.302642, 428.708018}},
    {5, 1.8, {1661.60333, 1620.45687, 1417.78438, 1379.54813, 432.963474, 423.643334, 424.310694}},
    {5, 2.2, {3949.8038, 3720.61363, 3650.83859, 3424.44638, 432.963474, 421.444278, 421.590905}},
};

std::vector<model::Scene> paper_scenes() {
  return {paper::scene(1.4), paper::scene(1.8), paper::scene(2.2)};
}

// Solves the tasks that `owner` gives this rank, in the order of `order`, and hands everybody all results in
// the tasks' own order.
template <typename Owner>
std::vector<Numbers> solve_spread(const std::vector<solvers::SegmentTask>& all,
                                  std::vector<std::size_t> order, Owner&& owner) {
  const int rank = petsc::rank(PETSC_COMM_WORLD), size = petsc::size(PETSC_COMM_WORLD);
  std::vector<solvers::SegmentTask> mine;
  std::vector<std::size_t> places;
  for (std::size_t place : order)
    if (owner(place) % size == rank) {
      mine.push_back(all[place]);
      places.push_back(place);
    }
  const auto results = solvers::solve_segments(PETSC_COMM_WORLD, mine);
  std::vector<Numbers> gathered(all.size(), Numbers{});
  EXPECT_EQ(results.size(), mine.size());
  for (std::size_t i = 0; i < places.size(); ++i) gathered[places[i]] = tasks::numbers_of(results[i]);
  // Each number comes from one rank, the others add nothing to it.
  MPI_Allreduce(MPI_IN_PLACE, gathered.data(), static_cast<int>(gathered.size()) * tasks::fields, MPI_DOUBLE,
                MPI_SUM, PETSC_COMM_WORLD);
  return gathered;
}

std::vector<std::size_t> in_order(std::size_t count) {
  std::vector<std::size_t> order(count);
  std::iota(order.begin(), order.end(), 0);
  return order;
}

void compare_with_alone(const std::vector<model::Scene>& scenes) {
  const auto all = tasks::all_segments(scenes);
  std::vector<Numbers> alone;
  for (const auto& result : solvers::solve_segments(PETSC_COMM_SELF, all))
    alone.push_back(tasks::numbers_of(result));
  const auto check = [&](const std::vector<Numbers>& results, const char* how) {
    for (std::size_t i = 0; i < all.size(); ++i)
      EXPECT_TRUE(tasks::same_bits(results[i], alone[i])) << how << ", task " << i;
  };
  auto order = in_order(all.size());
  check(solve_spread(all, order, [](std::size_t i) { return static_cast<int>(i); }), "in turn");
  check(solve_spread(all, order, [](std::size_t) { return 0; }), "all on the first rank");
  check(solve_spread(all, order, [&](std::size_t) { return petsc::size(PETSC_COMM_WORLD) - 1; }),
        "all on the last rank");
  check(solve_spread(all, order, [](std::size_t i) { return i < 2 ? 0 : 2; }), "two tasks against the rest");
  std::reverse(order.begin(), order.end());
  check(solve_spread(all, order, [](std::size_t i) { return static_cast<int>(i) / 3; }), "in reverse");
  std::rotate(order.begin(), order.begin() + 5, order.end());
  check(solve_spread(all, order, [](std::size_t i) { return static_cast<int>(i * 7) % 5; }), "shuffled");
}

TEST(PaperTable, HasAllItsDigitsOnAnyNumberOfRanks) {
  const auto scenes = paper_scenes();
  const auto all = tasks::all_segments(scenes);
  const auto results = solve_spread(all, in_order(all.size()), [](std::size_t i) {
    return i < 5 ? 0 : i < 6 ? 1 : 2;
  });
  for (const Row& row : table) {
    const int scene = row.stretch == 1.4 ? 0 : row.stretch == 1.8 ? 1 : 2;
    const Numbers& r = results[scene * 6 + row.segment];
    const double got[] = {r[2], r[0], r[3], r[1], r[8] * 1e6, r[9] * 1e6, r[10] * 1e6};
    // 9 digits are printed: half a unit of the last is up to 5e-9.
    for (int k = 0; k < 7; ++k)
      EXPECT_NEAR(got[k], row.values[k], 1e-8 * row.values[k])
          << "segment " << row.segment << " stretch " << row.stretch << " column " << k;
    EXPECT_NEAR(r[6], r[0] - r[1], 1e-11 * r[1]);
    EXPECT_NEAR(r[11], (r[8] - r[10]) / r[8], 1e-12);
    // At the largest stretch some slices press harder than the compliance was measured.
    EXPECT_LE(static_cast<model::Status>(r[17]),
              row.stretch < 2.2 ? model::Status::contact : model::Status::extrapolated);
    EXPECT_GE(r[15], 0);
    EXPECT_LT(r[23], 1e-7);  // the estimate must not disown digits that are right
  }
}

// The same from this suite's own reference, which shares nothing with the table: every slice of one segment.
TEST(PaperTable, AgreesWithTheReferenceSliceBySlice) {
  const model::Scene scene = paper::scene(2.2);
  const auto result = tasks::solve_one(scene);
  const physics::Quadrature rule = physics::gauss_legendre(6);
  reference::Real rest = 0, actuated = 0;
  for (int k = 0; k < 6; ++k) {
    const reference::Slice slice = reference::slice_of(scene, 0, rule.nodes[k]);
    rest += rule.weights[k] * reference::only_equilibrium(slice, 0);
    actuated += rule.weights[k] * reference::only_equilibrium(slice, slice.voltage);
  }
  EXPECT_NEAR(result.pressure_rest, static_cast<double>(rest), 1e-11 * result.pressure_rest);
  EXPECT_NEAR(result.pressure_actuated, static_cast<double>(actuated), 1e-11 * result.pressure_actuated);
}

TEST(Ranks, DoNotChangeABitOfNewtonsResults) {
  compare_with_alone(paper_scenes());
}

TEST(Ranks, DoNotChangeABitOfTheFixedPoints) {
  auto scenes = paper_scenes();
  for (auto& scene : scenes) scene.discretisation.slice_solver = model::SliceSolver::fixed_point;
  compare_with_alone(scenes);
}

TEST(Ranks, DoNotChangeABitOfTheRigidLegs) {
  auto scenes = paper_scenes();
  for (auto& scene : scenes) scene.fidelity = model::Fidelity::rigid;
  compare_with_alone(scenes);
}

// Slices with and without contact, layers, voltages and wall points that differ between the ranks.
TEST(Ranks, DoNotChangeABitOfMixedDesigns) {
  std::vector<model::Scene> scenes = {paper::scene(1.02), paper::scene(1.1, 0),     paper::scene(2.2),
                                      paper::scene(1.4),  paper::scene(1.05, 30e3), paper::scene(0.98)};
  scenes[2].bandage.layers = 3;
  scenes[3].discretisation.wall_points = 7;
  scenes[3].discretisation.slice_count = 11;
  for (auto& term : scenes[3].bandage.ogden) term.mu *= 30;
  scenes[4].bandage.ogden = {{20e3, 1.2}, {0, 2}};
  compare_with_alone(scenes);
}

TEST(Ranks, MayAllBeWithoutTasks) {
  EXPECT_TRUE(solvers::solve_segments(PETSC_COMM_WORLD, {}).empty());
}

// Closed form (exact plane-strain equilibrium, incompressible tube): radius 39.6 mm, stretch 2.2, E 80 kPa,
// nu 0.4. The digits are those of the reference.
TEST(NeoHookeanLeg, HasTheExactPressureAndVolume) {
  model::Scene scene = paper::cylinder(39.6e-3, 2.2);
  scene.leg.material = model::LegMaterial::neo_hookean;
  scene.discretisation.slice_count = 6;
  const auto result = tasks::solve_one(scene);
  EXPECT_NEAR(result.pressure_rest, 6091.27, 0.005);
  EXPECT_NEAR(result.pressure_rest_area_mean, 6091.27, 0.005);
  EXPECT_NEAR(result.volume_rest * 1e9, 165112.6, 0.05);
  EXPECT_EQ(result.status, model::Status::contact);
}

double rest_pressure(model::SliceRule rule, int slices) {
  model::Scene scene = paper::scene(2.2);
  scene.discretisation.slice_rule = rule;
  scene.discretisation.slice_count = slices;
  scene.discretisation.wall_points = 6;
  return tasks::solve_one(scene).pressure_rest;
}

// Slope of a straight line through the points (least squares).
double slope(const std::vector<double>& x, const std::vector<double>& y) {
  const double mean_x = std::accumulate(x.begin(), x.end(), 0.0) / x.size();
  const double mean_y = std::accumulate(y.begin(), y.end(), 0.0) / y.size();
  double xy = 0, xx = 0;
  for (std::size_t i = 0; i < x.size(); ++i) {
    xy += (x[i] - mean_x) * (y[i] - mean_y);
    xx += (x[i] - mean_x) * (x[i] - mean_x);
  }
  return xy / xx;
}

TEST(Slicing, MidpointsConvergeWithOrderTwoAndGaussMuchFaster) {
  const double exact = rest_pressure(model::SliceRule::gauss, 16);
  const auto error = [&](model::SliceRule rule, int slices) {
    return std::fabs(rest_pressure(rule, slices) - exact) / exact;
  };
  std::vector<double> x, y;
  for (const int slices : {4, 8, 16, 32, 64}) {
    x.push_back(std::log(slices));
    y.push_back(std::log(error(model::SliceRule::midpoint, slices)));
  }
  EXPECT_NEAR(slope(x, y), -2, 0.05);  // fourth-order terms still show at 4 slices
  const double finest = std::exp(y.back());
  x.clear(), y.clear();
  for (const int slices : {1, 2, 3, 4, 5, 6}) {
    x.push_back(slices);
    y.push_back(std::log(error(model::SliceRule::gauss, slices)));
  }
  // The pressure is analytic in the height: each point more divides the error, here by some 90 on average.
  EXPECT_LT(slope(x, y), -std::log(30));
  EXPECT_LT(error(model::SliceRule::gauss, 3), finest);  // 3 points do more than 64 midpoints
}

TEST(Slicing, TheErrorEstimateCoversTheError) {
  for (const double stretch : {1.4, 2.2})
    for (const std::size_t segment : {0, 2, 5}) {
      const auto solve = [&](model::SliceRule rule, int slices) {
        model::Scene scene = paper::scene(stretch, 0);
        scene.discretisation.slice_rule = rule;
        scene.discretisation.slice_count = slices;
        scene.discretisation.wall_points = 6;
        const solvers::SegmentTask task{&scene, segment};
        return solvers::solve_segments(PETSC_COMM_SELF, {&task, 1})[0];
      };
      const double exact = solve(model::SliceRule::gauss, 16).pressure_rest;
      for (const int slices : {4, 8, 16, 32}) {
        const auto result = solve(model::SliceRule::midpoint, slices);
        const double error = std::fabs(result.pressure_rest - exact) / exact;
        EXPECT_GT(result.discretisation_error, error / 3) << "midpoints " << slices << " segment " << segment;
        EXPECT_LT(result.discretisation_error, error * 30)
            << "midpoints " << slices << " segment " << segment;
      }
      for (const int slices : {1, 2, 3, 4, 5, 6}) {
        const auto result = solve(model::SliceRule::gauss, slices);
        const double error = std::fabs(result.pressure_rest - exact) / exact;
        // Taken from starting values, or from the fall of the pressure's own Legendre coefficients. Below
        // 1e-13 rounding takes over.
        EXPECT_GT(result.discretisation_error, error - 1e-13)
            << "points " << slices << " segment " << segment;
        EXPECT_LT(result.discretisation_error, 2000 * error + (slices < 6 ? 1e-12 : 1e-7))
            << "points " << slices << " segment " << segment;
      }
      EXPECT_LT(solve(model::SliceRule::gauss, 6).discretisation_error, 1e-7);
    }
}

}  // namespace
