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
  // What is kept of a task while its batch is solved.
  struct Task {
    std::size_t first = 0, end = 0;                  // its slices
    const physics::Quadrature* rule = nullptr;       // over the height
    const physics::Quadrature* wall_rule = nullptr;  // through the wall
    double wall_error = 0, voltage = 0;
    double data_limit = 0;  // pressure beyond which results are extrapolated [Pa]
    bool stiffens = false;  // one equilibrium at rest, whatever the pressure
  };

  void take(std::span<const SegmentTask> tasks);
  void prepare_solver(model::SliceSolver algorithm, double tolerance);
  void rigid_pressures();
  void solve_rigid();
  void rest();
  void actuate();
  void solve_doubtful(bool at_rest);
  void record(bool at_rest);
  void float_free(std::size_t slice);
  void finish_actuated(bool rigid);
  void small_drops(std::size_t pack, const physics::Pack& actuation);
  double height_error(const SegmentTask& task, const Task& own, bool rigid);
  double height_error_of_start(const SegmentTask& task, const Task& own, bool rigid);
  const physics::Quadrature& height_rule(model::SliceRule rule, int count);
  const physics::Quadrature& wall_rule(int points);
  template <typename Action>
  void each_slice(Action&& action);  // action(slice, task, its pack, its place in the pack)

  MPI_Comm comm_;
  std::map<std::pair<model::SliceRule, int>, physics::Quadrature> height_rules_;
  std::map<int, physics::Quadrature> wall_rules_;
  std::unique_ptr<SliceSolver> solver_;
  model::SliceSolver algorithm_ = model::SliceSolver::newton;  // of the solver
  double fixed_point_tolerance_ = 0;                           // likewise

  // Of the batch at hand.
  std::vector<Task> tasks_;
  bool energised_ = false;  // somewhere, on any rank
  bool newton_ = true;      // all ranks agree, those without tasks too
  physics::SliceSystem system_;
  std::vector<physics::PackState> states_;
  std::vector<physics::SliceOutcome> outcomes_;
  std::vector<physics::Pack> rigid_pressure_, rest_pressure_;
  std::vector<std::size_t> owner_;  // of each slice: its task
  std::vector<double> pressures_;   // of one task
  std::vector<double> radii_;       // of the leg at each slice
  std::vector<model::SegmentResult> results_;
};

// One batch by itself. @note Collective.
std::vector<model::SegmentResult> solve_segments(MPI_Comm comm, std::span<const SegmentTask> tasks);

}  // namespace gaiter::solvers
