// SPDX-License-Identifier: BSD-2-Clause
// How fast sliding slices converge with their number, and what their error estimate is worth.
#include <gtest/gtest.h>

#include <cmath>

#include "gaiter/solvers/sliding_model.hpp"
#include "paper_scene.hpp"

namespace gaiter::solvers {
namespace {

model::SegmentResult solve(double stretch, double voltage, int slices) {
  model::Scene scene = paper::scene(stretch, voltage);
  scene.leg.variant = model::ComplianceVariant::anchored;
  scene.discretisation.sliding_count = slices;
  return solve_sliding({&scene, 0}).result;
}

// Slope of ln(error) over ln(1/slices), by least squares.
double fitted_order(const std::vector<int>& counts, const std::vector<double>& errors) {
  double x = 0, y = 0, xx = 0, xy = 0;
  const double n = static_cast<double>(counts.size());
  for (std::size_t k = 0; k < counts.size(); ++k) {
    const double u = -std::log(counts[k]), v = std::log(errors[k]);
    x += u;
    y += v;
    xx += u * u;
    xy += u * v;
  }
  return (n * xy - x * y) / (n * xx - x * x);
}

struct Study {
  const char* name;
  double stretch, voltage;
  std::vector<int> counts;
  double pressure_order, slip_order;
};

void PrintTo(const Study& study, std::ostream* out) {
  *out << study.name;
}

class SlidingConvergence : public testing::TestWithParam<Study> {};

TEST_P(SlidingConvergence, HasItsOrder) {
  const Study& study = GetParam();
  const model::SegmentResult exact = solve(study.stretch, study.voltage, 384);
  std::vector<double> pressure, slip;
  for (int count : study.counts) {
    const model::SegmentResult result = solve(study.stretch, study.voltage, count);
    pressure.push_back(std::fabs(result.pressure_actuated - exact.pressure_actuated) /
                       exact.pressure_actuated);
    slip.push_back(std::fabs(result.slip_max - exact.slip_max) / exact.slip_max);
    ASSERT_GT(pressure.back(), 0);
    // The estimate is on the safe side, and still of use.
    EXPECT_GT(result.discretisation_error, pressure.back()) << count;
    EXPECT_LT(result.discretisation_error, 1e5 * pressure.back() + 1e-9) << count;
  }
  EXPECT_GT(fitted_order(study.counts, pressure), study.pressure_order);
  EXPECT_GT(fitted_order(study.counts, slip), study.slip_order);
}

// Smooth states converge with the sixth order.
INSTANTIATE_TEST_SUITE_P(Studies, SlidingConvergence,
                         testing::Values(Study{"rest", 1.8, 0, {6, 9, 12, 18}, 5, 3},
                                         Study{"actuated", 1.8, 11.3e3, {6, 12, 24, 48}, 5, 3},
                                         Study{"steep", 2.2, 0, {12, 24, 48, 96}, 5, 3},
                                         Study{"steep_actuated", 2.2, 11.3e3, {24, 48, 96, 192}, 4, 3}),
                         [](const auto& study) { return std::string(study.param.name); });

// Where the bandage lifts off within the segment the order is two. The error then depends on where in its
// element the kink is, so it is the mean over several stretches that is fitted.
TEST(SlidingConvergenceOfKinks, IsOfSecondOrder) {
  const std::vector<int> counts = {12, 24, 48, 96, 192};
  std::vector<double> pressure(counts.size(), 0.0);
  for (double stretch = 1.03; stretch < 1.1; stretch += 0.0037) {
    const model::SegmentResult exact = solve(stretch, 11.3e3, 768);
    ASSERT_EQ(exact.status, model::Status::lifted) << stretch;
    for (std::size_t k = 0; k < counts.size(); ++k) {
      const model::SegmentResult result = solve(stretch, 11.3e3, counts[k]);
      const double error = std::fabs(result.pressure_actuated / exact.pressure_actuated - 1);
      EXPECT_GT(result.discretisation_error, 0.2 * error - 1e-6) << stretch << ", " << counts[k];
      pressure[k] += error;
    }
  }
  EXPECT_GT(fitted_order(counts, pressure), 1.9);
}

// 24 slices are good for a part in a million at rest up to stretch 2.2, for a part in 1e5 under voltage.
TEST(SlidingAccuracy, OfTheDefault) {
  for (double stretch : {1.2, 1.4, 1.8, 2.2})
    for (double voltage : {0.0, 11.3e3}) {
      const model::SegmentResult coarse = solve(stretch, voltage, model::Discretisation().sliding_count),
                                 fine = solve(stretch, voltage, 192);
      EXPECT_NEAR(coarse.pressure_actuated, fine.pressure_actuated,
                  (voltage > 0 ? 1e-5 : 1e-6) * fine.pressure_actuated)
          << stretch;
    }
}

}  // namespace
}  // namespace gaiter::solvers
