// SPDX-License-Identifier: BSD-2-Clause
// Slices in single precision, or with Newton's method stopped early, against the same in full: the estimated
// error holds what is lost, wherever rounding is amplified, and statuses stay.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "model_error_draws.hpp"
#include "random_slices.hpp"
#include "slice_tasks.hpp"

namespace {

using namespace gaiter;
using model::SlicePrecision, model::Status;

struct Loss {
  std::vector<double> share;  // of the estimated error that is true
  std::vector<double> estimate;
  int other_status = 0;
};

// At most 1, which is no digit left.
double relative(double value, double exact) {
  const double larger = std::max(value, exact);
  return larger > 0 ? std::fabs(value - exact) / larger : 0;
}

// Solves all in full and with less, and checks each pressure.
Loss compare(std::vector<model::Scene> scenes, const std::string& what,
             SlicePrecision precision = SlicePrecision::in_single, double newton_tolerance = 1e-12) {
  SCOPED_TRACE(what);
  const auto exact = solvers::solve_segments(PETSC_COMM_SELF, tasks::all_segments(scenes));
  for (model::Scene& scene : scenes) {
    scene.discretisation.slice_precision = precision;
    scene.discretisation.newton_tolerance = newton_tolerance;
  }
  const auto found = solvers::solve_segments(PETSC_COMM_SELF, tasks::all_segments(scenes));
  Loss loss;
  for (std::size_t i = 0; i < exact.size(); ++i) {
    const auto &single = found[i], &full = exact[i];
    if (single.status != full.status) ++loss.other_status;
    if (!model::trustworthy(full.status) || !model::trustworthy(single.status)) continue;
    const double error = std::max(relative(single.pressure_rest, full.pressure_rest),
                                  relative(single.pressure_actuated, full.pressure_actuated));
    // What both lack is no loss of this precision.
    EXPECT_LE(error, single.discretisation_error)
        << "segment " << i << ": " << full.pressure_rest << " " << full.pressure_actuated << " Pa, status "
        << static_cast<int>(full.status);
    if (full.pressure_rest > 0) {
      loss.share.push_back(error / single.discretisation_error);
      loss.estimate.push_back(single.discretisation_error);
    }
  }
  for (auto* values : {&loss.share, &loss.estimate}) std::ranges::sort(*values);
  if (!loss.share.empty())
    std::printf(
        "%-44s %5zu: error/estimate median %.1e most %.1e; estimate median %.1e most %.1e; status %d\n",
        what.c_str(), loss.share.size(), loss.share[loss.share.size() / 2], loss.share.back(),
        loss.estimate[loss.estimate.size() / 2], loss.estimate.back(), loss.other_status);
  return loss;
}

// Largest voltage at which double precision still finds the bandage on the leg, to 1e-13.
double lift_off(model::Scene scene) {
  double low = 0, high = 1e6;
  for (int k = 0; k < 60; ++k) {
    const double middle = 0.5 * (low + high);
    scene.bandage.modules[0].voltage = middle;
    (tasks::solve_one(scene).pressure_actuated > 0 ? low : high) = middle;
  }
  return low;
}

TEST(SinglePrecision, OfRandomSlices) {
  for (const auto material : {model::LegMaterial::compliance, model::LegMaterial::neo_hookean}) {
    samples::Sampler sampler(7);
    std::vector<model::Scene> scenes;
    for (int k = 0; k < 1500; ++k) scenes.push_back(sampler.scene(material, 1 + k % 3));
    const Loss loss =
        compare(scenes, material == model::LegMaterial::compliance ? "compliance" : "neo-Hookean");
    EXPECT_LE(loss.other_status, 2);
    EXPECT_GT(loss.share.size(), 1000u);
    EXPECT_LT(loss.estimate[loss.estimate.size() / 2], 2e-5);
    EXPECT_GT(loss.share[loss.share.size() / 2], 1e-3);  // no wild guess
  }
}

TEST(EarlyEnd, OfRandomSlices) {
  for (const auto material : {model::LegMaterial::compliance, model::LegMaterial::neo_hookean}) {
    samples::Sampler sampler(11);
    std::vector<model::Scene> scenes;
    for (int k = 0; k < 1500; ++k) scenes.push_back(sampler.scene(material, 1));
    for (const double tolerance : {1e-1, 1e-3, 1e-6}) {
      const Loss loss =
          compare(scenes, "Newton to " + std::to_string(tolerance), SlicePrecision::in_double, tolerance);
      EXPECT_EQ(loss.other_status, 0);
      EXPECT_GT(loss.share.size(), 1000u);
      EXPECT_GT(loss.share.back(), 1e-2);  // something is lost
    }
  }
}

// By a plan: less work, the same statuses, no more of a pressure left than allowed or than is told; and the
// options' word counts for more.
TEST(EarlyEnd, AsFarAsAPlanAllows) {
  for (const auto material : {model::LegMaterial::compliance, model::LegMaterial::neo_hookean}) {
    samples::Sampler sampler(12);
    std::vector<model::Scene> scenes;
    for (int k = 0; k < 1500; ++k) scenes.push_back(sampler.scene(material, 1));
    const auto solve = [&](double leaves) {
      const solvers::SlicePlan plan{.slice_count = 1, .wall_points = 8, .newton_leaves = leaves};
      std::vector<solvers::SegmentTask> tasks;
      for (const model::Scene& scene : scenes) tasks.push_back({&scene, 0, &plan});
      return solvers::solve_segments(PETSC_COMM_SELF, tasks);
    };
    const auto exact = solve(0);
    for (const double leaves : {1e-2, 1e-4, 1e-7}) {
      const auto found = solve(leaves);
      int steps = 0, steps_of_exact = 0, pressing = 0;
      for (std::size_t i = 0; i < scenes.size(); ++i) {
        ASSERT_EQ(found[i].status, exact[i].status) << i;
        steps += found[i].iterations;
        steps_of_exact += exact[i].iterations;
        if (!(exact[i].pressure_actuated > 0)) continue;
        ++pressing;
        const double told = found[i].discretisation_error, sure = exact[i].discretisation_error;
        EXPECT_LE(told, 1.001 * (sure + leaves)) << i;
        EXPECT_NEAR(found[i].pressure_rest, exact[i].pressure_rest, (told + sure) * exact[i].pressure_rest)
            << i;
        EXPECT_NEAR(found[i].pressure_actuated, exact[i].pressure_actuated,
                    (told + sure) * exact[i].pressure_actuated)
            << i;
        EXPECT_GE(found[i].actuation_drop, 0) << i;
      }
      EXPECT_LT(steps, 0.95 * steps_of_exact) << leaves;
      EXPECT_GT(pressing, 700);
    }
    const tasks::Option tight("-slice_snes_rtol", "1e-12");
    const auto by_option = solve(1e-2);
    for (std::size_t i = 0; i < scenes.size(); ++i)
      EXPECT_TRUE(tasks::same_bits(tasks::numbers_of(by_option[i]), tasks::numbers_of(exact[i]))) << i;
  }
}

TEST(SinglePrecision, OfRandomCones) {
  std::vector<model::Scene> scenes;
  for (const ConeCase& cone : draw_cones(100, 600)) {
    scenes.push_back(scene_of(cone));
    scenes.back().discretisation.slice_count = 12;
    scenes.back().bandage.modules[0].voltage = 3e3;
  }
  std::vector<model::Scene> alike[2];
  for (model::Scene& scene : scenes)
    if (scene.bandage.ogden.size() == 2)
      alike[scene.leg.material == model::LegMaterial::neo_hookean].push_back(scene);
  for (const auto& some : alike) EXPECT_LE(compare(some, "cones").other_status, 2);
}

TEST(SinglePrecision, NextToSlackAndBesideLiftOff) {
  std::vector<model::Scene> scenes;
  for (double off = 1e-15; off < 0.1; off *= 10)
    for (const auto variant : {model::ComplianceVariant::published, model::ComplianceVariant::anchored}) {
      scenes.push_back(paper::cylinder(39.6e-3, 1 + off, 0));
      scenes.back().bandage.length_at = model::LengthAt::inner;
      scenes.back().leg.variant = variant;
    }
  EXPECT_EQ(compare(scenes, "stretch 1 + 1e-15 to 0.1").other_status, 0);
  scenes.clear();
  int lost = 0;
  for (const double stretch : {1.05, 1.3, 1.8}) {
    model::Scene scene = paper::cylinder(39.6e-3, stretch, 0);
    const double last = lift_off(scene);
    ASSERT_GT(last, 1e3);
    for (double off = 1e-1; off > 1e-11; off /= 10)
      for (const double side : {-1.0, 1.0}) {
        scene.bandage.modules[0].voltage = last * (1 + side * off);
        scenes.push_back(scene);
        lost += off < 1e-6;
      }
  }
  // Closer than a few 1e-7 the two may not agree on which side of lift-off they are.
  const Loss loss = compare(scenes, "beside lift-off");
  EXPECT_LE(loss.other_status, lost);
  EXPECT_LT(loss.estimate[loss.estimate.size() / 4], 1e-3);  // a part of 1e-4 off, either side
}

TEST(SinglePrecision, OfThickAndThinWallsAndSteepLaws) {
  std::vector<model::Scene> walls, laws, layers;
  for (const double stretch : {1.01, 1.4, 2.2, 6.0, 20.0})
    for (const double part : {1e-8, 1e-4, 0.1, 0.5, 0.9, 0.99}) {
      walls.push_back(paper::cylinder(39.6e-3, stretch, 1e3));
      walls.back().bandage.thickness = part * 39.6e-3 / stretch;
    }
  EXPECT_EQ(compare(walls, "walls of 1e-8 to 0.99 of the radius").other_status, 0);
  for (const double stretch : {1.01, 1.4, 2.2, 6.0, 20.0})
    for (const double alpha : {2.0, 12.0, 50.0, -2.0, -30.0, -50.0})
      for (const double mu : {1e-2, 1e3, 1e12}) {
        laws.push_back(paper::cylinder(39.6e-3, stretch, 0));
        laws.back().bandage.ogden = {{std::copysign(mu, alpha), alpha}};
      }
  const Loss loss = compare(laws, "exponents to 50, moduli 1e-2 to 1e12 Pa");
  EXPECT_EQ(loss.other_status, 0);
  EXPECT_GT(loss.share.size(), 80u);
  for (const int count : {1, 30, 1000}) {
    layers.push_back(paper::cylinder(39.6e-3, 1.6, 1e4 / count));
    layers.back().bandage.layers = count;
  }
  EXPECT_EQ(compare(layers, "layers").other_status, 0);
}

// Results are those of each slice alone.
TEST(SinglePrecision, DoesNotDependOnTheBatch) {
  samples::Sampler sampler(3);
  std::vector<model::Scene> scenes;
  for (int k = 0; k < 70; ++k) {
    scenes.push_back(sampler.scene(model::LegMaterial::compliance, 1));
    scenes.back().discretisation.slice_precision = SlicePrecision::in_single;
  }
  const auto tasks = tasks::all_segments(scenes);
  const auto together = solvers::solve_segments(PETSC_COMM_SELF, tasks);
  for (std::size_t t = 0; t < tasks.size(); ++t) {
    const auto alone = solvers::solve_segments(PETSC_COMM_SELF, {&tasks[t], 1})[0];
    EXPECT_TRUE(tasks::same_bits(tasks::numbers_of(alone), tasks::numbers_of(together[t]))) << t;
  }
}

// The rigid leg and the first-order correction have no estimate of rounding: they stay in double.
TEST(SinglePrecision, IsOfSlicesAlone) {
  model::Scene scene = paper::cylinder(39.6e-3, 1.6, 5e3);
  for (const auto fidelity : {model::Fidelity::rigid, model::Fidelity::first_order}) {
    scene.fidelity = fidelity;
    scene.discretisation.slice_precision = SlicePrecision::in_double;
    const auto full = tasks::solve_one(scene);
    scene.discretisation.slice_precision = SlicePrecision::in_single;
    EXPECT_TRUE(tasks::same_bits(tasks::numbers_of(full), tasks::numbers_of(tasks::solve_one(scene))));
  }
}

}  // namespace
