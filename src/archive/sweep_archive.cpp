// SPDX-License-Identifier: BSD-2-Clause
#include "gaiter/archive/sweep_archive.hpp"

#include <algorithm>
#include <map>

#include "gaiter/archive/writer.hpp"

namespace gaiter::archive {

// Chunks wait in memory until the end; nothing of an unfinished run can be taken up.
struct SweepArchive::State {
  struct Chunk {
    std::vector<model::SegmentResult> rows;
    std::vector<double> wall_times;
    std::vector<std::vector<double>> swept_values;
  };
  MPI_Comm comm;
  std::string path;
  Layout layout;
  Provenance provenance;
  std::size_t chunk_cases;
  std::map<std::size_t, Chunk> mine;
};

SweepArchive::SweepArchive(MPI_Comm comm, std::string path, Layout layout, Provenance provenance,
                           std::size_t chunk_cases)
    : state_(new State{comm, std::move(path), std::move(layout), std::move(provenance), chunk_cases, {}}) {}

SweepArchive::~SweepArchive() = default;

bool SweepArchive::complete() const {
  return false;
}

std::size_t SweepArchive::chunks() const {
  return (state_->layout.cases + state_->chunk_cases - 1) / state_->chunk_cases;
}

std::size_t SweepArchive::first_case(std::size_t chunk) const {
  return chunk * state_->chunk_cases;
}

std::size_t SweepArchive::cases_in(std::size_t chunk) const {
  return std::min(state_->chunk_cases, state_->layout.cases - first_case(chunk));
}

bool SweepArchive::finished(std::size_t) const {
  return false;
}

void SweepArchive::store(std::size_t chunk, std::span<const model::SegmentResult> rows,
                         std::span<const double> wall_times,
                         std::span<const std::vector<double>> swept_values) {
  state_->mine[chunk] = {{rows.begin(), rows.end()},
                         {wall_times.begin(), wall_times.end()},
                         {swept_values.begin(), swept_values.end()}};
}

void SweepArchive::finish() {
  Layout layout = state_->layout;
  for (std::size_t k = 0; k < layout.swept.size(); ++k) {
    std::vector<double> mine(layout.cases, 0);
    for (const auto& [chunk, content] : state_->mine)
      std::ranges::copy(content.swept_values[k], mine.begin() + first_case(chunk));
    layout.swept[k].values.resize(layout.cases);
    MPI_Allreduce(mine.data(), layout.swept[k].values.data(), static_cast<int>(layout.cases), MPI_DOUBLE,
                  MPI_SUM, state_->comm);
  }
  Writer writer(state_->comm, state_->path, layout, state_->provenance);
  for (std::size_t chunk = 0; chunk < chunks(); ++chunk) {
    const auto found = state_->mine.find(chunk);
    const bool here = found != state_->mine.end();
    writer.write(here ? first_case(chunk) * layout.segments.size() : 0,
                 here ? std::span<const model::SegmentResult>(found->second.rows)
                      : std::span<const model::SegmentResult>());
    writer.write_wall_times(
        here ? first_case(chunk) : 0,
        here ? std::span<const double>(found->second.wall_times) : std::span<const double>());
  }
  writer.close();
}

}  // namespace gaiter::archive
