// SPDX-License-Identifier: BSD-2-Clause
#pragma once

#include <mpi.h>

#include <array>
#include <cstddef>
#include <vector>

#include "gaiter/model/result.hpp"
#include "gaiter/solvers/axisym_fields.hpp"
#include "gaiter/studies/designs.hpp"

namespace gaiter::studies {

// Results of the designs, spread over the ranks by rows: row = design * segments + segment.
struct Solution {
  std::size_t first_row = 0;               // of this rank
  std::vector<model::SegmentResult> rows;  // of this rank
  double seconds = 0;                      // the whole solve took
};

// Solves all designs of a scene at its fidelity. The observer is for finite elements: see solve_axisym.
// @note Collective.
Solution solve_designs(MPI_Comm comm, const model::Scene& scene, const Designs& designs,
                       const solvers::AxisymObserver& observer = {});

// All rows, on rank 0; elsewhere none. @note Collective.
std::vector<model::SegmentResult> gather(MPI_Comm comm, const Solution& solution);

// Rows with each status, over all ranks. @note Collective.
std::array<double, 7> count_status(MPI_Comm comm, const Solution& solution);

}  // namespace gaiter::studies
