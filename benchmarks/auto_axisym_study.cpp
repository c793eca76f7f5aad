// SPDX-License-Identifier: BSD-2-Clause
// Does -fidelity auto keep what it promises, and at what cost, where finite elements are the truth? Over
// Sobol scenes (sobol_scenes.hpp), whose voltages are 0 to 80 % of the last one at which finite elements are
// stable (on the coarsest mesh; sought up to the one that lifts off), those that have a stable state in
// contact on a mesh of -refine, for tolerances 1e-1, 1e-2 and 1e-3:
//   share of scenes whose true error (the larger one of the pressures at rest and under voltage) is below the
//   tolerance; the models taken;
//   cost over that of the cheapest model that would have done, found by hindsight among slices (6 x 3
//   points), sliding slices and meshes; and among the same models where hindsight must also know: the
//   cheapest with the cheapest estimate (closed form, the finite elements' residual, the mesh's own) that
//   says so; how the true error compares with the estimated one.
// Costs are processor time a segment, of auto and hindsight alike: slices among 256 of the same, sliding
// slices among 16, meshes alone. Scenes without a stable state: what auto makes of them, and in which time.
// Usage: auto_axisym_study [-scenes 100] [-skip 0] [-refine 1] [-tell 1e-2]
#include <petscsys.h>

#include <algorithm>
#include <cstdio>
#include <limits>
#include <map>

#include "auto_study.hpp"
#include "gaiter/petsc/check.hpp"
#include "gaiter/petsc/session.hpp"
#include "gaiter/physics/model_error.hpp"
#include "gaiter/solvers/auto_model.hpp"
#include "gaiter/solvers/axisym_model.hpp"
#include "gaiter/solvers/residual_estimate.hpp"
#include "gaiter/solvers/sliding_model.hpp"
#include "processor_time.hpp"
#include "sobol_scenes.hpp"

namespace {

using namespace gaiter;
using model::Fidelity;
using model::SegmentResult;
using solvers::SegmentTask;
using study::error_of, study::quantile;

constexpr double never = std::numeric_limits<double>::infinity();
constexpr double share_of_spread = 0.4;  // as in solvers/auto_climb.cpp
constexpr std::size_t many_slices = 256, many_sliding = 16;
constexpr int repeats = 3;
constexpr double truth_error = 1e-4;
constexpr int finest = 3;

// Of each of so many equal tasks [s]; the shortest of a few.
template <typename Solve>
double seconds_each(std::size_t many, const SegmentTask& task, Solve&& solve) {
  const std::vector<SegmentTask> tasks(many, task);
  double shortest = never;
  for (int repeat = 0; repeat < (many > 1 ? repeats : 1); ++repeat) {
    const double start = processor_seconds();
    solve(tasks);
    shortest = std::min(shortest, processor_seconds() - start);
  }
  return shortest / static_cast<double>(many);
}

// What an estimate says of a model's pressures, and what that takes.
struct Estimate {
  double error = never, cost = 0;
};

struct Rung {
  SegmentResult result;
  double error = 0, cost = 0;
  std::vector<Estimate> estimates;

