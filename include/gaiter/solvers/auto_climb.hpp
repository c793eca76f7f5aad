// SPDX-License-Identifier: BSD-2-Clause
#pragma once

#include "gaiter/solvers/slice_model.hpp"

namespace gaiter::solvers {

// From a plan's result by slices, or something simpler: the same plan if finer models would change no wanted
// output by more than the goal leaves (physics::model_errors), else sliding slices or, where these would not
// do either, finite elements on the coarsest mesh.
SlicePlan climb(const model::Scene& scene, std::size_t segment, const SlicePlan& slices,
                const model::SegmentResult& result);

}  // namespace gaiter::solvers
