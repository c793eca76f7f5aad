// SPDX-License-Identifier: BSD-2-Clause
#pragma once

#include <cstdint>

#include "gaiter/archive/layout.hpp"
#include "gaiter/archive/provenance.hpp"
#include "gaiter/studies/designs.hpp"
#include "gaiter/studies/scene_options.hpp"

namespace gaiter::studies {

// How a sweep went on this rank, and how it ended on all.
struct SweepReport {
  int signal = 0;                 // that ended it before all was done; 0: it is complete
  std::int64_t missing = 0;       // designs not solved yet, of all ranks
  std::int64_t taken_up = 0;      // designs that earlier runs had solved
  bool already_complete = false;  // an earlier run had made the archive whole
  double seconds = 0;             // the run took, the same on all ranks
  // Of this rank:
  std::int64_t designs = 0;
  double equilibria = 0;
  double solving = 0, storing = 0, finishing = 0;           // [s] of the run
  double solving_processor = 0, archive_processor = 0;      // [s] of the processor, whoever else it serves
  std::int64_t messages = 0;                                // sent to other ranks while solving
  double waiting_for_messages = 0, waiting_at_the_end = 0;  // [s] the latter for the slowest rank
};

// Solves all designs that the archive does not hold yet, chunk by chunk, each by one group of ranks and
// stored by its first rank; then makes the archive whole. SIGTERM and SIGINT end it after the chunks at hand:
// the archive can be taken up. Throws base::InputError before anything is solved, on all ranks, where the
// archive cannot be used; base::InternalError, on one rank alone, where a chunk cannot be stored.
// @note Collective.
SweepReport run_sweep(MPI_Comm comm, const Request& request, const Designs& designs,
                      archive::Provenance provenance);

// Designs in a chunk: enough that storing it costs little beside solving it, and the same however many ranks
// there are.
std::size_t chunk_designs(const model::Scene& scene, std::int64_t designs);

// Throughput of all ranks, how evenly they were busy, what the archive took, and what would limit more ranks.
// @note Collective; the text is rank 0's.
std::string speed_summary(MPI_Comm comm, const SweepReport& report);

}  // namespace gaiter::studies
