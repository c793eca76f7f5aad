// SPDX-License-Identifier: BSD-2-Clause
#pragma once

#include <mpi.h>

#include <array>
#include <limits>
#include <map>
#include <memory>
#include <span>
#include <utility>
#include <vector>

#include "gaiter/model/result.hpp"
#include "gaiter/physics/segment_forecast.hpp"
#include "gaiter/physics/segment_summary.hpp"
#include "gaiter/solvers/slice_solver.hpp"

namespace gaiter::solvers {

// How the slices of one segment are laid, where its scene does not say: see auto_model.hpp.
struct SlicePlan {
  model::Fidelity fidelity = model::Fidelity::slice;
  int slice_count = 6;  // Gauss points, in each piece between cuts
  int wall_points = 3;
  std::vector<double> cuts = {};  // heights in (0, 1), ascending, where the bandage leaves the leg
  double height_error = 0;        // predicted, relative
  double roughness = 0;  // 0 to 1: how little the leg's law lets the pressure's Legendre coefficients fall
  double wall_error = 0;
  double model_error = 0;      // against the finest model that the goal allows
  double change_beyond = 0;    // by the models beyond this one, allowed or not; NaN: not known
  double tolerance = 0;        // of the discretisation
  double newton_leaves = 0;    // of it, what Newton's method may leave in a slice's pressure; 0: the least
  double asked = 0;            // sum of tolerance and model_error
  double factor = 1;           // errors of the wanted outputs over those of the pressures
  double cost = 0;             // predicted, of planning and of all solves so far [s]
  double unforeseen = 0;       // of it, for refinements that the plan did not expect [s]
  bool actuated = true;        // false: the state under voltage is not wanted
  bool confirm = false;        // of sliding slices: their error is still to be found, from their residual
  bool stable_nearby = false;  // the residual of the slices has found stable states of finite elements

  // Of the wanted output where they are largest.
  double expected_discretisation_error() const { return factor * (height_error + wall_error); }
  double expected_model_error() const { return factor * model_error; }
};

// One segment of one design.
struct SegmentTask {
  const model::Scene* scene = nullptr;
  std::size_t segment = 0;
  const SlicePlan* plan = nullptr;  // null: as the scene says
};

// The slice model, or with Fidelity::rigid the rigid leg, or with Fidelity::first_order the rigid leg's
// pressures corrected to first order for its giving way: rest and actuated states of many segments, each as
// one SNES over all slices. Takes batch after batch; the SNES and all memory are made once and used again.
class SliceModel {
 public:
  explicit SliceModel(MPI_Comm comm) : comm_(comm) {}
  SliceModel(const SliceModel&) = delete;
  SliceModel& operator=(const SliceModel&) = delete;

  // All tasks of all ranks: every rank gives its own, none too, and gets their results in the same order,
  // good until the next call. They do not depend on how tasks are spread over ranks or batches. All scenes of
  // a call have the same fidelity (the plan's, where there is one), leg material, slice rule, solver and
  // number of Ogden terms; anything else may differ. @note Collective.
  std::span<const model::SegmentResult> solve(std::span<const SegmentTask> tasks);

 private:
  static constexpr double not_known = std::numeric_limits<double>::quiet_NaN();
  static constexpr int fewest_to_tell =
      6;  // slices, from which on their pressures tell of the height's error

  // What is known of the errors of a task that is not planned.
  struct Foreseen {
    double wall_error = 0;    // where its scene says how many points
    double height_error = 0;  // of few slices; or not_known
    double model_error = 0;   // of the rigid leg, or of the first order, against slices
  };

  struct FloatingSlice {
    std::size_t pack;
    int place;
    bool stiffens;  // its bandage, the further it is stretched
  };

  // Up to 64 segments with equally many slices. The first slices of all are a pack, and so on.
  struct Block {
    std::size_t first_pack = 0;
    const physics::Quadrature* rule = nullptr;  // over the height, or over each piece of it
    int pieces = 1;
    std::vector<physics::Pack> heights, weights;  // of the slices
    std::vector<std::size_t> tasks;               // one a place
    physics::SegmentPack segments;

    std::size_t end_pack() const { return first_pack + heights.size(); }
  };

  void foresee();
  void take(std::span<const SegmentTask> tasks);
  void arrange();
  void lay_slices(Block& block);
  void set_segments(std::span<const std::size_t> tasks, physics::SegmentPack& segments);
  void prepare_solver(model::SliceSolver algorithm, double fixed_point_tolerance, double newton_tolerance);
  void allow_newton();
  void rigid_pressures();
  void solve_rigid();
  void solve_first_order();
  void rest();
  void actuate();
  void solve_doubtful(bool at_rest);
  void record_rest(const Block& block, std::size_t pack);
  void record_actuated(const Block& block, std::size_t pack);
  void float_free();
  void float_free(std::span<const FloatingSlice> slices);
  void finish_actuated(model::Fidelity fidelity);
  void small_drops();
  void small_drops(const physics::Quadrature& gauss, std::span<const std::size_t> slices);
  void summarise(model::Fidelity fidelity);
  double error_before_slices(std::size_t task, model::Fidelity fidelity) const;
  void height_error(const Block& block, physics::Pack physics::SliceOutcomes::*quantity,
                    physics::Pack& relative) const;
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
  double fixed_point_tolerance_ = 0, newton_tolerance_ = 0;    // likewise

  // Of the batch at hand.
  std::span<const SegmentTask> tasks_;
  std::vector<physics::SegmentNumbers> numbers_;  // of each task
  bool planned_ = false;                          // some task has a plan; then all have
  std::vector<Foreseen> foreseen_;                // of each task, where it is needed
  std::vector<Block> blocks_;
  bool energised_ = false;  // somewhere, on any rank
  bool newton_ = true;      // all ranks agree, those without tasks too
  physics::SliceSystem system_;
  std::vector<physics::PackState> states_;
  std::vector<physics::SliceOutcomes> outcomes_;
  std::vector<physics::Pack> rigid_pressure_, rest_pressure_;
  std::vector<physics::Pack> radii_;     // of the leg at each slice
  std::vector<physics::Pack> gathered_;  // constants of slices from several packs
  std::vector<FloatingSlice> floating_;
  std::array<std::vector<std::size_t>, 3> small_drops_;  // slices, by how many points they need
  std::vector<int> places_;                              // in use in each pack
  std::vector<double> height_error_;                     // of each task
  std::vector<std::size_t> unclear_;                     // tasks whose pressures do not tell that error
  physics::SliceSystem check_;                           // their slices at more heights
  std::vector<model::SegmentResult> results_;
};

// One batch by itself. @note Collective.
std::vector<model::SegmentResult> solve_segments(MPI_Comm comm, std::span<const SegmentTask> tasks);

}  // namespace gaiter::solvers
