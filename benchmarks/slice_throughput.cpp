// SPDX-License-Identifier: BSD-2-Clause
// Equilibria of slices per second on one core, at equal accuracy (1e-10 of the pressure), start included: the
// batched SNES, the same Newton in a plain vectorised loop, one reused SNES per slice, the paper's fixed
// point, and the floor: nothing but the exponentials and logarithms that the equations ask for. Region 6 of
// the paper, surrogate elastomer (two Ogden terms), stretch 1.4 to 2.2, 3 wall points. Single precision stops
// at the 2e-7 that it can reach. Run it as it is; the
// ratios at the end compare medians of interleaved repetitions of this one run.
#include <benchmark/benchmark.h>
#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "gaiter/petsc/session.hpp"
#include "gaiter/physics/slice_kernel.hpp"
#include "gaiter/solvers/slice_solver.hpp"
#include "scalar_slice.hpp"

namespace {

using namespace gaiter;
using physics::Pack;
using physics::pack_width;
using physics::PackState;
using physics::SliceSystem;

constexpr double tolerance = 1e-10;
constexpr int batch = 8192;
constexpr int evaluations = 3;  // a slice needs: start, and twice the residual

SliceSystem make_system(std::size_t slices, bool single = false) {
  model::Leg leg;
  model::Segment ankle{"r6", 0.035, 0.03585, 0.04337, {0.013392, 7.898e-5, -0.01600, -0.001137}};
  model::Bandage bandage;
  bandage.ogden = {{21193, 3.507}, {10.514, 12.147}};
  SliceSystem system({physics::gauss_legendre(3), 2, 0, model::LegMaterial::compliance, single}, slices);
  for (std::size_t i = 0; i < slices; ++i) {
    model::Module module;
    module.stretch = 1.4 + 0.8 * static_cast<double>(i * 37 % slices) / static_cast<double>(slices);
    const double height = (static_cast<double>(i) + 0.5) / static_cast<double>(slices);
    const double radius = ankle.lower_radius + height * (ankle.upper_radius - ankle.lower_radius);
    const physics::Wall wall = physics::reference_wall(bandage, module, ankle.mean_radius(), radius);
    system.set(i, leg, ankle, bandage, wall, radius, 0);
  }
  return system;
}

double count_open(const PackState& state) {
  double open = 0;
  for (int i = 0; i < pack_width; ++i) open += state.open[i];
  return open;
}

void solve_plainly(const SliceSystem& system, double accuracy, std::vector<PackState>& states) {
  Pack rigid, strain, pressure;
  for (std::size_t k = 0; k < system.packs(); ++k) {
    PackState& state = states[k];
    physics::start_at_rest(system.shape(), system.pack(k), state, rigid);
    physics::evaluate_residual(system.shape(), system.pack(k), state);
    while (count_open(state) > 0) {
      physics::solve_blocks(state.strain_slope, state.bandage_slope, state.strain_residual,
                            state.pressure_residual, strain, pressure);
      physics::advance_newton(system.shape(), system.pack(k), pressure, accuracy, state);
    }
  }
}

// Largest relative error of the pressures, against the same equations solved to rounding.
double worst_error(const SliceSystem& system, const std::vector<PackState>& states) {
  std::vector<PackState> exact(system.packs());
  solve_plainly(system, 0, exact);
  double worst = 0;
  for (std::size_t k = 0; k < system.packs(); ++k)
    for (int i = 0; i < pack_width; ++i)
      worst = std::max(worst, std::fabs(states[k].pressure[i] / exact[k].pressure[i] - 1));
  return worst;
}

void finish(benchmark::State& run, const SliceSystem& system, const std::vector<PackState>& states) {
  run.SetItemsProcessed(static_cast<std::int64_t>(run.iterations() * system.slices()));
  run.counters["error"] = worst_error(make_system(system.slices()), states);
}

void loop(benchmark::State& run, bool single) {
  const SliceSystem system = make_system(run.range(0), single);
  std::vector<PackState> states(system.packs());
  for (auto _ : run) solve_plainly(system, tolerance, states);
  finish(run, system, states);
}

void plain_loop(benchmark::State& run) {
  loop(run, false);
}

void plain_loop_single(benchmark::State& run) {
  loop(run, true);
}

void batch_of(benchmark::State& run, bool single) {
  const SliceSystem system = make_system(run.range(0), single);
  std::vector<PackState> states(system.packs());
  solvers::SliceSolver solver(PETSC_COMM_SELF, system.packs(), model::SliceSolver::newton, 0);
  SNESSetTolerances(solver.snes(), PETSC_DEFAULT, tolerance, PETSC_DEFAULT, PETSC_DEFAULT, PETSC_DEFAULT);
  Pack rigid;
  for (auto _ : run)
    solver.solve(system, states, [&](std::size_t k) {
      physics::start_at_rest(system.shape(), system.pack(k), states[k], rigid);
    });
  finish(run, system, states);
}

void batched_snes(benchmark::State& run) {
  batch_of(run, false);
}

void batched_snes_single(benchmark::State& run) {
  batch_of(run, true);
}

// The bandage's pressure and slope alone.
void pressures(benchmark::State& run, bool single) {
  const SliceSystem system = make_system(run.range(0), single);
  Pack strain{}, pressure, slope;
  for (auto _ : run)
    for (std::size_t k = 0; k < system.packs(); ++k) {
      physics::bandage_pressure(system.shape(), system.pack(k), strain, pressure, slope);
      benchmark::DoNotOptimize(pressure);
    }
  run.SetItemsProcessed(static_cast<std::int64_t>(run.iterations() * system.slices()));
}

void bandage_pressures(benchmark::State& run) {
  pressures(run, false);
}

void bandage_pressures_single(benchmark::State& run) {
  pressures(run, true);
}

void snes_per_slice(benchmark::State& run) {
  const SliceSystem system = make_system(run.range(0));
  std::vector<PackState> states(system.packs());
  benchmarks::ScalarSliceSolver solver(tolerance);
  Pack rigid;
  for (auto _ : run)
    for (std::size_t k = 0; k < system.packs(); ++k) {
      physics::start_at_rest(system.shape(), system.pack(k), states[k], rigid);
      for (int i = 0; i < pack_width; ++i)
        states[k].pressure[i] =
            solver.solve(system, k * pack_width + i, states[k].strain[i], states[k].pressure[i]);
    }
  finish(run, system, states);
}

void fixed_point(benchmark::State& run) {
  const SliceSystem system = make_system(run.range(0));
  std::vector<PackState> states(system.packs());
  // The paper's stop is a change of the radius; this small one leaves 1e-10 of the pressure.
  solvers::SliceSolver solver(PETSC_COMM_SELF, system.packs(), model::SliceSolver::fixed_point, 1e-11);
  for (auto _ : run)
    solver.solve(system, states, [&](std::size_t k) { physics::start_fixed_point(true, states[k]); });
  finish(run, system, states);
}

// The transcendental functions of three evaluations, vectorised, and nothing else.
GAITER_MULTIVERSION void transcendental_functions(const Pack& argument, Pack& sum) {
  for (int call = 0; call < 3; ++call)  // wall points
    for (int i = 0; i < pack_width; ++i) sum[i] += log1p(argument[i] + call);
  for (int call = 0; call < 6 + 2; ++call)  // wall points x terms, and the leg's law
    for (int i = 0; i < pack_width; ++i) sum[i] += expm1(argument[i] - call);
}

void floor_of_functions(benchmark::State& run) {
  const std::size_t packs = run.range(0) / pack_width;
  Pack argument, sum{};
  for (int i = 0; i < pack_width; ++i) argument[i] = 1 + 0.01 * i;
  for (auto _ : run)
    for (std::size_t k = 0; k < evaluations * packs; ++k) transcendental_functions(argument, sum);
  benchmark::DoNotOptimize(sum);
  run.SetItemsProcessed(static_cast<std::int64_t>(run.iterations() * run.range(0)));
}

BENCHMARK(plain_loop)->Arg(batch)->Arg(1 << 20);
BENCHMARK(batched_snes)->Arg(batch)->Arg(1 << 20);
BENCHMARK(plain_loop_single)->Arg(batch);
BENCHMARK(batched_snes_single)->Arg(batch);
BENCHMARK(bandage_pressures)->Arg(batch)->Arg(128);
BENCHMARK(bandage_pressures_single)->Arg(batch)->Arg(128);
BENCHMARK(snes_per_slice)->Arg(batch);
BENCHMARK(fixed_point)->Arg(batch);
BENCHMARK(floor_of_functions)->Arg(batch);

// Prints as usual, and keeps the median rates.
class RatioReporter : public benchmark::ConsoleReporter {
 public:
  void ReportRuns(const std::vector<Run>& runs) override {
    ConsoleReporter::ReportRuns(runs);
    for (const Run& run : runs)
      if (run.run_type == Run::RT_Aggregate && run.aggregate_name == "median")
        rates_[run.run_name.function_name + "/" + run.run_name.args] = run.counters.at("items_per_second");
  }

