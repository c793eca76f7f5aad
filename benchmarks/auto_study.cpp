// SPDX-License-Identifier: BSD-2-Clause
// Does -fidelity auto keep what it promises, and at what cost? Over Sobol scenes (sobol_scenes.hpp) and for
// tolerances 1e-1 to 1e-6, up to the slice model, whose full resolution is the truth: share of scenes whose
// true error (the larger one of the pressures at rest and under voltage, or of -output) is below the
// tolerance; cost, planning and repeated solves included, over that of the cheapest rung that would have
// done, found by hindsight among rigid, first order and slices with 1 to 64 points over the height and 1 to
// 12 through the wall; the same over what that rung costs with its own estimate of its error, as options
// reach it; measured seconds of both; and how the true error compares with the estimated one. Costs are those
// of plan_cost, whose fit to measured times is printed first. Usage: auto_study [-scenes 2000] [-skip 0]
// [-repeats 10] [-tell TOL] [-output volume_change|actuation_drop]
//   [-material neo_hookean]
#include <petscsys.h>

#include <algorithm>
#include <cstdio>
#include <map>
#include <tuple>

#include "auto_study.hpp"
#include "gaiter/petsc/check.hpp"
#include "gaiter/petsc/session.hpp"
#include "gaiter/physics/segment_forecast.hpp"
#include "gaiter/solvers/auto_model.hpp"
#include "processor_time.hpp"
#include "sobol_scenes.hpp"

namespace {

using namespace gaiter;
using model::Fidelity;
using solvers::SegmentTask;
using solvers::SlicePlan;
using study::error_of, study::quantile;

std::vector<model::SegmentResult> solve(const std::vector<model::Scene>& scenes,
                                        const std::vector<SlicePlan>& plans, double* seconds = nullptr) {
  static solvers::SliceModel model(PETSC_COMM_SELF);
  std::vector<model::SegmentResult> results(scenes.size());
  const double start = processor_seconds();
  // In packs as full and batches as large as AutoModel's.
  std::map<Fidelity, std::vector<std::size_t>> groups;
  for (std::size_t i = 0; i < scenes.size(); ++i) groups[plans[i].fidelity].push_back(i);
  for (auto& [fidelity, chosen] : groups) {
    const auto key = [&](std::size_t i) {
      return std::tuple(plans[i].cuts.size(), plans[i].slice_count, plans[i].wall_points, i);
    };
    std::sort(chosen.begin(), chosen.end(), [&](std::size_t a, std::size_t b) { return key(a) < key(b); });
    for (std::size_t first = 0, end = 0; first < chosen.size(); first = end) {
      std::vector<SegmentTask> tasks;
      for (std::size_t held = 0; end < chosen.size() && held < 2048; ++end) {
        const SlicePlan& plan = plans[chosen[end]];
        held += plan.slice_count * (1 + plan.cuts.size());
        tasks.push_back({&scenes[chosen[end]], 0, &plan});
      }
      const auto found = model.solve(tasks);
      for (std::size_t k = first; k < end; ++k) results[chosen[k]] = found[k - first];
    }
  }
  if (seconds) *seconds = processor_seconds() - start;
  return results;
}

// What a rung's estimate of its own errors costs, for which nothing is planned [s a segment].
double cost_of_estimate(const std::vector<model::Scene>& scenes, int repeats) {
  static solvers::SliceModel model(PETSC_COMM_SELF);
  const SlicePlan plan{Fidelity::rigid, 1, 1, {}};
  std::vector<model::Scene> alone = scenes;
  std::vector<SegmentTask> planned, unplanned;
  for (model::Scene& scene : alone) {
    scene.fidelity = Fidelity::rigid;
    scene.discretisation.slice_count = scene.discretisation.wall_points = 1;
    planned.push_back({&scene, 0, &plan});
    unplanned.push_back({&scene, 0});
  }
  double with = 1e300, without = 1e300;
  for (int repeat = 0; repeat < repeats; ++repeat) {
    const double start = processor_seconds();
    (void)model.solve(planned);
    const double between = processor_seconds();
    (void)model.solve(unplanned);
    without = std::min(without, between - start);
    with = std::min(with, processor_seconds() - between);
  }
  return (with - without) / static_cast<double>(scenes.size());
}

void tell(const model::Scene& scene, const SlicePlan& plan, const SlicePlan& best,
          const model::SegmentResult& found, double error, double estimate, double ratio) {
  const model::Segment& leg = scene.leg.segments[0];
  physics::SegmentForecast forecast(scene, 0);
  forecast.analyse();
  std::printf(
      "  stretch %.3f wall %.3g mm mu %.2g taper %.3f: plan %d %dx%d cuts %zu (h %.1e w %.1e m %.1e), found "
      "%dx%d, best %d %dx%d, error %.1e, told %.1e, gain %.2f, cost ratio %.2f\n",
      scene.bandage.modules[0].stretch, 1e3 * scene.bandage.thickness, scene.bandage.ogden[0].mu,
      0.5 * (leg.upper_radius - leg.lower_radius) / leg.mean_radius(), static_cast<int>(plan.fidelity),
      plan.slice_count, plan.wall_points, plan.cuts.size(), plan.height_error, plan.wall_error,
      plan.model_error, found.slice_count, found.wall_points, static_cast<int>(best.fidelity),
      best.slice_count, best.wall_points, error, estimate, forecast.gain(), ratio);
}

struct Rung {
  SlicePlan plan;
  std::vector<double> error, cost;
};

}  // namespace