  double known_cost(double tolerance) const {
    double cheapest = never;
    for (const Estimate& estimate : estimates)
      if (estimate.error <= tolerance) cheapest = std::min(cheapest, cost + estimate.cost);
    return cheapest;
  }
};

struct Known {
  model::Scene scene;
  SegmentResult truth;
  std::vector<Rung> rungs;  // slices, sliding slices, meshes
};

double larger(double rest, double actuated) {
  return std::max(std::fabs(rest), std::fabs(actuated));
}

Estimate by_residual(const SegmentTask& task, const SegmentResult& own, Fidelity fidelity) {
  const double start = processor_seconds();
  const solvers::ResidualEstimate found = solvers::estimate_by_residual(task, own, fidelity);
  const double cost = processor_seconds() - start;
  if (!found.reliable) return {never, cost};
  const double actuated = std::isnan(found.pressure_actuated) ? 0 : found.pressure_actuated;
  return {own.discretisation_error + larger(found.pressure_rest, actuated) + share_of_spread * found.spread,
          cost};
}

Known solve_all(const model::Scene& scene, int refine) {
  Known known{scene, {}, std::vector<Rung>(2)};
  Rung &slices = known.rungs[0], &sliding = known.rungs[1];
  const SegmentTask task{&known.scene, 0};
  static solvers::SliceModel slice_model(PETSC_COMM_SELF);
  const solvers::SlicePlan plan{};
  const SegmentTask planned{&known.scene, 0, &plan};
  slices.cost = seconds_each(many_slices, planned,
                             [&](const auto& tasks) { slices.result = slice_model.solve(tasks)[0]; });
  sliding.cost = seconds_each(many_sliding, task, [&](const auto& tasks) {
    sliding.result = solvers::solve_sliding(PETSC_COMM_SELF, tasks)[0];
  });
  physics::ModelErrors errors;
  double closed_form = never;
  for (int repeat = 0; repeat < repeats; ++repeat) {
    const double start = processor_seconds();
    for (std::size_t k = 0; k < many_slices; ++k)
      errors = physics::model_errors(known.scene, 0, slices.result);
    closed_form = std::min(closed_form, (processor_seconds() - start) / many_slices);
  }
  const auto closed = [&](const physics::ModelError& error, const SegmentResult& own, double cost) {
    return Estimate{own.discretisation_error + larger(error.pressure_rest, error.pressure_actuated), cost};
  };
  slices.estimates = {closed(errors.slice, slices.result, closed_form),
                      by_residual(task, slices.result, Fidelity::slice)};
  sliding.estimates = {closed(errors.sliding, sliding.result, slices.cost + closed_form),
                       by_residual(task, sliding.result, Fidelity::sliding)};
  double own = 0;  // error of the last mesh
  for (int level = 0; level <= refine || (own > truth_error && level <= finest); ++level) {
    model::Scene one = scene;
    one.axisym.refine = level;
    Rung mesh;
    mesh.cost = seconds_each(1, {&one, 0}, [&](const auto& tasks) {
      mesh.result = solvers::solve_axisym(PETSC_COMM_SELF, tasks)[0];
    });
    mesh.estimates = {{mesh.result.discretisation_error, 0}};
    known.rungs.push_back(mesh);
    if (!model::trustworthy(mesh.result.status)) break;
    own = mesh.result.discretisation_error;
  }
  known.truth = known.rungs.back().result;
  for (Rung& rung : known.rungs) rung.error = error_of(rung.result, known.truth);
  return known;
}

// The same part of the last stable voltage of the finite elements instead of that of lift-off.
void below_last_stable(model::Scene& scene) {
  model::Scene probe = scene;
  const double lift_off = sobol::lift_off_voltage(scene);
  probe.bandage.modules[0].voltage = lift_off;
  probe.axisym.refine = 0;
  const SegmentTask task{&probe, 0};
  const double stable = solvers::solve_axisym(PETSC_COMM_SELF, {&task, 1})[0].voltage_stable;
  if (stable > 0) scene.bandage.modules[0].voltage *= std::min(1.0, stable / lift_off);
}

struct Found {
  SegmentResult result;
  double cost = 0;
};

Found by_auto(const model::Scene& scene) {
  static solvers::AutoModel model(PETSC_COMM_SELF);
  Found found;
  const auto solve = [&](const auto& tasks) { found.result = model.solve(tasks)[0]; };
  const SegmentTask task{&scene, 0};
  found.cost = seconds_each(1, task, solve);
  const Fidelity taken = found.result.fidelity;
  const bool slides = taken == Fidelity::sliding || taken == Fidelity::axisym;
  // What took longer than any sliding slices has asked the residual or solved a mesh.
  if (found.cost > 5e-3) return found;
  found.cost = seconds_each(slides ? many_sliding : many_slices, task, solve);
  return found;
}

void tell(const Known& one, const Found& found, double error, double ratio, double known_ratio) {
  const model::Segment& leg = one.scene.leg.segments[0];
  const model::Module& module = one.scene.bandage.modules[0];
  std::printf(
      "  stretch %.3f, wall %.3g mm, mu %.2g Pa, slope %.3f, radius %.1f mm, %.0f V: model %d, status %d, "
      "error %.1e, told %.1e, cost %.1e s, %.2g and %.2g times hindsight's;",
      module.stretch, 1e3 * one.scene.bandage.thickness, one.scene.bandage.ogden[0].mu,
      (leg.upper_radius - leg.lower_radius) / leg.height, 1e3 * leg.mean_radius(), module.voltage,
      static_cast<int>(found.result.fidelity), static_cast<int>(found.result.status), error,
      found.result.error_estimate, found.cost, ratio, known_ratio);
  for (std::size_t k = 0; k < 2; ++k)
    std::printf(" %s %.1e, closed form %.1e, residual %.1e;", k == 0 ? "slices" : "sliding",
                one.rungs[k].error, one.rungs[k].estimates[0].error, one.rungs[k].estimates[1].error);
  std::printf("\n");
}

}  // namespace

