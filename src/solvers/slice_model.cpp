// SPDX-License-Identifier: BSD-2-Clause
#include "gaiter/solvers/slice_model.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "gaiter/petsc/session.hpp"
#include "gaiter/physics/slice_kernel.hpp"
#include "gaiter/physics/wall_resolution.hpp"

namespace gaiter::solvers {

namespace {

using model::Status;
using physics::Pack;
using physics::pack_width;
using physics::SliceOutcome;
using physics::SliceShape;

constexpr double wall_tolerance =
    1e-12;  // of the quadrature through the wall, where the points are chosen here

double voltage_of(const SegmentTask& task) {
  return task.scene->bandage.modules[task.segment].voltage;
}

// A passive bandage of these terms presses harder the further it is stretched, so that there is one
// equilibrium.
bool has_only_stiffening_terms(const model::Bandage& bandage) {
  return std::all_of(bandage.ogden.begin(), bandage.ogden.end(), [](const model::OgdenTerm& term) {
    return term.mu * term.alpha >= 0 && std::fabs(term.alpha) >= 2;
  });
}

}  // namespace

const physics::Quadrature& SliceModel::height_rule(model::SliceRule rule, int count) {
  const auto [found, added] = height_rules_.try_emplace({rule, count});
  if (added) found->second = physics::slice_quadrature(rule, count);
  return found->second;
}

const physics::Quadrature& SliceModel::wall_rule(int points) {
  const auto [found, added] = wall_rules_.try_emplace(points);
  if (added) found->second = physics::gauss_legendre(points);
  return found->second;
}

// The tasks' slices, set up in the memory of the batch before.
void SliceModel::take(std::span<const SegmentTask> tasks) {
  tasks_.clear();
  SliceShape shape;
  int most_points = 1;
  bool voltage_somewhere = false, all_newton = true;
  std::size_t slices = 0;
  for (const SegmentTask& task : tasks) {
    const model::Scene& scene = *task.scene;
    const model::Discretisation& how = scene.discretisation;
    Task own;
    own.first = slices;
    own.end = slices += static_cast<std::size_t>(how.slice_count);
    int points = how.wall_points;
    if (points > 0) {
      own.wall_error = physics::wall_error(scene, task.segment, points);
    } else {
      const physics::WallChoice choice = physics::wall_points_for(scene, task.segment, wall_tolerance);
      points = choice.points;
      own.wall_error = choice.error;
    }
    own.rule = &height_rule(how.slice_rule, how.slice_count);
    own.wall_rule = &wall_rule(points);
    own.voltage = voltage_of(task);
    own.data_limit = scene.leg.material == model::LegMaterial::compliance
                         ? scene.leg.data_limit
                         : std::numeric_limits<double>::infinity();
    own.stiffens = has_only_stiffening_terms(scene.bandage);
    tasks_.push_back(own);
    most_points = std::max(most_points, points);
    shape.layers = std::max(shape.layers, own.voltage != 0 ? scene.bandage.layers : 0);
    shape.ogden_terms = static_cast<int>(scene.bandage.ogden.size());
    shape.material = scene.leg.material;
    voltage_somewhere = voltage_somewhere || own.voltage != 0;
    all_newton = all_newton && how.slice_solver == model::SliceSolver::newton;
  }
  energised_ = !petsc::agree(comm_, !voltage_somewhere);
  newton_ = petsc::agree(comm_, all_newton);
  shape.wall = wall_rule(most_points);
  system_.reset(std::move(shape), slices);
  states_.resize(system_.packs());
  rigid_pressure_.resize(system_.packs());
  rest_pressure_.resize(system_.packs());
  outcomes_.assign(slices, {});
  owner_.resize(slices);
  radii_.resize(slices);
  for (std::size_t t = 0; t < tasks.size(); ++t) {
    const Task& own = tasks_[t];
    const model::Scene& scene = *tasks[t].scene;
    const model::Segment& segment = scene.leg.segments[tasks[t].segment];
    const model::Module& module = scene.bandage.modules[tasks[t].segment];
    system_.set_segment(own.first, own.rule->nodes, scene.leg, segment, scene.bandage, module, *own.wall_rule,
                        std::span(radii_).subspan(own.first, own.end - own.first));
    const double reference =
        module.length > 0 ? module.length / (2 * M_PI) : segment.mean_radius() / module.stretch;
    for (std::size_t slice = own.first; slice < own.end; ++slice) {
      outcomes_[slice].leg_radius = radii_[slice];
      outcomes_[slice].reference_radius = reference;
      owner_[slice] = t;
    }
  }
}

// One solver serves all batches, unless one is larger than any before.
void SliceModel::prepare_solver(model::SliceSolver algorithm, double tolerance) {
  const bool fits = solver_ && system_.packs() <= solver_->packs() && algorithm == algorithm_ &&
                    tolerance == fixed_point_tolerance_;
  if (petsc::agree(comm_, fits)) return;
  algorithm_ = algorithm;
  fixed_point_tolerance_ = tolerance;
  solver_ = std::make_unique<SliceSolver>(comm_, system_.packs(), algorithm, tolerance);
}

// On a leg that does not give way; negative pressures mean no contact.
void SliceModel::rigid_pressures() {
  Pack none{}, slope, relief{};
  for (std::size_t k = 0; k < system_.packs(); ++k) {
    if (energised_) {
      system_.energise(true);
      physics::actuation_pressure(system_.shape(), system_.pack(k), none, relief, slope);
    }
    const Pack& scale = system_.pack(k)[SliceShape::pressure_scale];
    const std::size_t end = std::min(system_.slices() - k * pack_width, std::size_t{pack_width});
    for (std::size_t i = 0; i < end; ++i) {
      const double at_rest = rigid_pressure_[k][i], actuated = at_rest - relief[i];
      SliceOutcome& outcome = outcomes_[k * pack_width + i];
      outcome.pressure_rest_rigid = std::max(0.0, at_rest) * scale[i];
      outcome.pressure_actuated_rigid = std::max(0.0, actuated) * scale[i];
      outcome.actuation_drop = std::min(std::max(0.0, at_rest), relief[i]) * scale[i];
    }
  }
}

void SliceModel::solve_rigid() {
  system_.energise(false);
  Pack none{}, slope;
  for (std::size_t k = 0; k < system_.packs(); ++k)
    physics::bandage_pressure(system_.shape(), system_.pack(k), none, rigid_pressure_[k], slope);
  rigid_pressures();
  for (std::size_t slice = 0; slice < outcomes_.size(); ++slice) {
    SliceOutcome& outcome = outcomes_[slice];
    states_[slice / pack_width].strain[slice % pack_width] = 0;
    const double touching = outcome.leg_radius / system_.constant(slice, SliceShape::leg_radius);
    outcome.pressure_rest = outcome.pressure_rest_rigid;
    outcome.pressure_actuated = outcome.pressure_actuated_rigid;
    outcome.radius_rest = outcome.radius_actuated = outcome.leg_radius;
    outcome.bandage_radius_rest = outcome.bandage_radius_actuated =
        outcome.pressure_rest > 0 ? outcome.leg_radius : std::max(outcome.leg_radius, touching);
    if (outcome.pressure_rest == 0) outcome.status = Status::slack;
  }
}

std::span<const model::SegmentResult> SliceModel::solve(std::span<const SegmentTask> tasks) {
  take(tasks);
  const model::Scene* scene = tasks.empty() ? nullptr : tasks[0].scene;
  const bool rigid = petsc::largest(comm_, scene && (scene->fidelity == model::Fidelity::rigid ||
                                                     scene->leg.model == model::LegModel::rigid)) > 0;
  if (rigid) {
    solve_rigid();
  } else {
    prepare_solver(newton_ ? model::SliceSolver::newton : model::SliceSolver::fixed_point,
                   petsc::largest(comm_, scene ? scene->discretisation.fixed_point_tolerance : 0));
    rest();
    rigid_pressures();
    if (energised_) actuate();
  }
  system_.energise(true);
  if (energised_) finish_actuated(rigid);

  results_.clear();
  for (std::size_t t = 0; t < tasks_.size(); ++t) {
    const Task& own = tasks_[t];
    const double error = height_error(tasks[t], own, rigid) + own.wall_error;
    results_.push_back(physics::summarise(std::span(outcomes_).subspan(own.first, own.end - own.first),
                                          *own.rule, tasks[t].scene->leg.segments[tasks[t].segment].height,
                                          error));
    model::SegmentResult& result = results_.back();
    result.fidelity = rigid ? model::Fidelity::rigid : model::Fidelity::slice;
    // A slice's state is that of the branch from rest; where this one ends is not looked for.
    result.voltage_stable =
        result.status < Status::pulled_in ? own.voltage : std::numeric_limits<double>::quiet_NaN();
  }
  return results_;
}

std::vector<model::SegmentResult> solve_segments(MPI_Comm comm, std::span<const SegmentTask> tasks) {
  SliceModel model(comm);
  const auto results = model.solve(tasks);
  return {results.begin(), results.end()};
}

}  // namespace gaiter::solvers
