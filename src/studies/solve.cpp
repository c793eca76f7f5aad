// SPDX-License-Identifier: BSD-2-Clause
#include "gaiter/studies/solve.hpp"

#include <type_traits>

#include "gaiter/petsc/session.hpp"
#include "gaiter/solvers/axisym_model.hpp"
#include "gaiter/solvers/slice_model.hpp"
#include "gaiter/solvers/sliding_model.hpp"

namespace gaiter::studies {

namespace {

// Groups of ranks that share a finite element mesh; otherwise every rank is a group of its own.
class Groups {
 public:
  Groups(MPI_Comm comm, int ranks_per_group) {
    const int rank = petsc::rank(comm);
    count = (petsc::size(comm) + ranks_per_group - 1) / ranks_per_group;
    mine = rank / ranks_per_group;
    MPI_Comm_split(comm, mine, rank, &group);
  }
  ~Groups() { MPI_Comm_free(&group); }
  Groups(const Groups&) = delete;
  Groups& operator=(const Groups&) = delete;

  MPI_Comm group = MPI_COMM_NULL;
  std::size_t count = 1, mine = 0;
};

}  // namespace

Solution solve_designs(MPI_Comm comm, const model::Scene& scene, const Designs& designs,
                       const solvers::AxisymObserver& observer) {
  const bool axisym = scene.fidelity == model::Fidelity::axisym;
  const Groups groups(comm, axisym ? scene.axisym.ranks_per_case : 1);
  const std::size_t segments = scene.leg.segments.size();
  const std::size_t rows = static_cast<std::size_t>(designs.size()) * segments;
  // What is solved as a whole stays together: a row, or all rows of a leg.
  const std::size_t whole = axisym && scene.axisym.scope == model::AxisymScope::leg ? segments : 1;
  const std::size_t first = rows / whole * groups.mine / groups.count * whole,
                    last = rows / whole * (groups.mine + 1) / groups.count * whole;

  const double start = MPI_Wtime();
  std::vector<model::Scene> scenes;
  std::vector<solvers::SegmentTask> tasks;
  const std::size_t first_design = first / segments;
  if (last > first)
    for (std::size_t design = first_design; design <= (last - 1) / segments; ++design) {
      scenes.push_back(scene);
      designs.apply(static_cast<std::int64_t>(design), scenes.back());
    }
  for (std::size_t row = first; row < last; ++row)
    tasks.push_back({&scenes[row / segments - first_design], row % segments});

  // Ranks without tasks take part too, and all scenes have the fidelity of the one given.
  Solution solution{first, {}, 0};
  if (axisym)
    solution.rows = solvers::solve_axisym(groups.group, tasks, observer);
  else if (scene.fidelity == model::Fidelity::sliding)
    solution.rows = solvers::solve_sliding(comm, tasks);
  else
    solution.rows = solvers::solve_segments(comm, tasks);
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
  MPI_Gather(&bytes, 1, MPI_INT, sizes.data(), 1, MPI_INT, 0, comm);
  for (int r = 0; r < ranks; ++r) offsets[r + 1] = offsets[r] + sizes[r];
  std::vector<model::SegmentResult> all(offsets[ranks] / sizeof(model::SegmentResult));
  MPI_Gatherv(solution.rows.data(), bytes, MPI_BYTE, all.data(), sizes.data(), offsets.data(), MPI_BYTE, 0,
              comm);
  return all;
}

std::array<double, 7> count_status(MPI_Comm comm, const Solution& solution) {
  std::array<double, 7> local{}, all{};
  for (const model::SegmentResult& row : solution.rows) ++local[static_cast<std::size_t>(row.status)];
  MPI_Allreduce(local.data(), all.data(), 7, MPI_DOUBLE, MPI_SUM, comm);
  return all;
}

}  // namespace gaiter::studies
