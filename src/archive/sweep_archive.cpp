// SPDX-License-Identifier: BSD-2-Clause
#include "gaiter/archive/sweep_archive.hpp"

#include <unistd.h>

#include <algorithm>
#include <filesystem>
#include <future>
#include <utility>

#include "gaiter/archive/agree.hpp"
#include "gaiter/archive/chunk_file.hpp"
#include "gaiter/archive/durable_file.hpp"
#include "gaiter/archive/existing_archive.hpp"
#include "gaiter/archive/hdf5.hpp"
#include "gaiter/archive/memory_file.hpp"
#include "gaiter/archive/merge.hpp"
#include "gaiter/archive/run_folder.hpp"
#include "gaiter/archive/table_file.hpp"
#include "gaiter/base/error.hpp"
#include "gaiter/petsc/session.hpp"

namespace gaiter::archive {

namespace {

constexpr const char* kept = "; the chunks stored before are kept, and the same command continues the run";

}  // namespace

struct SweepArchive::State {
  MPI_Comm comm;
  std::string path;
  Layout layout;
  Provenance provenance;
  std::size_t chunk_cases;
  RunFolder folder;
  Identity identity;
  std::uint64_t sweep;
  bool complete = false;
  std::vector<char> finished;
  Workspace workspace;
  std::shared_ptr<const FileOfCases> written;
  std::future<void> writing;  // of the chunk stored last, from the bytes of `written`

  State(MPI_Comm comm, std::string path, Layout layout, Provenance provenance, std::size_t chunk_cases);

