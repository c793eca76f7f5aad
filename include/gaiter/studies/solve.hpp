// SPDX-License-Identifier: BSD-2-Clause
#pragma once

#include <mpi.h>

#include <vector>

#include "gaiter/model/result.hpp"
#include "gaiter/solvers/axisym_fields.hpp"

namespace gaiter::studies {

// Results of a scene, spread over the ranks by segments.
struct Solution {
  std::size_t first_row = 0;               // of this rank
  std::vector<model::SegmentResult> rows;  // of this rank
  double seconds = 0;                      // the whole solve took
};

// Whether finite elements may be needed.
bool may_take_axisym(const model::Scene& scene);

// Solves a scene at its fidelity, all ranks together. The observer is for finite elements: see solve_axisym.
// @note Collective.
Solution solve_scene(MPI_Comm comm, const model::Scene& scene, const solvers::AxisymObserver& observer = {});

// All rows, on all ranks. @note Collective.
std::vector<model::SegmentResult> gather(MPI_Comm comm, const Solution& solution);

}  // namespace gaiter::studies
