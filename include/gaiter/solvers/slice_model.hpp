// SPDX-License-Identifier: BSD-2-Clause
#pragma once

#include <mpi.h>

#include <span>
#include <vector>

#include "gaiter/model/result.hpp"

namespace gaiter::solvers {

// One segment of one design.
struct SegmentTask {
  const model::Scene* scene = nullptr;
  std::size_t segment = 0;
};

// The slice model, or with Fidelity::rigid the rigid leg, of all tasks of all ranks: rest and actuated states
// each as one SNES over all slices. Every rank gives its own tasks, none too, and gets their results in the
// same order; they do not depend on how tasks are spread over ranks. All scenes have the same fidelity, leg
// material, slice rule, solver and number of Ogden terms; anything else may differ.
// @note Collective.
std::vector<model::SegmentResult> solve_segments(MPI_Comm comm, std::span<const SegmentTask> tasks);

}  // namespace gaiter::solvers