  void print_ratios() const {
    const std::string size = "/" + std::to_string(batch), large = "/" + std::to_string(1 << 20);
    const auto ratio = [&](const std::string& what, const std::string& a, const std::string& b) {
      if (rates_.count(a) && rates_.count(b))
        fmt::print("{:<64}{:8.2f}\n", what, rates_.at(a) / rates_.at(b));
    };
    fmt::print("\nratios of median rates\n");
    ratio("batched SNES over plain vectorised loop, 8192 slices", "batched_snes" + size, "plain_loop" + size);
    ratio("batched SNES over plain vectorised loop, 1048576 slices", "batched_snes" + large,
          "plain_loop" + large);
    ratio("batched SNES over one SNES per slice", "batched_snes" + size, "snes_per_slice" + size);
    ratio("batched SNES over the paper's fixed point", "batched_snes" + size, "fixed_point" + size);
    ratio("floor (exponentials and logarithms alone) over batched SNES", "floor_of_functions" + size,
          "batched_snes" + size);
    for (const char* what : {"bandage_pressures", "plain_loop", "batched_snes"})
      ratio(std::string("single over double precision, ") + what, what + ("_single" + size), what + size);
  }

 private:
  std::map<std::string, double> rates_;
};

}  // namespace

int main(int argc, char** argv) {
  // Interleaved repetitions, so that a slow minute of the machine hits all alike; the command line comes
  // later and wins.
  std::vector<std::string> words{argv[0], "--benchmark_repetitions=7",
                                 "--benchmark_enable_random_interleaving=true",
                                 "--benchmark_report_aggregates_only=true"};
  words.insert(words.end(), argv + 1, argv + argc);
  std::vector<char*> pointers;
  for (std::string& word : words) pointers.push_back(word.data());
  int count = static_cast<int>(pointers.size());
  benchmark::Initialize(&count, pointers.data());
  gaiter::petsc::Session session({pointers.begin() + 1, pointers.begin() + count});
  RatioReporter reporter;
  benchmark::RunSpecifiedBenchmarks(&reporter);
  reporter.print_ratios();
  return 0;
}