int main(int argc, char** argv) {
  petsc::Session session(std::vector<std::string>(argv + 1, argv + argc));
  PetscInt count = 2000, skip = 0, repeats = 10;
  petsc::check(PetscOptionsGetInt(nullptr, nullptr, "-scenes", &count, nullptr));
  petsc::check(PetscOptionsGetInt(nullptr, nullptr, "-skip", &skip, nullptr));
  petsc::check(PetscOptionsGetInt(nullptr, nullptr, "-repeats", &repeats, nullptr));
  PetscReal only = 0;
  petsc::check(PetscOptionsGetReal(nullptr, nullptr, "-tell", &only, nullptr));
  char word[64] = "";
  petsc::check(PetscOptionsGetString(nullptr, nullptr, "-output", word, sizeof word, nullptr));
  const bool volume = std::string(word) == "volume_change", drop = std::string(word) == "actuation_drop";
  double model::SegmentResult::*const output = volume ? &model::SegmentResult::volume_change
                                               : drop ? &model::SegmentResult::actuation_drop
                                                      : nullptr;
  petsc::check(PetscOptionsGetString(nullptr, nullptr, "-material", word, sizeof word, nullptr));
  std::vector<model::Scene> scenes = sobol::scenes(static_cast<int>(count), static_cast<int>(skip));
  const std::size_t size = scenes.size();
  for (std::size_t i = 0; i < size; ++i) {
    if (std::string(word) != "neo_hookean") break;
    scenes[i].leg.material = model::LegMaterial::neo_hookean;
    scenes[i].leg.young_modulus = 1e4 * std::pow(300, static_cast<double>(i % 97) / 96);  // [Pa]
  }

  std::vector<SlicePlan> exact(size);
  for (std::size_t i = 0; i < size; ++i) {
    physics::SegmentForecast forecast(scenes[i], 0);
    forecast.analyse();
    exact[i] = {Fidelity::slice, 64, 24, forecast.cuts()};
  }
  const auto truth = solve(scenes, exact);
  std::vector<bool> counts(size);
  std::map<int, int> statuses;
  for (std::size_t i = 0; i < size; ++i) {
    counts[i] = model::trustworthy(truth[i].status) && truth[i].pressure_rest > 0;
    ++statuses[static_cast<int>(truth[i].status)];
  }
  std::printf("%zu scenes; statuses of the truth:", size);
  for (const auto& [status, number] : statuses) std::printf(" %d: %d", status, number);
  std::printf("\n\nmeasured over predicted time of a rung, scenes in contact from end to end\n");

  std::vector<Rung> rungs;
  for (Fidelity fidelity : {Fidelity::rigid, Fidelity::first_order, Fidelity::slice})
    for (int n : {1, 2, 3, 4, 5, 6, 8, 12, 16, 24, 32, 64})
      for (int q : {1, 2, 3, 4, 6, 8, 12}) {
        Rung rung{{fidelity, n, q, {}}, {}, {}};
        double seconds = 0;
        std::vector<SlicePlan> plans(size, rung.plan);
        for (std::size_t i = 0; i < size; ++i) plans[i].cuts = n >= 4 ? exact[i].cuts : std::vector<double>{};
        const auto found = solve(scenes, plans);
        for (std::size_t i = 0; i < size; ++i) {
          rung.error.push_back(error_of(found[i], truth[i], output));
          rung.cost.push_back(solvers::plan_cost(scenes[i], 0, plans[i]));
        }
        if ((n == 1 || n == 4 || n == 12) && (q == 1 || q == 4)) {
          // Where the bandage leaves the leg, its own equilibrium is looked for, which no fit has.
          std::vector<model::Scene> touching;
          double expected = 0;
          for (std::size_t i = 0; i < size; ++i)
            if (truth[i].status == model::Status::contact) {
              touching.push_back(scenes[i]);
              expected += rung.cost[i];
            }
          double least = 1e300;
          for (int repeat = 0; repeat < repeats; ++repeat) {
            (void)solve(touching, std::vector<SlicePlan>(touching.size(), rung.plan), &seconds);
            least = std::min(least, seconds);
          }
          std::printf("  %-11s %3d x %2d  %6.2f us, %5.2f of predicted\n",
                      fidelity == Fidelity::rigid   ? "rigid"
                      : fidelity == Fidelity::slice ? "slice"
                                                    : "first order",
                      n, q, 1e6 * least / static_cast<double>(touching.size()), least / expected);
        }
        rungs.push_back(std::move(rung));
      }

  const double estimate_cost = cost_of_estimate(scenes, 10 * repeats);
  std::printf("\na rung's estimate of its own errors: %.3f us\n", 1e6 * estimate_cost);
  std::printf("\n%8s %9s %9s %9s %8s %10s %8s %8s %9s %9s   %s\n", "TOL", "share", "worst", "cost 50%",
              "95 %", "told: 50%", "95 %", "time", "plan us", "solve us", "rungs: rigid, first order, slice");
  study::ErrorRatios ratios_of_errors(1e-13);
  for (double tolerance : {1e-1, 1e-2, 1e-3, 1e-4, 1e-5, 1e-6}) {
    std::vector<model::Scene> asked = scenes;
    std::vector<SegmentTask> tasks;
    for (model::Scene& scene : asked) {
      scene.goal.accuracy = tolerance;
      scene.goal.up_to = Fidelity::slice;
      if (output) scene.goal.pressure_rest = scene.goal.pressure_actuated = false;
      scene.goal.volume_change = volume;
      scene.goal.actuation_drop = drop;
      tasks.push_back({&scene, 0});
    }
    static solvers::AutoModel model(PETSC_COMM_SELF);
    auto found = model.solve(tasks);
    std::vector<SlicePlan> plans;
    std::vector<SlicePlan> best(size);
    for (std::size_t i = 0; i < size; ++i) {
      double cheapest = 1e300;
      best[i] = exact[i];
      for (const Rung& rung : rungs)
        if (rung.error[i] <= tolerance && rung.cost[i] < cheapest) {
          cheapest = rung.cost[i];
          best[i] = rung.plan;
          best[i].cost = cheapest;
          if (best[i].slice_count >= 4) best[i].cuts = exact[i].cuts;
        }
    }
    // In turn, so that all see the same machine; the least of each, for others use it too.
    double seconds = 1e300, planning = 1e300, hindsight = 1e300;
    for (int repeat = 0; repeat < repeats; ++repeat) {
      const double start = processor_seconds();
      found = model.solve(tasks);
      const double solved = processor_seconds();
      solvers::plan_segments(tasks, plans);
      planning = std::min(planning, processor_seconds() - solved);
      seconds = std::min(seconds, solved - start);
      double once = 0;
      (void)solve(asked, best, &once);
      hindsight = std::min(hindsight, once);
    }
    std::vector<double> ratios, ratios_of_told;
    int good = 0, all = 0;
    double worst = 0;
    std::map<Fidelity, int> chosen;
    for (std::size_t i = 0; i < size; ++i) {
      const double cheapest = best[i].cost;
      if (!counts[i]) continue;
      const double error = error_of(found[i], truth[i], output);
      const double estimate = found[i].discretisation_error + model.plans()[i].expected_model_error();
      ++all;
      good += error <= tolerance;
      worst = std::max(worst, error / tolerance);
      ++chosen[found[i].fidelity];
      if (cheapest > 0) {
        ratios.push_back(model.plans()[i].cost / cheapest);
        ratios_of_told.push_back(model.plans()[i].cost / (cheapest + estimate_cost));
      }
      ratios_of_errors.add(tolerance, error, estimate);
      if (tolerance == only && (error > tolerance || ratios.back() > 2.5))
        tell(asked[i], model.plans()[i], best[i], found[i], error, estimate, ratios.back());
    }
    std::printf("%8.0e %8.2f%% %9.2g %9.2f %8.2f %10.2f %8.2f %8.2f %9.2f %9.2f   %d %d %d\n", tolerance,
                100.0 * good / all, worst, quantile(ratios, 0.5), quantile(ratios, 0.95),
                quantile(ratios_of_told, 0.5), quantile(ratios_of_told, 0.95), seconds / hindsight,
                1e6 * planning / static_cast<double>(size), 1e6 * seconds / static_cast<double>(size),
                chosen[Fidelity::rigid], chosen[Fidelity::first_order], chosen[Fidelity::slice]);
  }
  ratios_of_errors.print();
}
