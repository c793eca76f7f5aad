// SPDX-License-Identifier: BSD-2-Clause
#include "gaiter/solvers/sliding_model.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "gaiter/petsc/session.hpp"
#include "gaiter/physics/segment_forecast.hpp"
#include "gaiter/physics/sliding_summary.hpp"
#include "gaiter/physics/wall_resolution.hpp"
#include "gaiter/solvers/sliding_solver.hpp"

namespace gaiter::solvers {

namespace {

using model::Status;
using physics::Pack;
using physics::pack_width;
using physics::SlidingOutcome;
using physics::SlidingSlice;
using physics::SlidingState;

constexpr double wall_tolerance =
    1e-12;  // of the quadrature through the wall, where the points are chosen here
constexpr double first_stride = 0.125;  // of a path, when a segment has to walk
constexpr double last_stride = 1.0 / 512;
constexpr double path_start = 0.25;  // of the rest state's: this part of the stretch beyond 1

double voltage_of(const SegmentTask& task) {
  if (task.plan && !task.plan->actuated) return 0;
  return task.scene->bandage.modules[task.segment].voltage;
}

int wall_points_of(const SegmentTask& task) {
  if (task.plan) return task.plan->wall_points;
  const int asked = task.scene->discretisation.wall_points;
  return asked > 0 ? asked : physics::wall_points_for(*task.scene, task.segment, wall_tolerance).points;
}

// What all of these tasks fit into.
physics::SliceShape common_slice_shape(std::span<const SegmentTask> tasks) {
  physics::SliceShape shape;
  int points = 1;
  for (const SegmentTask& task : tasks) {
    const model::Scene& scene = *task.scene;
    points = std::max(points, wall_points_of(task));
    shape.layers = std::max(shape.layers, voltage_of(task) != 0 ? scene.bandage.layers : 0);
    shape.ogden_terms = static_cast<int>(scene.bandage.ogden.size());
    shape.material = scene.leg.material;
  }
  shape.wall = physics::gauss_legendre(points);
  return shape;
}

physics::SlidingShape common_shape(MPI_Comm comm, std::span<const SegmentTask> tasks) {
  double slices = 0;
  for (const SegmentTask& task : tasks)
    slices = std::max<double>(slices,
                              task.plan ? task.plan->slice_count : task.scene->discretisation.sliding_count);
  return {physics::sliding_elements(static_cast<int>(petsc::largest(comm, slices))), false};
}

// The segments of this rank's tasks on the way from rest to the actuated state.
class SlidingStudy {
 public:
  SlidingStudy(MPI_Comm comm, std::span<const SegmentTask> tasks);
  std::vector<model::SegmentResult> run();
  const SlidingOutcome& outcome(std::size_t task) const { return outcomes_[task]; }

 private:
  // How far a segment that has to walk has come.
  struct Walk {
    std::size_t segment = 0;
    double done = -1;  // of its path; -1: not at its start yet
    double stride = first_stride;
    std::vector<double> unknown;  // where it stands
    bool over = false;
  };

  void rest();
  void actuate();
  void solve();
  void walk(bool at_rest);
  bool take_stride(std::vector<Walk>& walks, bool at_rest);
  void record(bool at_rest, bool rigid);
  std::vector<std::vector<SlidingSlice>> describe() const;
  double voltage(std::size_t segment) const { return voltage_of(tasks_[segment]); }
  SlidingState& state(std::size_t segment) { return states_[segment / pack_width]; }
  static int lane(std::size_t segment) { return static_cast<int>(segment % pack_width); }
  void set(std::size_t segment, double overstretch = 1, double drive = 1) {
    system_.set(segment, *tasks_[segment].scene, tasks_[segment].segment, wall_rules_[segment], overstretch,
                drive);
  }
  std::vector<double> copy_unknown(std::size_t segment);
  void set_unknown(std::size_t segment, const std::vector<double>& unknown);