int main(int argc, char** argv) {
  petsc::Session session(std::vector<std::string>(argv + 1, argv + argc));
  PetscInt count = 100, skip = 0, refine = 1;
  PetscReal only = 0;
  petsc::check(PetscOptionsGetInt(nullptr, nullptr, "-scenes", &count, nullptr));
  petsc::check(PetscOptionsGetInt(nullptr, nullptr, "-skip", &skip, nullptr));
  petsc::check(PetscOptionsGetInt(nullptr, nullptr, "-refine", &refine, nullptr));
  petsc::check(PetscOptionsGetReal(nullptr, nullptr, "-tell", &only, nullptr));
  std::vector<Known> all, without;
  for (model::Scene& scene : sobol::scenes(static_cast<int>(count), static_cast<int>(skip))) {
    below_last_stable(scene);
    Known one = solve_all(scene, static_cast<int>(refine));
    const bool stable = model::trustworthy(one.truth.status) && one.truth.pressure_actuated > 0;
    (stable ? all : without).push_back(std::move(one));
  }
  std::printf("%zu of %d scenes have a stable state in contact on the mesh\n", all.size(),
              static_cast<int>(count));
  std::printf("error of slices, sliding, meshes; median:");
  for (std::size_t k = 0; !all.empty() && k < 3 + static_cast<std::size_t>(refine); ++k) {
    std::vector<double> errors;
    for (const Known& one : all) errors.push_back(one.rungs[k].error);
    std::printf(" %.1e", quantile(errors, 0.5));
  }
  std::printf("\n\n%8s %9s %9s | %9s %9s | %9s %9s | %6s %6s   %s\n", "TOL", "share", "worst", "cost 50%",
              "95 %", "known 50%", "95 %", "slices", "known",
              "rigid, first order, slice, sliding, axisym; residual asked or mesh tried");
  study::ErrorRatios error_ratios(1e-6);
  for (const double tolerance : {1e-1, 1e-2, 1e-3}) {
    std::vector<double> ratios, known_ratios;
    std::map<Fidelity, int> chosen;
    int good = 0, suffice = 0, told = 0, searched = 0;
    double worst = 0;
    for (Known& one : all) {
      one.scene.goal.accuracy = tolerance;
      one.scene.goal.up_to = Fidelity::axisym;
      const Found found = by_auto(one.scene);
      const double error = error_of(found.result, one.truth);
      good += error <= tolerance;
      worst = std::max(worst, error / tolerance);
      ++chosen[found.result.fidelity];
      searched += found.cost > 5e-3 && found.result.fidelity != Fidelity::axisym;
      suffice += one.rungs[0].error <= tolerance;
      told += one.rungs[0].error <= tolerance && one.rungs[0].estimates[0].error <= tolerance;
      double cheapest = never, known = never;
      for (const Rung& rung : one.rungs) {
        if (rung.error <= tolerance) cheapest = std::min(cheapest, rung.cost);
        known = std::min(known, rung.known_cost(tolerance));
      }
      ratios.push_back(found.cost / cheapest);
      known_ratios.push_back(found.cost / known);
      error_ratios.add(tolerance, error, found.result.error_estimate);
      if (error > tolerance || (tolerance == only && ratios.back() > 3))
        tell(one, found, error, ratios.back(), known_ratios.back());
    }
    std::printf("%8.0e %8.2f%% %9.2g | %9.2f %9.3g | %9.2f %9.3g | %6d %6d   %d %d %d %d %d; %d\n", tolerance,
                100.0 * good / static_cast<double>(std::max<std::size_t>(all.size(), 1)), worst,
                quantile(ratios, 0.5), quantile(ratios, 0.95), quantile(known_ratios, 0.5),
                quantile(known_ratios, 0.95), suffice, told, chosen[Fidelity::rigid],
                chosen[Fidelity::first_order], chosen[Fidelity::slice], chosen[Fidelity::sliding],
                chosen[Fidelity::axisym], searched);
  }
  error_ratios.print();
  std::printf("\n%zu scenes without a stable state: auto's status and seconds, the mesh's seconds\n",
              without.size());
  for (const double tolerance : {1e-1, 1e-2, 1e-3}) {
    std::map<std::pair<Fidelity, model::Status>, std::vector<double>> seconds;
    std::vector<double> of_meshes;
    for (Known& one : without) {
      one.scene.goal.accuracy = tolerance;
      one.scene.goal.up_to = Fidelity::axisym;
      const Found found = by_auto(one.scene);
      seconds[{found.result.fidelity, found.result.status}].push_back(found.cost);
      of_meshes.push_back(one.rungs.back().cost);
    }
    std::printf("%8.0e", tolerance);
    for (const auto& [key, times] : seconds)
      std::printf("  model %d status %d: %zu (%.1e s)", static_cast<int>(key.first),
                  static_cast<int>(key.second), times.size(), quantile(times, 0.5));
    std::printf("  mesh: %.1e s\n", quantile(of_meshes, 0.5));
  }
}
