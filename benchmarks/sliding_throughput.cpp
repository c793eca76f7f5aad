// SPDX-License-Identifier: BSD-2-Clause
// Sliding segments per second on one core at 24 slices (8 cubic elements), 3 wall points, two Ogden terms, to
// 1e-10: segment r6 of the paper with the surrogate elastomer, stretch 1.4 to 2.2. The rest state by one
// batched SNES, start included; the same from rest to 11.3 kV; the model as users call it (wall points as it
// chooses them, the leg that does not give way beside the one that does, rest and actuated); and the parts of
// an iteration: energy, residual and tangent of a segment, and the factorisation with its solve.
#include <benchmark/benchmark.h>

#include <cstdint>

#include "gaiter/petsc/session.hpp"
#include "gaiter/solvers/sliding_model.hpp"
#include "gaiter/solvers/sliding_solver.hpp"

namespace {

using namespace gaiter;
using physics::pack_width;
using physics::SlidingState;
using physics::SlidingSystem;

constexpr int batch = 1024;  // segments
constexpr int slices = 24;
constexpr double tolerance = 1e-10;

std::vector<model::Scene> make_scenes(double voltage) {
  std::vector<model::Scene> scenes(batch);
  for (int i = 0; i < batch; ++i) {
    model::Scene& scene = scenes[i];
    scene.leg.segments = {{"r6", 0.035, 0.03585, 0.04337, {0.013392, 7.898e-5, -0.01600, -0.001137}}};
    scene.bandage.ogden = {{21193, 3.507}, {10.514, 12.147}};
    scene.bandage.permittivity = 7.41;
    scene.bandage.modules = {
        {.stretch = 1.4 + 0.8 * (i * 37 % batch) / batch, .length = 0, .voltage = voltage}};
    scene.discretisation.sliding_count = slices;
  }
  return scenes;
}

SlidingSystem make_system(const std::vector<model::Scene>& scenes) {
  SlidingSystem system({physics::sliding_elements(slices), false},
                       {physics::gauss_legendre(3), 2, 1, model::LegMaterial::compliance}, batch);
  for (std::size_t i = 0; i < scenes.size(); ++i) system.set(i, scenes[i], 0, system.slice_shape().wall);
  return system;
}

void start(const SlidingSystem& system, std::vector<SlidingState>& states) {
  for (std::size_t k = 0; k < system.packs(); ++k) physics::start_sliding(system, k, states[k]);
}

void finish(benchmark::State& run, const std::vector<SlidingState>& states) {
  run.SetItemsProcessed(static_cast<std::int64_t>(run.iterations()) * batch);
  double iterations = 0, failed = 0;
  for (const SlidingState& state : states)
    for (int i = 0; i < pack_width; ++i) {
      iterations += state.iterations[i] / batch;
      failed += state.failed[i];
    }
  run.counters["iterations"] = iterations;
  if (failed > 0) run.SkipWithError("segments without equilibrium");
}

void states(benchmark::State& run, bool actuated) {
  SlidingSystem system = make_system(make_scenes(11.3e3));
  std::vector<SlidingState> states(system.packs(), SlidingState(slices));
  solvers::SlidingSolver solver(PETSC_COMM_SELF, system.packs(), slices);
  SNESSetTolerances(solver.snes(), PETSC_DEFAULT, tolerance, PETSC_DEFAULT, PETSC_DEFAULT, PETSC_DEFAULT);
  for (auto _ : run) {
    system.energise(false);
    start(system, states);
    solver.solve(system, states);
    if (!actuated) continue;
    system.energise(true);
    for (SlidingState& state : states)
      for (int i = 0; i < pack_width; ++i) {
        state.open[i] = 1;
        state.last_step[i] = 0;
      }
    solver.solve(system, states);
  }
  finish(run, states);
}

void rest_state(benchmark::State& run) {
  states(run, false);
}

void rest_and_actuated(benchmark::State& run) {
  states(run, true);
}

void whole_model(benchmark::State& run) {
  const std::vector<model::Scene> scenes = make_scenes(11.3e3);
  std::vector<solvers::SegmentTask> tasks;
  for (const model::Scene& scene : scenes) tasks.push_back({&scene, 0});
  for (auto _ : run) {
    auto results = solvers::solve_sliding(PETSC_COMM_SELF, tasks);
    benchmark::DoNotOptimize(results.data());
  }
  run.SetItemsProcessed(static_cast<std::int64_t>(run.iterations()) * batch);
}

void evaluation(benchmark::State& run) {
  SlidingSystem system = make_system(make_scenes(11.3e3));
  system.energise(run.range(0) != 0);
  SlidingState state(slices);
  physics::start_sliding(system, 0, state);
  for (auto _ : run) {
    physics::evaluate_sliding(system, 0, state.unknown, state.tangent);
    benchmark::ClobberMemory();
  }
  run.SetItemsProcessed(static_cast<std::int64_t>(run.iterations()) * pack_width);
}

void factorisation(benchmark::State& run) {
  SlidingSystem system = make_system(make_scenes(0));
  SlidingState state(slices);
  physics::start_sliding(system, 0, state);
  physics::evaluate_sliding(system, 0, state.unknown, state.tangent);
  std::vector<physics::Pack> direction(2 * slices);
  physics::Pack negative;
  for (auto _ : run) {
    physics::solve_sliding_tangent(system, 0, state.tangent, state.tangent.residual, direction, negative);
    benchmark::ClobberMemory();
  }
  run.SetItemsProcessed(static_cast<std::int64_t>(run.iterations()) * pack_width);
}

BENCHMARK(rest_state);
BENCHMARK(rest_and_actuated);
BENCHMARK(whole_model);
BENCHMARK(evaluation)->ArgName("voltage")->Arg(0)->Arg(1);
BENCHMARK(factorisation);

}  // namespace

int main(int argc, char** argv) {
  benchmark::Initialize(&argc, argv);
  gaiter::petsc::Session session({argv + 1, argv + argc});
  benchmark::RunSpecifiedBenchmarks();
  return 0;
}