  std::string context() const { return "-output " + path; }
  bool first_rank() const { return petsc::rank(comm) == 0; }
  CaseRange range(std::size_t chunk) const;
  void require_sensible() const;
  bool look_for_finished() const;
  void begin();
  void find_finished_chunks();
  void show_what_is_there() const;
  void require_replaceable() const;
  void finish() const;
  void remove_share() const;
};

SweepArchive::State::State(MPI_Comm on, std::string file, Layout shape, Provenance run, std::size_t cases)
    : comm(on),
      path(std::move(file)),
      layout(std::move(shape)),
      provenance(std::move(run)),
      chunk_cases(std::clamp<std::size_t>(cases, 1, std::max<std::size_t>(layout.cases, 1))),
      folder(path),
      identity(identity_of(layout, provenance, chunk_cases)),
      sweep(number_of(identity)),
      finished((layout.cases + chunk_cases - 1) / chunk_cases, 0) {}

CaseRange SweepArchive::State::range(std::size_t chunk) const {
  const std::size_t first = chunk * chunk_cases;
  return {first, std::min(chunk_cases, layout.cases - first), chunk_cases};
}

void SweepArchive::State::require_sensible() const {
  if (layout.rows() == 0) {
    throw base::InternalError("it would hold no result");
  }
  if (chunk_cases > (std::size_t{1} << 28) / layout.segments.size()) {
    throw base::InternalError(std::to_string(chunk_cases) + " cases are too many for one chunk");
  }
}

// True if there is nothing left to do; throws if what is there is of another sweep.
bool SweepArchive::State::look_for_finished() const {
  const std::optional<ExistingArchive> there = look_at(path);
  if (!there) {
    return false;
  }
  if (const std::string text = difference(*there, identity); !text.empty()) {
    throw base::InputError(text);
  }
  return there->finished;
}

void SweepArchive::State::require_replaceable() const {
  std::error_code ignored;
  if (std::filesystem::exists(path, ignored) && ::access(path.c_str(), W_OK) != 0) {
    throw base::InputError("this file is read-only");
  }
}

// On the first rank. The look before the lock leaves no folder behind where a run is refused, the one
// after it sees what a run has done that ended in between.
void SweepArchive::State::begin() {
  complete = look_for_finished();
  if (complete && !folder.exists()) {
    return;
  }
  require_replaceable();
  folder.lock();
  complete = look_for_finished();
  if (complete) {
    folder.remove();  // of a run that was killed when it had all but ended
  } else {
    folder.remove_temporaries();
  }
}

// Every rank examines its share of the chunks' files.
void SweepArchive::State::find_finished_chunks() {
  std::vector<char> stored(finished.size(), 0);
  agreed(comm, context(), [&] {
    if (first_rank()) {
      stored = folder.stored(finished.size());
    }
  });
  const int count = static_cast<int>(finished.size());
  MPI_Bcast(stored.data(), count, MPI_CHAR, 0, comm);
  agreed(comm, context(), [&] {
    if (::access(folder.path().c_str(), W_OK | X_OK) != 0) {
      throw base::InputError("rank " + std::to_string(petsc::rank(comm)) + " cannot write to the folder " +
                             folder.path());
    }
    const auto ranks = static_cast<std::size_t>(petsc::size(comm));
    for (auto i = static_cast<std::size_t>(petsc::rank(comm)); i < finished.size(); i += ranks) {
      const ChunkState state =
          stored[i] != 0 ? examine_chunk(folder.chunk_path(i), sweep) : ChunkState::missing;
      if (state == ChunkState::foreign) {
        throw base::InputError("the folder " + folder.path() +
                               " holds chunks of another sweep; remove it or choose another name");
      }
      if (state == ChunkState::damaged) {
        std::filesystem::remove(folder.chunk_path(i));
      }
      finished[i] = state == ChunkState::sound ? 1 : 0;
    }
  });
  MPI_Allreduce(MPI_IN_PLACE, finished.data(), count, MPI_SIGNED_CHAR, MPI_MAX, comm);
}

// Writes FILE.h5 of an unfinished run.
void SweepArchive::State::show_what_is_there() const {
  const QuietErrors quiet;
  Unfinished unfinished{[&](std::size_t i) { return folder.chunk_path_from_archive(i); },
                        "the run has not ended: what it has not computed yet is NaN, -1 in integers. Its "
                        "results are in " +
                            folder.path() + "; the same command continues it"};
  if (finished.size() > most_parts_shown) {
    unfinished.note += ". They are too many to show here: open the files chunk-*.h5 in that folder";
  }
  MemoryFile file(false);
  fill_file(file.get(), layout, provenance, {0, layout.cases, chunk_cases}, &unfinished);
  write_durably(path, folder.temporary("unfinished"), {file.close()});
}

void SweepArchive::State::finish() const {
  const std::string merged = first_rank() ? folder.temporary("merged") : "";
  try {
    agreed(comm, context(), [&] {
      if (!first_rank()) {
        return;
      }
      const std::vector<char> stored = folder.stored(finished.size());
      if (const auto missing = std::find(stored.begin(), stored.end(), 0); missing != stored.end()) {
        throw base::InternalError("chunk " + std::to_string(missing - stored.begin()) + " is not stored");
      }
      require_replaceable();
    });
    merge_chunks(comm, context(), merged, folder, layout, provenance, chunk_cases);
    agreed(comm, context(), [&] {
      if (first_rank()) {
        publish(merged, path);
      }
    });
  } catch (const std::exception& error) {
    if (first_rank()) {
      ::unlink(merged.c_str());
    }
    throw base::InternalError(error.what() + std::string(kept));
  }
  remove_share();
}

// Each rank what it has copied, for that takes as long as the copying. All that can be lost here is room.
void SweepArchive::State::remove_share() const {
  for (std::size_t i = 0; i < finished.size(); ++i) {
    if (is_share_of(petsc::rank(comm), petsc::size(comm), i)) {
      ::unlink(folder.chunk_path(i).c_str());
    }
  }
  MPI_Barrier(comm);
  if (first_rank()) {
    folder.remove();
  }
}

SweepArchive::SweepArchive(MPI_Comm comm, std::string path, Layout layout, Provenance provenance,
                           std::size_t chunk_cases)
    : state_(std::make_unique<State>(comm, std::move(path), std::move(layout), std::move(provenance),
                                     chunk_cases)) {
  State& state = *state_;
  agreed(comm, state.context(), [&] { state.require_sensible(); });
  agreed(comm, state.context(), [&] {
    if (state.first_rank()) {
      state.begin();
    }
  });
  int complete = state.complete ? 1 : 0;
  MPI_Bcast(&complete, 1, MPI_INT, 0, comm);
  state.complete = complete != 0;
  if (state.complete) {
    std::fill(state.finished.begin(), state.finished.end(), 1);
    return;
  }
  state.find_finished_chunks();
  agreed(comm, state.context(), [&] {
    if (state.first_rank()) {
      state.show_what_is_there();
    }
  });
}

SweepArchive::~SweepArchive() = default;

bool SweepArchive::complete() const {
  return state_->complete;
}

std::size_t SweepArchive::chunks() const {
  return state_->finished.size();
}

std::size_t SweepArchive::first_case(std::size_t chunk) const {
  return state_->range(chunk).first;
}

std::size_t SweepArchive::cases_in(std::size_t chunk) const {
  return state_->range(chunk).count;
}

bool SweepArchive::finished(std::size_t chunk) const {
  return state_->finished.at(chunk) != 0;
}

void SweepArchive::store(std::size_t chunk, std::span<const model::SegmentResult> rows,
                         std::span<const double> wall_times,
                         std::span<const std::vector<double>> swept_values) {
  State& state = *state_;
  const auto told = [context = state.context(), chunk](const std::exception& error) {
    return base::InternalError(context + ": chunk " + std::to_string(chunk) +
                               " cannot be stored: " + error.what() + kept);
  };
  std::shared_ptr<const FileOfCases> file;
  try {
    if (state.complete || chunk >= chunks()) {
      throw base::InternalError("there is no such chunk to store");
    }
    file = std::make_shared<const FileOfCases>(state.layout, state.provenance, state.range(chunk),
                                               CaseResults{rows, wall_times, swept_values}, true,
                                               state.workspace);
  } catch (const std::exception& error) {
    throw told(error);
  }
  flush();
  // The other thread calls neither MPI nor HDF5, and its file is released by this one.
  const Seal seal = seal_of(state.sweep, *file);
  state.written = file;
  state.writing =
      std::async(std::launch::async, [bytes = file->bytes(), places = std::as_bytes(file->places()), seal,
                                      told, path = state.folder.chunk_path(chunk)] {
        try {
          write_durably(path, temporary_name(path), {bytes, places, std::as_bytes(std::span(&seal, 1))});
        } catch (const std::exception& error) {
          throw told(error);
        }
      });
}

void SweepArchive::flush() {
  if (state_->writing.valid()) {
    state_->writing.get();
  }
}

void SweepArchive::finish() {
  State& state = *state_;
  Failure failure;
  try {
    flush();
  } catch (const base::InternalError& error) {
    failure.message = error.what();
  }
  throw_if_any_failed(state.comm, failure);
  if (!state.complete) {
    state.finish();
  }
  state.complete = true;
}

}  // namespace gaiter::archive
