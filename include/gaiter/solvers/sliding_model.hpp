// SPDX-License-Identifier: BSD-2-Clause
#pragma once

#include <mpi.h>

#include <span>
#include <vector>

#include "gaiter/solvers/slice_model.hpp"

namespace gaiter::solvers {

// The sliding slices (physics/sliding_system.hpp) of all tasks of all ranks: rest and actuated states each as
// one SNES over all segments, on the leg and again on one that does not give way. Every rank gives its own
// tasks, none too, and gets their results in the same order; they do not depend on how tasks are spread over
// ranks. All scenes have the same number of slices, leg model and material, and number of Ogden terms.
//
// The rest state is the one that the tube reaches from the slices' (not slid) as its energy falls; the
// actuated state starts from it. A segment that gets nowhere this way walks there: at rest its stretch grows,
// under voltage the voltage. Where such a path ends at a fold before its goal, the status is no_equilibrium,
// or pulled_in if the tube had lifted off all along. Equilibria that are not stable are never reported.
// @note Collective.
std::vector<model::SegmentResult> solve_sliding(MPI_Comm comm, std::span<const SegmentTask> tasks);

// One state of one segment at its slices, from the lower end up.
struct SlidingProfile {
  std::vector<double> reference_height;  // Z [m]
  std::vector<double> height;            // z [m]
  std::vector<double> axial_stretch;     // dz/dZ [1]
  std::vector<double> tube_radius;       // of the inner face [m]
  std::vector<double> leg_radius;        // deformed [m]
  std::vector<double> pressure;          // [Pa]
};

struct SlidingSolution {
  model::SegmentResult result;
  SlidingProfile rest, actuated;
};

// One segment by itself; the profiles are those of a result that is trustworthy.
SlidingSolution solve_sliding(const SegmentTask& task);

}  // namespace gaiter::solvers
