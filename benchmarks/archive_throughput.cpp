// SPDX-License-Identifier: BSD-2-Clause
// What the archive takes, on one rank and the disk of the current folder: designs of 6 segments per second
// through store(), which compresses and waits for the disk to have the chunk before; the parts of that; the
// same values through HDF5's own shuffle and deflate; plain bytes to the disk; and the merge at the end.
// Results of the paper's leg, stretch 1.2 to 2.2 and voltage 0 to 12 kV at random, so that nothing repeats:
// the worst case for compression.
#include <benchmark/benchmark.h>
#include <hdf5.h>
#include <mpi.h>

#include <filesystem>
#include <random>

#include "gaiter/archive/chunk_file.hpp"
#include "gaiter/archive/durable_file.hpp"
#include "gaiter/archive/sweep_archive.hpp"
#include "gaiter/petsc/session.hpp"
#include "gaiter/solvers/slice_model.hpp"

namespace {

using namespace gaiter;

constexpr std::size_t cases = 8192;  // a chunk
constexpr std::size_t segments = 6;

struct Chunk {
  archive::Layout layout{cases,
                         {"r6", "r5", "r4", "r3", "r2", "r1"},
                         {{"bandage_stretch", "1", "stretch"}, {"voltage", "V", "voltage"}},
                         {}};
  archive::Provenance provenance{"0", "0", "voltage: 0\n", "benchmark", "2026-01-01T00:00:00Z", 1};
  std::vector<model::SegmentResult> rows;
  std::vector<double> wall_times = std::vector<double>(cases, 1e-5);
  std::vector<std::vector<double>> swept = std::vector<std::vector<double>>(2);

