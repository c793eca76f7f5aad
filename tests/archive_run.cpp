// SPDX-License-Identifier: BSD-2-Clause
// A sweep without physics for archive_kills.py, which kills it: archive_run FILE.h5 CASES CHUNK_CASES
// [milliseconds a chunk] [text of the options]. Chunks go to the ranks in turn. Ends with 0, with 2 where the
// input is refused, or through MPI_Abort with 70. ARCHIVE_RUN_LIMIT in the environment: no file may have more
// bytes (MPI's own files excepted, which are there already).
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <thread>

#include "archive_samples.hpp"

namespace gaiter::archive {
namespace {

void run(int argc, char** argv) {
  const std::size_t cases = std::strtoul(argv[2], nullptr, 10);
  const std::size_t chunk_cases = std::strtoul(argv[3], nullptr, 10);
  const std::chrono::milliseconds pause(argc > 4 ? std::strtol(argv[4], nullptr, 10) : 0);
  Provenance provenance = sample_provenance();
  if (argc > 5) {
    provenance.options = argv[5];
  }
  const Layout layout = sample_layout(cases);
  SweepArchive archive(MPI_COMM_WORLD, argv[1], layout, provenance, chunk_cases);
  const auto rank = static_cast<std::size_t>(rank_in(MPI_COMM_WORLD));
  const auto ranks = static_cast<std::size_t>(size_of(MPI_COMM_WORLD));
  std::size_t found = 0;
  for (std::size_t chunk = 0; chunk < archive.chunks(); ++chunk) {
    found += archive.finished(chunk) ? 1 : 0;
  }
  if (rank == 0) {
    std::printf("found %zu of %zu chunks\n", found, archive.chunks());
    std::fflush(stdout);
  }
  for (std::size_t chunk = rank; chunk < archive.chunks(); chunk += ranks) {
    if (!archive.finished(chunk)) {
      std::this_thread::sleep_for(pause);
      store_sample(archive, chunk, layout.segments.size());
      std::printf("stored %zu\n", chunk);
      std::fflush(stdout);
    }
  }
  archive.finish();
}

}  // namespace
}  // namespace gaiter::archive

int main(int argc, char** argv) {
  MPI_Init(&argc, &argv);
  int code = 0;
  if (const char* bytes = std::getenv("ARCHIVE_RUN_LIMIT")) {
    const rlimit limit{std::strtoul(bytes, nullptr, 10), RLIM_INFINITY};
    setrlimit(RLIMIT_FSIZE, &limit);
  }
  try {
    if (argc < 4) {
      throw gaiter::base::InputError("usage: archive_run FILE.h5 CASES CHUNK_CASES [MILLISECONDS] [OPTIONS]");
    }
    gaiter::archive::run(argc, argv);
  } catch (const gaiter::base::InputError& error) {
    if (gaiter::archive::rank_in(MPI_COMM_WORLD) == 0) {
      std::fprintf(stderr, "%s\n", error.what());
    }
    code = 2;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "%s\n", error.what());
    MPI_Abort(MPI_COMM_WORLD, 70);
  }
  MPI_Finalize();
  return code;
}
