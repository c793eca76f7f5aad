// SPDX-License-Identifier: BSD-2-Clause
#pragma once

#include <mpi.h>

#include <map>
#include <memory>
#include <span>
#include <utility>
#include <vector>

#include "gaiter/model/result.hpp"
#include "gaiter/physics/segment_summary.hpp"
#include "gaiter/solvers/slice_solver.hpp"

namespace gaiter::solvers {

// One segment of one design.
struct SegmentTask {
  const model::Scene* scene = nullptr;
  std::size_t segment = 0;
};

// The slice model, or with Fidelity::rigid the rigid leg: rest and actuated states of many segments, each as
// one SNES over all slices. Takes batch after batch; the SNES and all memory are made once and used again.
class SliceModel {
 public:
  explicit SliceModel(MPI_Comm comm) : comm_(comm) {}
  SliceModel(const SliceModel&) = delete;
  SliceModel& operator=(const SliceModel&) = delete;

  // All tasks of all ranks: every rank gives its own, none too, and gets their results in the same order,
  // good until the next call. They do not depend on how tasks are spread over ranks or batches. All scenes of
  // a call have the same fidelity, leg material, slice rule, solver and number of Ogden terms; anything else
  // may differ. @note Collective.
  std::span<const model::SegmentResult> solve(std::span<const SegmentTask> tasks);

 private:
  // Up to 64 segments with equally many slices. Of the slices, all those at one height are a pack.
  struct Block {
    std::size_t first_pack = 0;
    const physics::Quadrature* rule = nullptr;  // over the height
    std::vector<std::size_t> tasks;             // one a place
    physics::SegmentPack segments;

    std::size_t end_pack() const { return first_pack + rule->nodes.size(); }
  };

  void take(std::span<const SegmentTask> tasks);
  void arrange();
  void set_segments(std::span<const std::size_t> tasks, physics::SegmentPack& segments);
  void prepare_solver(model::SliceSolver algorithm, double tolerance);
  void rigid_pressures();
  void solve_rigid();
  void rest();
  void actuate();
  void solve_doubtful(bool at_rest);
  void float_free(const Block& block, std::size_t pack);
  void finish_actuated();
  void summarise(bool rigid);
  void height_errors(const Block& block);
  void errors_of_start(bool rigid);
  void errors_of_start(std::span<const std::size_t> tasks, bool rigid);
  const physics::Quadrature& height_rule(model::SliceRule rule, int count);
  const physics::Quadrature& wall_rule(int points);
  template <typename Action>
  void each_pack(Action&& action) {  // action(block, pack)
    for (const Block& block : blocks_)
      for (std::size_t k = block.first_pack; k < block.end_pack(); ++k) action(block, k);
  }

  MPI_Comm comm_;
  std::map<std::pair<model::SliceRule, int>, physics::Quadrature> height_rules_;
  std::map<int, physics::Quadrature> wall_rules_;
  std::unique_ptr<SliceSolver> solver_;
  model::SliceSolver algorithm_ = model::SliceSolver::newton;  // of the solver
  double fixed_point_tolerance_ = 0;                           // likewise

  // Of the batch at hand.
  std::span<const SegmentTask> tasks_;
  std::vector<physics::SegmentNumbers> numbers_;  // of each task
  std::vector<Block> blocks_;
  bool energised_ = false;  // somewhere, on any rank
  bool newton_ = true;      // all ranks agree, those without tasks too
  physics::SliceSystem system_;
  std::vector<physics::PackState> states_;
  std::vector<physics::SliceOutcomes> outcomes_;
  std::vector<physics::Pack> rigid_pressure_, rest_pressure_;
  std::vector<physics::Pack> radii_;  // of the leg at each slice
  std::vector<double> height_error_;  // of each task
  std::vector<std::size_t> unclear_;  // tasks whose pressures do not tell that error
  physics::SliceSystem check_;        // their slices at more heights
  std::vector<model::SegmentResult> results_;
};

// One batch by itself. @note Collective.
std::vector<model::SegmentResult> solve_segments(MPI_Comm comm, std::span<const SegmentTask> tasks);

}  // namespace gaiter::solvers
