// SPDX-License-Identifier: BSD-2-Clause
#include "gaiter/studies/solve.hpp"

#include <type_traits>

#include "gaiter/petsc/session.hpp"
#include "gaiter/solvers/auto_model.hpp"
#include "gaiter/solvers/axisym_model.hpp"
#include "gaiter/solvers/slice_model.hpp"
#include "gaiter/solvers/sliding_model.hpp"
#include "gaiter/studies/rank_groups.hpp"

namespace gaiter::studies {

bool may_take_axisym(const model::Scene& scene) {
  return scene.fidelity == model::Fidelity::axisym ||
         (scene.fidelity == model::Fidelity::automatic && scene.goal.up_to == model::Fidelity::axisym);
}

Solution solve_scene(MPI_Comm comm, const model::Scene& scene, const solvers::AxisymObserver& observer) {
  const bool axisym = scene.fidelity == model::Fidelity::axisym;
  const RankGroups groups(comm, may_take_axisym(scene) ? scene.axisym.ranks_per_case : 1);
  const std::size_t segments = scene.leg.segments.size();
  // What is solved as a whole stays together: a segment, or all of a leg.
  const std::size_t whole = axisym && scene.axisym.scope == model::AxisymScope::leg ? segments : 1;
  const std::size_t first = segments / whole * groups.mine / groups.count * whole,
                    last = segments / whole * (groups.mine + 1) / groups.count * whole;

  const double start = MPI_Wtime();
  std::vector<solvers::SegmentTask> tasks;
  for (std::size_t segment = first; segment < last; ++segment)
    if (scene.wants(segment)) tasks.push_back({&scene, segment});

  // Ranks without tasks take part too.
  Solution solution{first, {}, 0};
  if (axisym)
    solution.rows = solvers::solve_axisym(groups.group, tasks, observer);
  else if (scene.fidelity == model::Fidelity::automatic) {
    solvers::AutoModel model(groups.group);
    const auto rows = model.solve(tasks);
    solution.rows.assign(rows.begin(), rows.end());
  } else if (scene.fidelity == model::Fidelity::sliding)
    solution.rows = solvers::solve_sliding(comm, tasks);
  else
    solution.rows = solvers::solve_segments(comm, tasks);
  for (std::size_t segment = first; segment < last; ++segment)
    if (!scene.wants(segment))
      solution.rows.insert(solution.rows.begin() + static_cast<std::ptrdiff_t>(segment - first),
                           model::without_numbers(model::Status::not_wanted, model::Fidelity::slice));
  // Of a group, the first rank keeps the results.
  if (petsc::rank(groups.group) > 0) solution.rows.clear();
  solution.seconds = petsc::largest(comm, MPI_Wtime() - start);
  return solution;
}

std::vector<model::SegmentResult> gather(MPI_Comm comm, const Solution& solution) {
  static_assert(std::is_trivially_copyable_v<model::SegmentResult>);
  const int ranks = petsc::size(comm),
            bytes = static_cast<int>(solution.rows.size() * sizeof(model::SegmentResult));
  std::vector<int> sizes(ranks), offsets(ranks + 1, 0);
  MPI_Allgather(&bytes, 1, MPI_INT, sizes.data(), 1, MPI_INT, comm);
  for (int r = 0; r < ranks; ++r) offsets[r + 1] = offsets[r] + sizes[r];
  std::vector<model::SegmentResult> all(offsets[ranks] / sizeof(model::SegmentResult));
  MPI_Allgatherv(solution.rows.data(), bytes, MPI_BYTE, all.data(), sizes.data(), offsets.data(), MPI_BYTE,
                 comm);
  return all;
}

}  // namespace gaiter::studies