  archive::CaseResults results() const { return {rows, wall_times, swept}; }
  double bytes() const {
    double sum = 0;
    for (const archive::FileVariable& variable : archive::variables_of(layout))
      sum += static_cast<double>(archive::bytes_of(variable.stored) * cases *
                                 (variable.per_segment ? segments : 1));
    return sum;
  }
};

const Chunk& chunk() {
  static const Chunk made = [] {
    Chunk result;
    model::Scene scene;
    const double radius[] = {0.03585, 0.04337, 0.04995, 0.05559, 0.06017, 0.06235, 0.06315};
    for (std::size_t s = 0; s < segments; ++s)
      scene.leg.segments.push_back({result.layout.segments[s],
                                    0.035,
                                    radius[s],
                                    radius[s + 1],
                                    {0.013392, 7.898e-5, -0.01600, -0.001137}});
    scene.bandage.ogden = {{21193, 3.507}, {10.514, 12.147}};
    scene.bandage.permittivity = 7.41;
    std::mt19937_64 random(1);
    std::vector<model::Scene> scenes(cases, scene);
    std::vector<solvers::SegmentTask> tasks;
    for (model::Scene& design : scenes) {
      const double stretch = std::uniform_real_distribution(1.2, 2.2)(random);
      const double voltage = std::uniform_real_distribution(0.0, 12e3)(random);
      design.bandage.modules.assign(segments, {.stretch = stretch, .length = 0, .voltage = voltage});
      result.swept[0].push_back(stretch);
      result.swept[1].push_back(voltage);
      for (std::size_t s = 0; s < segments; ++s) tasks.push_back({&design, s});
    }
    result.rows = solvers::solve_segments(MPI_COMM_SELF, tasks);
    return result;
  }();
  return made;
}

void report(benchmark::State& state, double chunks, double stored_bytes) {
  const double designs = chunks * static_cast<double>(cases) * static_cast<double>(state.iterations());
  state.counters["designs/s"] = benchmark::Counter(designs, benchmark::Counter::kIsRate);
  state.counters["MB/s"] =
      benchmark::Counter(designs / cases * chunk().bytes() / 1e6, benchmark::Counter::kIsRate);
  if (stored_bytes > 0) state.counters["bytes/design"] = stored_bytes / (chunks * cases);
}

constexpr std::size_t many = 16;  // chunks of a run

void store(benchmark::State& state) {
  archive::Layout layout = chunk().layout;
  layout.cases = many * cases;
  double bytes = 0;
  {
    archive::SweepArchive run(MPI_COMM_SELF, "throughput.h5", layout, chunk().provenance, cases);
    std::size_t next = 0;
    for (auto _ : state) run.store(next++ % many, chunk().rows, chunk().wall_times, chunk().swept);
    run.flush();
    bytes = static_cast<double>(std::filesystem::file_size("throughput.h5.parts/chunk-000000.h5"));
  }
  std::filesystem::remove_all("throughput.h5.parts");
  std::filesystem::remove("throughput.h5");
  report(state, 1, bytes);
}

void compress_and_build(benchmark::State& state) {
  double bytes = 0;
  archive::Workspace workspace;
  for (auto _ : state) {
    const archive::FileOfCases file(chunk().layout, chunk().provenance, {0, cases, cases}, chunk().results(),
                                    true, workspace);
    bytes = static_cast<double>(file.bytes().size());
  }
  report(state, 1, bytes);
}

void plain_bytes_to_disk(benchmark::State& state) {
  const std::vector<std::byte> bytes(static_cast<std::size_t>(chunk().bytes()), std::byte{1});
  for (auto _ : state)
    archive::write_durably("throughput.bin", archive::temporary_name("throughput.bin"), {bytes});
  std::filesystem::remove("throughput.bin");
  report(state, 1, chunk().bytes());
}

// What the archive would be without its own compression: HDF5's filters, or none.
void through_hdf5(benchmark::State& state, bool filters) {
  const std::vector<archive::FileVariable> variables = archive::variables_of(chunk().layout);
  double bytes = 0;
  for (auto _ : state) {
    archive::MemoryFile file(true);
    std::vector<std::byte> values(cases * segments * 8);
    for (const archive::FileVariable& variable : variables) {
      const hsize_t items = cases * (variable.per_segment ? segments : 1);
      const bool wide = archive::bytes_of(variable.stored) == 8;
      const hid_t type = wide                                        ? H5T_IEEE_F64LE
                         : variable.stored == archive::Stored::int32 ? H5T_STD_I32LE
                                                                     : H5T_STD_I8LE;
      const archive::Id properties(H5Pcreate(H5P_DATASET_CREATE));
      if (filters) {
        H5Pset_chunk(properties.get(), 1, &items);
        H5Pset_shuffle(properties.get());
        H5Pset_deflate(properties.get(), 1);
      }
      const archive::Id space(H5Screate_simple(1, &items, nullptr));
      const archive::Id made(H5Dcreate2(file.get(), variable.name.c_str(), type, space.get(), H5P_DEFAULT,
                                        properties.get(), H5P_DEFAULT));
      archive::gather(variable, chunk().results(), values.data());
      H5Dwrite(made.get(), type, H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data());
    }
    bytes = static_cast<double>(file.close().size());
  }
  report(state, 1, bytes);
}

void merge(benchmark::State& state) {
  archive::Layout layout = chunk().layout;
  layout.cases = many * cases;
  double bytes = 0;
  for (auto _ : state) {
    state.PauseTiming();
    std::filesystem::remove("throughput.h5");
    archive::SweepArchive run(MPI_COMM_SELF, "throughput.h5", layout, chunk().provenance, cases);
    for (std::size_t i = 0; i < many; ++i) run.store(i, chunk().rows, chunk().wall_times, chunk().swept);
    state.ResumeTiming();
    run.finish();
    state.PauseTiming();
    bytes = static_cast<double>(std::filesystem::file_size("throughput.h5"));
    state.ResumeTiming();
  }
  std::filesystem::remove("throughput.h5");
  report(state, many, bytes);
}

}  // namespace

BENCHMARK(store)->UseRealTime()->Unit(benchmark::kMillisecond);
BENCHMARK(compress_and_build)->UseRealTime()->Unit(benchmark::kMillisecond);
BENCHMARK(plain_bytes_to_disk)->UseRealTime()->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(through_hdf5, shuffle_deflate, true)->UseRealTime()->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(through_hdf5, nothing, false)->UseRealTime()->Unit(benchmark::kMillisecond);
BENCHMARK(merge)->UseRealTime()->Unit(benchmark::kMillisecond)->Iterations(3);

int main(int argc, char** argv) {
  benchmark::Initialize(&argc, argv);
  gaiter::petsc::Session session({});
  chunk();
  benchmark::RunSpecifiedBenchmarks();
}
