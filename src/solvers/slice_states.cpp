// SPDX-License-Identifier: BSD-2-Clause
// The states that the slices of a batch pass through: at rest, under voltage, and what is found in each.
#include <algorithm>
#include <cmath>

#include "gaiter/petsc/session.hpp"
#include "gaiter/physics/branch.hpp"
#include "gaiter/physics/height_error.hpp"
#include "gaiter/physics/slice_kernel.hpp"
#include "gaiter/solvers/slice_model.hpp"

namespace gaiter::solvers {

using model::Status;
using physics::Pack;
using physics::pack_width;
using physics::PackState;
using physics::SliceOutcome;
using physics::SliceShape;

namespace {

constexpr double caution = 10;            // of an error estimated from starting values instead of solutions
constexpr double smallest_error = 4e-15;  // of a sum of some slices, by rounding
constexpr double small_actuation =
    0.1;  // of the pressure at rest: a part of the path that few points resolve
constexpr double error_of_drop = 1e-10;  // relative, for which its difference of pressures is good enough
constexpr int most_check_points = 128;   // over the height, of the rule that an error estimate compares with
// f' of the scalar equation of a slice: 1 for a bandage that does not stiffen or soften with the leg's
// radius. Below this there may be a limit point near by, and the equilibrium is searched for along the path.
constexpr double doubtful_slope = 0.5;

}  // namespace

template <typename Action>
void SliceModel::each_slice(Action&& action) {
  for (std::size_t slice = 0; slice < owner_.size(); ++slice)
    action(slice, owner_[slice], slice / pack_width, static_cast<int>(slice % pack_width));
}

void SliceModel::rest() {
  system_.energise(false);
  solver_->solve(system_, states_, [&](std::size_t k) {
    const Pack* rows = system_.pack(k);
    if (newton_) {
      physics::start_at_rest(system_.shape(), rows, states_[k], rigid_pressure_[k]);
    } else {
      Pack none{}, slope;
      physics::bandage_pressure(system_.shape(), rows, none, rigid_pressure_[k], slope);
      physics::start_fixed_point(true, states_[k]);
    }
  });
  if (newton_) solve_doubtful(true);
  record(true);
}

void SliceModel::actuate() {
  system_.energise(true);
  for (std::size_t k = 0; k < system_.packs(); ++k) {
    rest_pressure_[k] = states_[k].pressure;
    newton_ ? physics::start_actuated(states_[k]) : physics::start_fixed_point(false, states_[k]);
  }
  each_slice([&](std::size_t slice, std::size_t t, std::size_t pack, int place) {
    if (tasks_[t].voltage == 0 || outcomes_[slice].status >= Status::no_equilibrium)
      states_[pack].open[place] = 0;
  });
  solver_->solve(system_, states_);
  if (newton_) solve_doubtful(false);
  record(false);
}

// Slices whose equation was, somewhere on the way, too flat for Newton's root to be surely the one that the
// bandage reaches: find the interval of that one, and solve again inside it.
void SliceModel::solve_doubtful(bool at_rest) {
  double reopened = 0;
  each_slice([&](std::size_t slice, std::size_t t, std::size_t pack, int place) {
    PackState& state = states_[pack];
    const bool sure = at_rest && tasks_[t].stiffens;
    const bool soft = !tasks_[t].stiffens || state.smallest_slope[place] < doubtful_slope;
    const double highest =
        at_rest ? system_.constant(slice, SliceShape::pressure_limit) : rest_pressure_[pack][place];
    if (sure || !soft || state.iterations[place] == 0 || !(highest > 0)) return;
    const auto found = physics::contact_interval(system_, slice, highest, at_rest);
    state.open[place] = found ? 1 : 0;
    if (found) {
      state.low[place] = std::min(found->from, found->to);
      state.high[place] = std::max(found->from, found->to);
      state.pressure[place] = 0.5 * (found->from + found->to);
      ++reopened;
    } else {
      state.pressure[place] = 0;
    }
  });
  if (petsc::sum(comm_, reopened) == 0) return;
  solver_->solve(system_, states_, [&](std::size_t k) {
    // The iterates start on the leg's law.
    Pack strain, slope;
    physics::leg_strain(system_.shape(), system_.pack(k), states_[k].pressure, strain, slope);
    for (int i = 0; i < pack_width; ++i)
      if (states_[k].open[i] > 0 || states_[k].pressure[i] == 0) states_[k].strain[i] = strain[i];
  });
}

// States of the slices to outcomes.
void SliceModel::record(bool at_rest) {
  for (std::size_t k = 0; k < system_.packs(); ++k) {
    // The last step left the strain on a tangent of the leg's law, and a slice without contact where it was.
    PackState& state = states_[k];
    physics::leg_strain(system_.shape(), system_.pack(k), state.pressure, state.strain, state.strain_slope);
  }
  each_slice([&](std::size_t slice, std::size_t t, std::size_t pack, int place) {
    SliceOutcome& outcome = outcomes_[slice];
    const PackState& state = states_[pack];
    const double pressure = state.pressure[place] * system_.constant(slice, SliceShape::pressure_scale);
    const double radius = outcome.leg_radius * (1 - state.strain[place]);
    const double touching = outcome.leg_radius / system_.constant(slice, SliceShape::leg_radius);  // A
    outcome.iterations = std::max(outcome.iterations, static_cast<int>(state.iterations[place]));
    if (state.open[place] > 0 || state.failed[place] > 0)
      outcome.status = std::max(outcome.status, Status::diverged);
    if (pressure > tasks_[t].data_limit) outcome.status = std::max(outcome.status, Status::extrapolated);
    if (at_rest) {
      outcome.pressure_rest = pressure;
      outcome.radius_rest = radius;
      outcome.bandage_radius_rest = pressure > 0 ? radius : std::max(radius, touching);
      if (pressure == 0) outcome.status = std::max(outcome.status, Status::slack);
    }
    const double error = physics::pressure_error(system_, slice, state, tasks_[t].wall_error) *
                         system_.constant(slice, SliceShape::pressure_scale);
    (at_rest ? outcome.error_rest : outcome.error_actuated) = error;
    if (!at_rest) outcome.actuation_drop = outcome.pressure_rest - pressure;
    outcome.pressure_actuated = pressure;
    outcome.strain_actuated = state.strain[place];
    outcome.radius_actuated = radius;
    outcome.bandage_radius_actuated = pressure > 0 ? radius : std::max(radius, touching);
  });
}

// A bandage under voltage that does not touch the leg: its own equilibrium, if it has one.
void SliceModel::float_free(std::size_t slice) {
  SliceOutcome& outcome = outcomes_[slice];
  const double start = 1 - outcome.bandage_radius_actuated / outcome.leg_radius;
  const auto strain = physics::floating_strain(system_, slice, start);
  const Status found = outcome.pressure_rest > 0 ? Status::lifted : Status::slack;
  outcome.status = std::max(outcome.status, strain ? found : Status::pulled_in);
  if (strain) outcome.bandage_radius_actuated = outcome.leg_radius * (1 - *strain);
}

// What needs the actuated radius of the bandage: lift-off, actuation pressure, field.
void SliceModel::finish_actuated(bool rigid) {
  Pack strain, pressure, slope, field;
  for (std::size_t k = 0; k < system_.packs(); ++k) {
    strain = states_[k].strain;
    const std::size_t first = k * pack_width, end = std::min(outcomes_.size(), first + pack_width);
    for (std::size_t slice = first; slice < end; ++slice) {
      SliceOutcome& outcome = outcomes_[slice];
      if (outcome.status >= Status::no_equilibrium) continue;
      if (tasks_[owner_[slice]].voltage != 0 && outcome.pressure_actuated == 0) float_free(slice);
      strain[slice - first] = 1 - outcome.bandage_radius_actuated / outcome.leg_radius;
    }
    physics::actuation_pressure(system_.shape(), system_.pack(k), strain, pressure, slope);
    physics::largest_field(system_.shape(), system_.pack(k), strain, field);
    for (std::size_t slice = first; slice < end; ++slice) {
      SliceOutcome& outcome = outcomes_[slice];
      const double inner = outcome.leg_radius / system_.constant(slice, SliceShape::leg_radius);
      outcome.actuation_pressure =
          pressure[slice - first] * system_.constant(slice, SliceShape::pressure_scale);
      outcome.electric_field = field[slice - first] * tasks_[owner_[slice]].voltage / inner;
    }
    if (!rigid) small_drops(k, pressure);
  }
}

// A drop that is small beside the pressures, whose difference would have few of its digits: that of the
// residual at rest between the two states, which is the actuation pressure, over its mean slope.
void SliceModel::small_drops(std::size_t k, const Pack& actuation) {
  const std::size_t first = k * pack_width, end = std::min(outcomes_.size(), first + pack_width);
  const auto is_small = [&](const SliceOutcome& slice) {
    return slice.pressure_actuated > 0 && slice.actuation_pressure < small_actuation * slice.pressure_rest &&
           slice.error_rest + slice.error_actuated > error_of_drop * slice.actuation_drop;
  };
  if (std::none_of(outcomes_.begin() + first, outcomes_.begin() + end, is_small)) return;
  static const physics::Quadrature gauss = physics::gauss_legendre(4);
  system_.energise(false);
  Pack mean_slope{};
  for (std::size_t point = 0; point < gauss.nodes.size(); ++point) {
    const double share = gauss.nodes[point];
    Pack pressure, strain, strain_slope, bandage, bandage_slope;
    for (int i = 0; i < pack_width; ++i)
      pressure[i] = share * rest_pressure_[k][i] + (1 - share) * states_[k].pressure[i];
    physics::leg_strain(system_.shape(), system_.pack(k), pressure, strain, strain_slope);
    physics::bandage_pressure(system_.shape(), system_.pack(k), strain, bandage, bandage_slope);
    for (int i = 0; i < pack_width; ++i)
      mean_slope[i] += gauss.weights[point] * (1 - bandage_slope[i] * strain_slope[i]);
  }
  system_.energise(true);
  for (std::size_t slice = first; slice < end; ++slice)
    if (const std::size_t i = slice - first; is_small(outcomes_[slice]))
      outcomes_[slice].actuation_drop =
          actuation[i] / mean_slope[i] * system_.constant(slice, SliceShape::pressure_scale);
}

// Relative error of a task's height averages. From its pressures alone, where these leave no doubt.
double SliceModel::height_error(const SegmentTask& task, const Task& own, bool rigid) {
  const std::size_t count = own.end - own.first;
  if (count >= physics::fewest_for_height_error &&
      task.scene->discretisation.slice_rule == model::SliceRule::gauss) {
    double error = smallest_error;
    pressures_.resize(count);
    for (bool actuated : {false, true}) {
      for (std::size_t k = 0; k < count; ++k) {
        const SliceOutcome& slice = outcomes_[own.first + k];
        pressures_[k] = actuated ? slice.pressure_actuated : slice.pressure_rest;
      }
      error = std::max(error, physics::height_error(*own.rule, pressures_));
      if (own.voltage == 0) break;
    }
    if (error < physics::largest_height_error) return error;
  }
  return height_error_of_start(task, own, rigid);
}

// From the average of the starting values, which are close to the pressures, by the task's rule against the
// one by a finer rule.
double SliceModel::height_error_of_start(const SegmentTask& task, const Task& own, bool rigid) {
  const model::Scene& scene = *task.scene;
  const int count = static_cast<int>(own.rule->nodes.size());
  const physics::Quadrature& fine =
      height_rule(model::SliceRule::gauss, std::min(2 * count + 4, most_check_points));
  std::vector<double> heights = fine.nodes;
  heights.insert(heights.end(), own.rule->nodes.begin(), own.rule->nodes.end());
  std::vector<double> radii(heights.size()), pressures(heights.size());
  SliceShape shape = system_.shape();
  shape.layers = own.voltage != 0 ? scene.bandage.layers : 0;
  physics::SliceSystem system(std::move(shape), heights.size());
  system.set_segment(0, heights, scene.leg, scene.leg.segments[task.segment], scene.bandage,
                     scene.bandage.modules[task.segment], *own.wall_rule, radii);
  double error = smallest_error;
  for (bool on : {false, true}) {
    system.energise(on);
    for (std::size_t k = 0; k < system.packs(); ++k) {
      PackState start;
      Pack pressure;
      physics::start_at_rest(system.shape(), system.pack(k), start, pressure);
      for (std::size_t i = 0; i < pack_width && k * pack_width + i < heights.size(); ++i)
        pressures[k * pack_width + i] = rigid ? std::max(0.0, pressure[i]) : start.pressure[i];
    }
    double finer = 0, coarse = 0;
    for (std::size_t k = 0; k < fine.nodes.size(); ++k) finer += fine.weights[k] * pressures[k];
    for (int k = 0; k < count; ++k) coarse += own.rule->weights[k] * pressures[fine.nodes.size() + k];
    if (finer > 0) error = std::max(error, caution * std::fabs(coarse / finer - 1));
    if (own.voltage == 0) break;
  }
  return error;
}

}  // namespace gaiter::solvers
