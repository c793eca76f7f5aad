// SPDX-License-Identifier: BSD-2-Clause
#pragma once

#include <cstddef>
#include <string>

#include <mpi.h>
#include "gaiter/archive/layout.hpp"
#include "gaiter/archive/provenance.hpp"
#include "gaiter/archive/run_folder.hpp"

namespace gaiter::archive {

// Writes the archive of all chunks to `path`, a new file whose name the first rank gives, and brings it to
// the disk. The first rank lays the file out by the sizes of all compressed values; then each rank copies its
// share of the chunks as they are. Memory: one chunk, and on the first rank 8 bytes for each variable of each
// chunk. Throws base::InternalError, whose message
// begins with `context`, on all ranks; then the file is of no use. @note Collective.
void merge_chunks(MPI_Comm comm, const std::string& context, const std::string& path, const RunFolder& folder,
                  const Layout& layout, const Provenance& provenance, std::size_t chunk_cases);

// The share of the chunks that a rank copies, and removes when the archive is there: as slices are handed
// out, so that most were written by the same machine.
inline bool is_share_of(int rank, int ranks, std::size_t chunk) {
  return chunk % static_cast<std::size_t>(ranks) == static_cast<std::size_t>(rank);
}

}  // namespace gaiter::archive
