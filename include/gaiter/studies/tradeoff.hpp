// SPDX-License-Identifier: BSD-2-Clause
#pragma once

#include <mpi.h>

#include <string>
#include <vector>

#include "gaiter/archive/layout.hpp"
#include "gaiter/archive/provenance.hpp"
#include "gaiter/model/result.hpp"
#include "gaiter/studies/rungs.hpp"

namespace gaiter::studies {

// One rung of a scene, solved.
struct RungResult {
  std::string name;
  std::vector<model::SegmentResult> rows;  // a segment each
  double true_error = 0;    // the largest of any segment and wanted output, relative to the last rung's [1]
  double segment_time = 0;  // of one segment on one processor, among many such segments [s]
  double solve_time = 0;    // of the scene by itself, on all ranks [s]
};

// Solves every rung and holds it against the last. What takes little time is solved many times over, as in a
// sweep, to be timed. The same on all ranks. @note Collective.
std::vector<RungResult> climb(MPI_Comm comm, const std::vector<Rung>& rungs);

// The rungs as a table, the cheapest of each accuracy marked, and what the errors refer to.
std::string tradeoff_table(const model::Scene& scene, const std::vector<RungResult>& rungs);

// The archive of a tradeoff: the cases are its rungs, with the variables rung, true_error and segment_time.
archive::Layout tradeoff_layout(const model::Scene& scene, const std::vector<RungResult>& rungs);
void write_tradeoff(const std::string& path, const archive::Layout& layout,
                    const archive::Provenance& provenance, const std::vector<RungResult>& rungs);

}  // namespace gaiter::studies
