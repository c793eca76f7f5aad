// SPDX-License-Identifier: BSD-2-Clause
// Does -fidelity auto keep what it promises where finite elements are the truth? Over Sobol scenes
// (sobol_scenes.hpp; voltages to 80 % of the last one at which sliding slices are stable), those of which
// have a stable state on a mesh of -refine, and tolerances 1e-1, 1e-2 and 1e-3: share of scenes whose true
// error (the larger one of the pressures at rest and under voltage) is below the tolerance, the models
// chosen, and the cost over that of the cheapest model that would have done, found by hindsight among slices,
// sliding slices and meshes. Costs: processor time where a mesh was solved, else plan_cost. Usage:
// auto_axisym_study [-scenes 100] [-skip 0] [-refine 2]
#include <petscsys.h>

#include <algorithm>
#include <array>
#include <cstdio>
#include <map>

#include "gaiter/petsc/check.hpp"
#include "gaiter/petsc/session.hpp"
#include "gaiter/solvers/auto_model.hpp"
#include "gaiter/solvers/axisym_model.hpp"
#include "gaiter/solvers/sliding_model.hpp"
#include "processor_time.hpp"
#include "sobol_scenes.hpp"

namespace {

using namespace gaiter;
using model::Fidelity;
using solvers::SegmentTask;

double error_of(const model::SegmentResult& found, const model::SegmentResult& truth) {
  const auto relative = [](double a, double b) { return b > 0 ? std::fabs(a / b - 1) : std::fabs(a); };
  const double error = std::max(relative(found.pressure_rest, truth.pressure_rest),
                                relative(found.pressure_actuated, truth.pressure_actuated));
  return model::trustworthy(found.status) ? error : 1e300;
}

struct Rung {
  double error = 0, cost = 0;
};

struct Known {
  model::Scene scene;
  model::SegmentResult truth;
  std::vector<Rung> rungs;
};

std::vector<Rung> rungs_of(const model::Scene& scene, int refine, model::SegmentResult& truth) {
  const SegmentTask task{&scene, 0};
  std::vector<model::SegmentResult> found;
  std::vector<Rung> rungs;
  const auto add = [&](const model::SegmentResult& result, double cost) {
    found.push_back(result);
    rungs.push_back({0, cost});
  };
  const solvers::SlicePlan slices{};
  add(solvers::solve_segments(PETSC_COMM_SELF, {&task, 1})[0], solvers::plan_cost(scene, 0, slices));
  solvers::SlicePlan sliding{};
  sliding.fidelity = Fidelity::sliding;
  sliding.slice_count = scene.discretisation.sliding_count;
  add(solvers::solve_sliding(task).result, solvers::plan_cost(scene, 0, sliding));
  for (int level = 0; level <= refine; ++level) {
    model::Scene one = scene;
    one.axisym.refine = level;
    const SegmentTask meshed{&one, 0};
    const double start = processor_seconds();
    const model::SegmentResult result = solvers::solve_axisym(PETSC_COMM_SELF, {&meshed, 1})[0];
    add(result, processor_seconds() - start);
    if (!model::trustworthy(result.status)) break;
  }
  truth = found.back();
  for (std::size_t k = 0; k < rungs.size(); ++k) rungs[k].error = error_of(found[k], truth);
  return rungs;
}

// The same part of the last voltage at which the sliding slices are stable instead of that of lift-off.
void below_last_stable(model::Scene& scene) {
  double& voltage = scene.bandage.modules[0].voltage;
  const double wanted = voltage;
  voltage = wanted / 0.8;
  const SegmentTask task{&scene, 0};
  const model::SegmentResult sliding = solvers::solve_sliding(task).result;
  const double stable = sliding.voltage_stable;
  voltage =
      model::trustworthy(sliding.status) || !std::isfinite(stable) ? wanted : std::min(wanted, 0.8 * stable);
}

double quantile(std::vector<double> values, double part) {
  if (values.empty()) return 0;
  std::sort(values.begin(), values.end());
  return values[std::min(values.size() - 1,
                         static_cast<std::size_t>(part * static_cast<double>(values.size())))];
}

}  // namespace

int main(int argc, char** argv) {
  petsc::Session session(std::vector<std::string>(argv + 1, argv + argc));
  PetscInt count = 100, skip = 0, refine = 2;
  petsc::check(PetscOptionsGetInt(nullptr, nullptr, "-scenes", &count, nullptr));
  petsc::check(PetscOptionsGetInt(nullptr, nullptr, "-skip", &skip, nullptr));
  petsc::check(PetscOptionsGetInt(nullptr, nullptr, "-refine", &refine, nullptr));
  std::vector<Known> all;
  int tried = 0;
  for (model::Scene& scene : sobol::scenes(static_cast<int>(count), static_cast<int>(skip))) {
    ++tried;
    below_last_stable(scene);
    Known one{scene, {}, {}};
    one.rungs = rungs_of(one.scene, static_cast<int>(refine), one.truth);
    if (model::trustworthy(one.truth.status) && one.truth.pressure_actuated > 0)
      all.push_back(std::move(one));
  }
  std::printf("%zu of %d scenes have a stable state in contact on the mesh\n", all.size(), tried);
  std::printf("error of slices, sliding, meshes; median:");
  for (std::size_t k = 0; !all.empty() && k < all[0].rungs.size(); ++k) {
    std::vector<double> errors;
    for (const Known& one : all) errors.push_back(one.rungs[k].error);
    std::printf(" %.1e", quantile(errors, 0.5));
  }
  std::printf("\n%8s %9s %9s %9s %9s   %s\n", "TOL", "share", "worst", "cost 50%", "95 %",
              "rigid, first order, slice, sliding, axisym");
  for (const double tolerance : {1e-1, 1e-2, 1e-3}) {
    std::vector<double> ratios;
    std::map<Fidelity, int> chosen;
    int good = 0;
    double worst = 0;
    for (Known& one : all) {
      one.scene.goal.accuracy = tolerance;
      one.scene.goal.up_to = Fidelity::axisym;
      const SegmentTask task{&one.scene, 0};
      solvers::AutoModel model(PETSC_COMM_SELF);
      const double start = processor_seconds();
      const model::SegmentResult found = model.solve({&task, 1})[0];
      const double spent = processor_seconds() - start;
      const double error = error_of(found, one.truth);
      good += error <= tolerance;
      worst = std::max(worst, error / tolerance);
      ++chosen[found.fidelity];
      double cheapest = 1e300;
      for (const Rung& rung : one.rungs)
        if (rung.error <= tolerance) cheapest = std::min(cheapest, rung.cost);
      const double cost =
          found.fidelity == Fidelity::axisym ? spent : model.plans()[0].cost;
      ratios.push_back(cost / cheapest);
      if (error > tolerance)
        std::printf("  stretch %.3f, mu %.2g Pa, fidelity %d, error %.2e, told %.2e, status %d\n",
                    one.scene.bandage.modules[0].stretch, one.scene.bandage.ogden[0].mu,
                    static_cast<int>(found.fidelity), error, found.error_estimate,
                    static_cast<int>(found.status));
    }
    std::printf("%8.0e %8.2f%% %9.2g %9.2f %9.2f   %d %d %d %d %d\n", tolerance,
                100.0 * good / static_cast<double>(std::max<std::size_t>(all.size(), 1)), worst,
                quantile(ratios, 0.5), quantile(ratios, 0.95), chosen[Fidelity::rigid],
                chosen[Fidelity::first_order], chosen[Fidelity::slice], chosen[Fidelity::sliding],
                chosen[Fidelity::axisym]);
  }
}
