// SPDX-License-Identifier: BSD-2-Clause
#pragma once

#include <mpi.h>

#include <span>
#include <vector>

#include "gaiter/model/result.hpp"
#include "gaiter/solvers/axisym_fields.hpp"
#include "gaiter/solvers/slice_model.hpp"

namespace gaiter::solvers {

// The axisymmetric contact model of one segment after the other, or with AxisymScope::leg of one leg after
// the other, whose tasks are then all its segments, in order. Each is distributed over `comm`; every rank of
// it gives the same tasks and gets all results. `error_estimate` compares with the mesh one refinement
// coarser, and is on the coarsest mesh five times what the dual expects of the next finer one
// (expected_changes), NaN where it expects nothing; `iterations` is the most Newton steps of rest or actuated
// state, failed starts and steps of a continuation included, and the same for all segments of a leg. The
// state at rest starts from that of the coarser mesh.
//
// In a leg the volume of a segment is that of its material, between boundaries that move axially with the
// leg. Where the radii of neighbouring segments differ, both are taken as their mean.
//
// The observer, which all ranks give or none, is called on rank 0 with the fields of the states found: of a
// mesh at rest, then, if it has a voltage, actuated.
// @note Collective.
std::vector<model::SegmentResult> solve_axisym(MPI_Comm comm, std::span<const SegmentTask> tasks,
                                               const AxisymObserver& observer = {});

// Sets the solver of a task up and solves one linear system, so that it asks for all its options. Throws
// base::InputError if they do not go together. @note Collective.
void try_axisym(MPI_Comm comm, const SegmentTask& task);

}  // namespace gaiter::solvers
