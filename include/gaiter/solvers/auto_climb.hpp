// SPDX-License-Identifier: BSD-2-Clause
#pragma once

#include "gaiter/solvers/slice_model.hpp"

namespace gaiter::solvers {

// How -fidelity auto gets from slices to what finer models would say, the cheapest first:
//   the closed form of the slices' distance to the finite elements (physics::model_errors), 0.3 us;
//   that of the sliding slices', which are then solved, 0.2 to 2 ms;
//   where these do not know, or claim to be off by up to three times the accuracy, the finite elements'
//   residual of the slices (estimate_by_residual), 15 ms, then that of the sliding slices;
//   a mesh, the coarsest first, from 50 ms on.
//
// From a plan's result by slices, or something simpler: the same plan if finer models would change no wanted
// output by more than the goal leaves; the same plan that asks for less of an error of its own, if finer
// slices would do; else sliding slices or finite elements.
SlicePlan climb(const model::Scene& scene, std::size_t segment, const SlicePlan& slices,
                const model::SegmentResult& result);

// From a plan's result by sliding slices: the same plan, or finite elements. Where sliding slices have no
// stable state, and the residual found none near the slices either, a thin wall is taken to have none: a mesh
// would search for it for a second in vain, and in all 71 such cases of 600 did.
SlicePlan climb_from_sliding(const model::Scene& scene, std::size_t segment, const SlicePlan& sliding,
                             const model::SegmentResult& result);

}  // namespace gaiter::solvers
