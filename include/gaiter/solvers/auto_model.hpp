// SPDX-License-Identifier: BSD-2-Clause
#pragma once

#include <mpi.h>

#include <span>
#include <vector>

#include "gaiter/solvers/slice_model.hpp"

namespace gaiter::solvers {

// The cheapest model of one segment that should reach the scene's goal: rigid leg, first-order correction,
// slices with the fewest points over the height and through the wall, by the forecast of their errors alone;
// then, where the goal allows more than slices, by climb() from these, which are solved for it. The `cost` is
// a fit to measurements on one core (benchmarks/auto_study).
SlicePlan plan_segment(const model::Scene& scene, std::size_t segment);
// Without that last step, for many, whose scenes have the same leg material and number of Ogden terms: 64
// cost little more than one.
void plan_segments(std::span<const SegmentTask> tasks, std::vector<SlicePlan>& plans);

// What one solve by a plan should take [s], without the planning that a plan's own `cost` includes.
double plan_cost(const model::Scene& scene, std::size_t segment, const SlicePlan& plan);

// Segments that each go by their plan. Slices whose own pressures, once solved, tell of a larger error than
// the goal allows are solved again with more of them, and likewise sliding slices and finite elements (whose
// mesh is refined); what is not wanted is not computed and NaN. Errors in results are those of the wanted
// output where they are largest. Results do not depend on what else is in a batch.
class AutoModel {
 public:
  // `group`: ranks that share finite element meshes; everything else each rank solves by itself.
  explicit AutoModel(MPI_Comm group) : group_(group), slices_(MPI_COMM_SELF) {}

  // Every rank of the group gives the same tasks, whose plans, if any, are not looked at, and gets all
  // results, good until the next call. All scenes have the same leg model and material and number of Ogden
  // terms. @note Collective over the group.
  std::span<const model::SegmentResult> solve(std::span<const SegmentTask> tasks);

  std::span<const SlicePlan> plans() const {
    return plans_;
  }  // of the last tasks, as solved; costs of all attempts

 private:
  void plan_again(std::span<const SegmentTask> tasks, const std::vector<std::size_t>& chosen);
  void solve_slices(std::span<const SegmentTask> tasks, std::vector<std::size_t>& chosen);
  void solve_finer(std::span<const SegmentTask> tasks, const std::vector<std::size_t>& chosen);
  bool refine(SlicePlan& plan, const model::SegmentResult& result) const;

  MPI_Comm group_;
  SliceModel slices_;
  std::vector<SlicePlan> plans_;
  std::vector<SegmentTask> own_;  // of a batch of slices
  std::vector<model::SegmentResult> results_;
};

}  // namespace gaiter::solvers