  MPI_Comm comm_;
  std::span<const SegmentTask> tasks_;
  std::vector<physics::Quadrature> wall_rules_;  // of each task
  physics::SlidingSystem system_;
  std::vector<SlidingState> states_;
  SlidingSolver solver_;
  bool energised_ = false;       // somewhere, on any rank
  bool rigid_leg_ = false;       // nothing but the rigid leg is asked for
  std::vector<Status> found_;    // of each segment in the states as they are: contact, or why there are none
  std::vector<double> reached_;  // part of the square of its voltage that each has come to; NaN: not to rest
  std::vector<SlidingOutcome> outcomes_;
};

SlidingStudy::SlidingStudy(MPI_Comm comm, std::span<const SegmentTask> tasks)
    : comm_(comm),
      tasks_(tasks),
      system_(common_shape(comm, tasks), common_slice_shape(tasks), tasks.size()),
      states_(system_.packs(), SlidingState(system_.shape().slices())),
      solver_(comm, system_.packs(), system_.shape().slices()),
      found_(tasks.size(), Status::contact),
      reached_(tasks.size()),
      outcomes_(tasks.size()) {
  double voltages = 0, rigid = 0;
  for (std::size_t t = 0; t < tasks_.size(); ++t) {
    wall_rules_.push_back(physics::gauss_legendre(wall_points_of(tasks_[t])));
    set(t);
    voltages = std::max(voltages, std::fabs(voltage(t)));
    rigid = tasks_[t].scene->leg.model == model::LegModel::rigid ? 1 : 0;
  }
  energised_ = petsc::largest(comm_, voltages) > 0;
  rigid_leg_ = petsc::largest(comm_, rigid) > 0;
}

std::vector<double> SlidingStudy::copy_unknown(std::size_t segment) {
  std::vector<double> unknown;
  for (const Pack& row : state(segment).unknown) unknown.push_back(row[lane(segment)]);
  return unknown;
}

void SlidingStudy::set_unknown(std::size_t segment, const std::vector<double>& unknown) {
  for (std::size_t row = 0; row < unknown.size(); ++row)
    state(segment).unknown[row][lane(segment)] = unknown[row];
}

// Solves what is open; an equilibrium that cannot be trusted counts as failed.
void SlidingStudy::solve() {
  std::vector<Pack> opened;
  for (const SlidingState& state : states_) opened.push_back(state.open);
  solver_.solve(system_, states_);
  Pack trusted;
  for (std::size_t k = 0; k < states_.size(); ++k) {
    physics::judge_sliding(system_, k, states_[k], trusted);
    for (int i = 0; i < pack_width; ++i)
      if (opened[k][i] > 0 && !(trusted[i] > 0)) states_[k].failed[i] = 1;
  }
}

void SlidingStudy::rest() {
  system_.energise(false);
  std::fill(found_.begin(), found_.end(), Status::contact);
  for (std::size_t k = 0; k < system_.packs(); ++k) physics::start_sliding(system_, k, states_[k]);
  solve();
  walk(true);
}

void SlidingStudy::actuate() {
  system_.energise(true);
  std::vector<std::vector<double>> at_rest;
  for (std::size_t t = 0; t < tasks_.size(); ++t) {
    const bool moves = voltage(t) != 0 && found_[t] == Status::contact;
    state(t).open[lane(t)] = moves ? 1 : 0;
    state(t).last_step[lane(t)] = 0;
    at_rest.push_back(copy_unknown(t));
  }
  solve();
  for (std::size_t t = 0; t < tasks_.size(); ++t)
    if (state(t).failed[lane(t)] > 0) set_unknown(t, at_rest[t]);
  walk(false);
}

// One stride of each walk that is not over. False: there is none left, on any rank.
bool SlidingStudy::take_stride(std::vector<Walk>& walks, bool at_rest) {
  double walking = 0;
  for (Walk& walk : walks) {
    if (walk.over) continue;
    const std::size_t t = walk.segment;
    const double goal = walk.done < 0 ? path_start : std::min(1.0, walk.done + walk.stride);
    set(t, at_rest ? goal : 1, at_rest ? 1 : goal);
    if (walk.done < 0 && at_rest) {
      SlidingState start(system_.shape().slices());
      physics::start_sliding(system_, t / pack_width, start);
      walk.unknown.clear();
      for (const Pack& row : start.unknown) walk.unknown.push_back(row[lane(t)]);
    }
    set_unknown(t, walk.unknown);
    state(t).open[lane(t)] = 1;
    state(t).failed[lane(t)] = state(t).last_step[lane(t)] = 0;
    ++walking;
  }
  if (petsc::sum(comm_, walking) == 0) return false;
  solve();
  for (Walk& walk : walks) {
    if (walk.over) continue;
    const std::size_t t = walk.segment;
    if (state(t).failed[lane(t)] > 0) {
      walk.stride *= 0.5;
      walk.over = walk.done < 0 || walk.stride < last_stride;
    } else {
      walk.unknown = copy_unknown(t);
      walk.done = walk.done < 0 ? path_start : std::min(1.0, walk.done + walk.stride);
      walk.stride *= 1.5;
      walk.over = walk.done >= 1;
    }
  }
  return true;
}

// Segments that failed, one by one along their paths.
void SlidingStudy::walk(bool at_rest) {
  std::vector<Walk> walks;
  for (std::size_t t = 0; t < tasks_.size(); ++t)
    if (state(t).failed[lane(t)] > 0) {
      walks.emplace_back();
      walks.back().segment = t;
      walks.back().unknown = copy_unknown(t);
      if (!at_rest) walks.back().done = 0;
    }
  while (take_stride(walks, at_rest)) {
  }
  for (const Walk& walk : walks) {
    const std::size_t t = walk.segment;
    set(t);
    state(t).open[lane(t)] = state(t).failed[lane(t)] = 0;
    set_unknown(t, walk.unknown);
    if (!at_rest) reached_[t] = walk.done;
    if (walk.done >= 1) continue;
    const int slices = system_.shape().slices();
    const bool lifted = std::all_of(walk.unknown.begin() + slices, walk.unknown.end(),
                                    [](double contact) { return contact <= 0; });
    found_[t] = walk.done < 0        ? Status::diverged
                : lifted && !at_rest ? Status::pulled_in
                                     : Status::no_equilibrium;
  }
}

// The slices of all segments in the states as they are.
std::vector<std::vector<SlidingSlice>> SlidingStudy::describe() const {
  const int slices = system_.shape().slices();
  std::vector<std::vector<SlidingSlice>> described(tasks_.size(), std::vector<SlidingSlice>(slices));
  physics::SlidingPlace place;
  physics::SlidingCircle circle;
  for (std::size_t pack = 0; pack < states_.size(); ++pack)
    for (int slice = 0; slice < slices; ++slice) {
      physics::sliding_place(system_, pack, states_[pack].unknown, slice, place);
      physics::describe_circle(system_.shape(), system_.slice_shape(), system_.section(pack),
                               system_.pack(pack), place, circle);
      for (int i = 0; i < pack_width && pack * pack_width + i < tasks_.size(); ++i) {
        const std::size_t t = pack * pack_width + i;
        const double inner = system_.inner_radius(t), scale = system_.pressure_scale(t);
        const double height = tasks_[t].scene->leg.segments[tasks_[t].segment].height;
        SlidingSlice& out = described[t][slice];
        out.reference_height = height * physics::slice_height(system_.shape(), slice);
        out.share = physics::slice_share(system_.shape(), slice);
        out.height = 0.5 * height + place.height[i] * inner;
        out.axial_stretch = 1 + place.advance[i];
        out.pressure = circle.pressure[i] * scale;
        out.leg_radius_before = circle.leg_radius[i] * inner;
        out.leg_radius = out.leg_radius_before * (1 - circle.leg_strain[i]);
        out.tube_radius = circle.tube_radius[i] * inner;
        out.actuation_pressure = circle.actuation_pressure[i] * scale;
        out.electric_field = circle.field[i] * voltage(t) / inner;
      }
    }
  return described;
}

// The states as they are to outcomes.
void SlidingStudy::record(bool at_rest, bool rigid) {
  const std::vector<std::vector<SlidingSlice>> described = describe();
  for (std::size_t t = 0; t < tasks_.size(); ++t) {
    SlidingOutcome& outcome = outcomes_[t];
    const bool none = !model::trustworthy(found_[t]);
    const std::vector<SlidingSlice>& slices = described[t];
    const double mean =
        none ? std::numeric_limits<double>::quiet_NaN() : physics::height_mean_pressure(slices);
    if (rigid) (at_rest ? outcome.pressure_rest_rigid : outcome.pressure_actuated_rigid) = mean;
    if (rigid && !rigid_leg_) continue;
    outcome.status = std::max(outcome.status, found_[t]);
    outcome.iterations = std::max(outcome.iterations, static_cast<int>(state(t).iterations[lane(t)]));
    if (!at_rest) outcome.voltage_stable = std::sqrt(reached_[t]) * voltage(t);
    const model::Leg& leg = tasks_[t].scene->leg;
    for (std::size_t k = 0; k < slices.size(); ++k) {
      const bool open = slices[k].pressure == 0;
      if (open && at_rest) outcome.status = std::max(outcome.status, Status::slack);
      if (open && !at_rest && outcome.rest[k].pressure > 0)
        outcome.status = std::max(outcome.status, Status::lifted);
      if (slices[k].pressure > leg.data_limit && leg.material == model::LegMaterial::compliance && !rigid)
        outcome.status = std::max(outcome.status, Status::extrapolated);
    }
    const double inner = system_.inner_radius(t);
    outcome.slip_max =
        std::max(outcome.slip_max, inner * physics::largest_slip(system_.shape(), state(t).unknown, lane(t)));
    (at_rest ? outcome.rest : outcome.actuated) = slices;
  }
}

std::vector<model::SegmentResult> SlidingStudy::run() {
  for (bool rigid : {true, false}) {
    if (!rigid && rigid_leg_) continue;
    system_.set_rigid(rigid);
    rest();
    record(true, rigid);
    for (std::size_t t = 0; t < tasks_.size(); ++t)
      reached_[t] = found_[t] == Status::contact ? 1 : std::numeric_limits<double>::quiet_NaN();
    if (energised_) actuate();
    record(false, rigid);
  }
  std::vector<model::SegmentResult> results;
  for (std::size_t t = 0; t < tasks_.size(); ++t) {
    const model::Scene& scene = *tasks_[t].scene;
    const model::Segment& leg = scene.leg.segments[tasks_[t].segment];
    const model::Module& module = scene.bandage.modules[tasks_[t].segment];
    const double reference =
        module.length > 0 ? module.length / (2 * M_PI) : leg.mean_radius() / module.stretch;
    const int points = static_cast<int>(wall_rules_[t].nodes.size());
    double wall_error = std::numeric_limits<double>::quiet_NaN();
    if (tasks_[t].plan) {
      wall_error = tasks_[t].plan->wall_error;
    } else if (scene.discretisation.wall_points > 0) {
      physics::SegmentForecast forecast(scene, tasks_[t].segment);
      forecast.analyse();
      wall_error = forecast.wall_error(points);
    }
    // Also where a forecast expects no pressure.
    if (!std::isfinite(wall_error)) wall_error = physics::wall_error(scene, tasks_[t].segment, points);
    results.push_back(physics::summarise_sliding(outcomes_[t], leg.height, leg.lower_radius, leg.upper_radius,
                                                 reference, wall_error));
    results.back().slice_count = system_.shape().slices();
    results.back().unknowns = system_.shape().unknowns();
    results.back().wall_points = points;
  }
  return results;
}

SlidingProfile profile(const std::vector<SlidingSlice>& slices) {
  SlidingProfile out;
  for (const SlidingSlice& slice : slices) {
    out.reference_height.push_back(slice.reference_height);
    out.height.push_back(slice.height);
    out.axial_stretch.push_back(slice.axial_stretch);
    out.tube_radius.push_back(slice.tube_radius);
    out.leg_radius.push_back(slice.leg_radius);
    out.pressure.push_back(slice.pressure);
  }
  return out;
}

}  // namespace

std::vector<model::SegmentResult> solve_sliding(MPI_Comm comm, std::span<const SegmentTask> tasks) {
  return SlidingStudy(comm, tasks).run();
}

SlidingSolution solve_sliding(const SegmentTask& task) {
  SlidingStudy study(PETSC_COMM_SELF, std::span(&task, 1));
  const auto results = study.run();
  return {results[0], profile(study.outcome(0).rest), profile(study.outcome(0).actuated)};
}

}  // namespace gaiter::solvers
