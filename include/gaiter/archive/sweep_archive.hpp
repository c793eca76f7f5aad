// SPDX-License-Identifier: BSD-2-Clause
#pragma once

#include <cstddef>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include <mpi.h>
#include "gaiter/archive/layout.hpp"
#include "gaiter/archive/provenance.hpp"
#include "gaiter/model/result.hpp"

namespace gaiter::archive {

// The archive of a sweep, written as the run goes and taken up again where an earlier run of the same sweep
// ended, however it ended. The cases are cut into chunks; each is a small file of its own, written by one
// rank without any other, and is there whole or not at all. Meanwhile FILE.h5 is a small file that shows what
// is there so far; finish() makes it the archive.
//
// Memory per rank: a few times one chunk. Tens of thousands of chunks are fine, up to 250 show in FILE.h5
// while the run lasts.
class SweepArchive {
 public:
  // Begins a new archive, or takes up an unfinished one. Throws on all ranks base::InputError that begins
  // with "-output PATH: ": nothing can be written there, another run is writing it, it belongs to a sweep
  // with other options (which are named, with both values), to another version of the program, or is no
  // archive. `provenance.options` is what tells sweeps apart; its lines are `name: value`. @note Collective.
  SweepArchive(MPI_Comm comm, std::string path, Layout layout, Provenance provenance,
               std::size_t chunk_cases);
  ~SweepArchive();  // waits like flush(), not collective; an unfinished archive stays, to be taken up
  SweepArchive(const SweepArchive&) = delete;
  SweepArchive& operator=(const SweepArchive&) = delete;

  // True if an earlier run had finished this very archive: there is nothing to do, finish() does nothing.
  bool complete() const;

  std::size_t chunks() const;
  std::size_t first_case(std::size_t chunk) const;
  std::size_t cases_in(std::size_t chunk) const;  // chunk_cases, of the last chunk perhaps fewer

  // Whether an earlier run stored the chunk; the same on all ranks. Calls of store() do not change it.
  bool finished(std::size_t chunk) const;

  // Takes one whole chunk; any chunk on any rank, in any order. `rows`: cases_in(chunk) x segments, case by
  // case; `wall_times` [s]: one a case; `swept_values`: one vector per variable of layout.swept, one value a
  // case. The values are free again on return; the disk takes its time beside the work that follows, one
  // chunk at a time. Throws base::InternalError on this rank alone, naming -output and the cause, for this
  // chunk or the one before; all others stay, and the same run can be taken up later. Not collective.
  void store(std::size_t chunk, std::span<const model::SegmentResult> rows,
             std::span<const double> wall_times, std::span<const std::vector<double>> swept_values);

  // Waits until all that this rank has stored is safe on the disk. Throws as store() does. Not collective.
  void flush();

  // Makes FILE.h5 the archive of all chunks and removes what it was made of. A kill in between loses
  // nothing: the next run does it again. Throws base::InternalError on all ranks. @note Collective.
  void finish();

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace gaiter::archive
