// SPDX-License-Identifier: BSD-2-Clause
#pragma once

#include <mpi.h>

#include <cstdint>
#include <vector>

#include "gaiter/model/result.hpp"
#include "gaiter/solvers/auto_model.hpp"
#include "gaiter/studies/designs.hpp"

namespace gaiter::studies {

// A run of designs, solved: what an archive keeps of it.
struct SolvedChunk {
  std::vector<model::SegmentResult> rows;         // design by design, segment by segment
  std::vector<double> wall_times;                 // of each design: its share of what was solved together [s]
  std::vector<std::vector<double>> swept_values;  // of each axis, a value a design
  std::int64_t failed = 0;                        // designs with a row that cannot be trusted
  double equilibria = 0;                          // of slices; 0 at the other fidelities
};

// Solves runs of designs, batch by batch: a batch of slices fits the caches and is one SNES, which is used
// again for the next. What a batch holds depends on the designs alone, so results do not depend on ranks.
class ChunkSolver {
 public:
  // `group`: ranks that solve together; without finite elements a rank is a group of its own. `scene`: of any
  // design.
  ChunkSolver(MPI_Comm group, const model::Scene& scene, const Designs& designs);

  // Designs first, first + 1, ... The chunk is good until the next call. @note Collective over the group.
  const SolvedChunk& solve(std::int64_t first, std::size_t count);

 private:
  void solve_batch(std::size_t first, std::size_t designs);

  MPI_Comm group_;
  const Designs& designs_;
  std::vector<model::Scene> scenes_;  // of a batch, used again for the next
  std::vector<bool> sound_;           // of each of them: it can be solved
  std::vector<solvers::SegmentTask> tasks_;
  solvers::SliceModel slices_;
  solvers::AutoModel auto_;
  SolvedChunk chunk_;
};

}  // namespace gaiter::studies
