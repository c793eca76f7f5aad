// SPDX-License-Identifier: BSD-2-Clause
#include "gaiter/studies/chunk_solver.hpp"

#include <algorithm>

#include "gaiter/solvers/axisym_model.hpp"
#include "gaiter/solvers/sliding_model.hpp"
#include "gaiter/studies/scene_checks.hpp"
#include "gaiter/studies/solve.hpp"

namespace gaiter::studies {

namespace {

constexpr std::size_t slices_in_batch = 6144;   // their constants and states are some 3 MB
constexpr std::size_t segments_in_batch = 256;  // sliding
constexpr std::size_t planned_in_batch = 2048;  // segments: of some ten kinds of plan, each in packs of 64

// Designs that go into one batch.
std::size_t batch_designs(const model::Scene& scene) {
  const std::size_t segments = scene.leg.segments.size();
  if (may_take_axisym(scene)) return 1;
  if (scene.fidelity == model::Fidelity::automatic && scene.goal.up_to == model::Fidelity::slice)
    return std::max<std::size_t>(1, planned_in_batch / segments);
  if (scene.fidelity == model::Fidelity::sliding || scene.fidelity == model::Fidelity::automatic)
    return std::max<std::size_t>(1, segments_in_batch / segments);
  const std::size_t slices = segments * static_cast<std::size_t>(scene.discretisation.slice_count);
  return std::max<std::size_t>(1, slices_in_batch / slices);
}

// What all scenes of a batch have in common.
bool alike(const model::Scene& a, const model::Scene& b) {
  return a.discretisation.sliding_count == b.discretisation.sliding_count &&
         a.discretisation.fixed_point_tolerance == b.discretisation.fixed_point_tolerance;
}

double equilibria_of(const solvers::SegmentTask& task) {
  const int states = task.scene->bandage.modules[task.segment].voltage != 0 ? 2 : 1;
  return states * task.scene->discretisation.slice_count;
}

}  // namespace

ChunkSolver::ChunkSolver(MPI_Comm group, const model::Scene& scene, const Designs& designs)
    : group_(group),
      designs_(designs),
      scenes_(batch_designs(scene), scene),
      slices_(MPI_COMM_SELF),
      auto_(group) {
  sound_.resize(scenes_.size());
  chunk_.swept_values.resize(designs.axes().size());
}

const SolvedChunk& ChunkSolver::solve(std::int64_t first, std::size_t count) {
  const std::size_t segments = scenes_[0].leg.segments.size();
  chunk_.failed = 0;
  chunk_.equilibria = 0;
  chunk_.rows.resize(count * segments);
  chunk_.wall_times.resize(count);
  for (auto& axis : chunk_.swept_values) axis.resize(count);
  std::vector<double> values(designs_.axes().size());
  for (std::size_t done = 0, filled = 0; done < count; done += filled) {
    for (filled = 0; filled < scenes_.size() && done + filled < count; ++filled) {
      designs_.values(first + static_cast<std::int64_t>(done + filled), values);
      sound_[filled] = put_design(designs_, values, scenes_[filled]).empty();
      if (filled > 0 && !alike(scenes_[filled], scenes_[0])) break;  // the first of the next batch
      for (std::size_t axis = 0; axis < values.size(); ++axis)
        chunk_.swept_values[axis][done + filled] = values[axis];
    }
    solve_batch(done, filled);
  }
  return chunk_;
}

// The first scenes to their rows; the first design has the number `first` in the chunk.
void ChunkSolver::solve_batch(std::size_t first, std::size_t designs) {
  const double start = MPI_Wtime();
  const std::size_t segments = scenes_[0].leg.segments.size();
  tasks_.clear();
  for (std::size_t k = 0; k < designs; ++k)
    for (std::size_t s = 0; sound_[k] && s < segments; ++s)
      if (scenes_[k].wants(s)) tasks_.push_back({&scenes_[k], s});
  std::vector<model::SegmentResult> others;
  std::span<const model::SegmentResult> results;
  const model::Fidelity fidelity = scenes_[0].fidelity;
  if (fidelity == model::Fidelity::automatic) {
    results = auto_.solve(tasks_);
  } else if (fidelity == model::Fidelity::axisym || fidelity == model::Fidelity::sliding) {
    if (!tasks_.empty())
      others = fidelity == model::Fidelity::axisym ? solvers::solve_axisym(group_, tasks_)
                                                   : solvers::solve_sliding(MPI_COMM_SELF, tasks_);
    results = others;
  } else {
    results = slices_.solve(tasks_);
    for (const solvers::SegmentTask& task : tasks_) chunk_.equilibria += equilibria_of(task);
  }
  const double share = (MPI_Wtime() - start) / static_cast<double>(designs);
  const model::Fidelity named = fidelity == model::Fidelity::automatic ? model::Fidelity::slice : fidelity;
  const model::SegmentResult invalid = model::without_numbers(model::Status::invalid, named),
                             not_wanted = model::without_numbers(model::Status::not_wanted, named);
  std::size_t next = 0;
  for (std::size_t k = 0; k < designs; ++k) {
    bool failed = false;
    for (std::size_t s = 0; s < segments; ++s) {
      model::SegmentResult& row = chunk_.rows[(first + k) * segments + s];
      row = !sound_[k] ? invalid : scenes_[k].wants(s) ? results[next++] : not_wanted;
      failed = failed || model::failed(row.status);
    }
    chunk_.failed += failed;
    chunk_.wall_times[first + k] = share;
  }
}

}  // namespace gaiter::studies
