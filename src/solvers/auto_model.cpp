// SPDX-License-Identifier: BSD-2-Clause
#include "gaiter/solvers/auto_model.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numeric>

#include "gaiter/physics/height_error.hpp"
#include "gaiter/physics/segment_forecast.hpp"
#include "gaiter/solvers/auto_climb.hpp"
#include "gaiter/solvers/axisym_model.hpp"
#include "gaiter/solvers/sliding_model.hpp"

namespace gaiter::solvers {

namespace {

using model::Fidelity;
using physics::SegmentForecast;

constexpr int most_planned_slices = 64, most_slices = 256;
constexpr int most_planned_wall_points = 24;
constexpr double strict_tolerance = 5e-5;  // below which few slices are not trusted to tell their own error
constexpr int most_sliding_slices = 192;
constexpr int most_refinements = 3;
constexpr double shares_model = 0.7;     // of the tolerance that the model's error may take
constexpr double share_of_slices = 0.3;  // of the goal, for slices that finer models' errors are added to

// Measured on one core of a 2.1 GHz x86-64 server, batches of some hundred segments [s]; of a slice in one
// state, and of its pressure at one wall point, per Ogden term.
constexpr double cost_of_segment = 0.15e-6;
constexpr double cost_of_rigid_slice = 60e-9, cost_of_slice = 260e-9, cost_of_own_error = 60e-9;
constexpr double cost_of_pressure = 13e-9;
constexpr double cost_of_sliding_slice = 8e-6;
constexpr double cost_of_finite_elements = 0.04;  // at refinement 0; four times more with each

}  // namespace

double plan_cost(const model::Scene& scene, std::size_t segment, const SlicePlan& plan) {
  const int states = plan.actuated && scene.bandage.modules[segment].voltage != 0 ? 2 : 1;
  const double slices = static_cast<double>(plan.slice_count) * (1 + static_cast<double>(plan.cuts.size()));
  if (plan.fidelity == Fidelity::axisym)
    return states * cost_of_finite_elements * std::pow(4, plan.slice_count);
  if (plan.fidelity == Fidelity::sliding) return states * cost_of_sliding_slice * slices;
  const double points = plan.wall_points * static_cast<double>(scene.bandage.ogden.size());
  const double slice = (plan.fidelity == Fidelity::slice ? cost_of_slice : cost_of_rigid_slice) +
                       (plan.slice_count >= physics::fewest_for_height_error ? cost_of_own_error : 0);
  return cost_of_segment + states * slices * (slice + points * cost_of_pressure);
}

namespace {

// Errors of the wanted outputs over those of the pressure.
double worst_factor(const model::Goal& goal, const SegmentForecast& forecast) {
  double factor = 1;
  if (goal.actuation_drop) factor = std::max(factor, forecast.drop_factor());
  if (goal.volume_change) factor = std::max(factor, forecast.volume_factor());
  return factor;
}

void choose_points(const SegmentForecast& forecast, double tolerance, SlicePlan& plan) {
  const bool cut = !forecast.cuts().empty();
  plan.wall_points = 1;
  while (plan.wall_points < most_planned_wall_points &&
         forecast.wall_error(plan.wall_points) > (cut ? 0.1 : 0.25) * tolerance)
    ++plan.wall_points;
  plan.wall_error = forecast.wall_error(plan.wall_points);
  // Past a cut the pressure rises from 0 like no exponential: slices there are checked once solved.
  plan.roughness = cut ? 1 : 0;
  plan.slice_count = cut ? physics::fewest_for_height_error + (tolerance < strict_tolerance ? 4 : 1) : 1;
  // Of a small error more terms count than the forecast has.
  const double share = tolerance > 5e-5 ? 0.9 : tolerance > 5e-6 ? 0.6 : 0.3;
  const double left = share * tolerance - plan.wall_error;
  while (plan.slice_count < most_planned_slices && forecast.height_error(plan.slice_count) > left)
    ++plan.slice_count;
  plan.height_error = forecast.height_error(plan.slice_count);
}

// Rigid leg, first order or slices, to a tolerance of the pressures.
SlicePlan plan_slices(const model::Scene& scene, std::size_t segment, const SegmentForecast& forecast,
                      double tolerance) {
  const model::Goal goal = scene.goal.of(segment);
  SlicePlan plan;
  plan.actuated = goal.actuated();
  plan.cuts = forecast.cuts();
  plan.change_beyond = forecast.sliding_error();
  const bool sure = plan.cuts.empty() && !forecast.open_everywhere();
  const double rigid = forecast.compliance_error(), first = forecast.first_order_error();
  if (scene.leg.model == model::LegModel::rigid) {
    plan.fidelity = Fidelity::rigid;
  } else if (sure && !goal.volume_change && rigid < shares_model * tolerance) {
    plan.fidelity = Fidelity::rigid;
    plan.model_error = rigid;
  } else if (sure && first < shares_model * tolerance && tolerance >= strict_tolerance) {
    plan.fidelity = Fidelity::first_order;
    plan.model_error = first;
  }
  plan.change_beyond += plan.model_error;
  plan.tolerance = tolerance - plan.model_error;
  choose_points(forecast, plan.tolerance, plan);
  plan.cost = plan_cost(scene, segment, plan);
  return plan;
}

SlicePlan plan_for(const model::Scene& scene, std::size_t segment, SegmentForecast& forecast,
                   double accuracy) {
  const model::Goal goal = scene.goal.of(segment);
  forecast.want(goal.pressure_rest || goal.actuation_drop, goal.actuated());
  const double factor = worst_factor(goal, forecast);
  SlicePlan plan = plan_slices(scene, segment, forecast, accuracy / factor);
  plan.asked = accuracy / factor;
  plan.factor = factor;
  return plan;
}

// Of the accuracy that is asked for, what slices may take.
double accuracy_of_slices(const model::Goal& goal) {
  return goal.up_to == Fidelity::slice ? goal.accuracy : share_of_slices * goal.accuracy;
}

}  // namespace

SlicePlan plan_segment(const model::Scene& scene, std::size_t segment) {
  SegmentForecast forecast(scene, segment);
  forecast.analyse();
  SlicePlan plan = plan_for(scene, segment, forecast, accuracy_of_slices(scene.goal));
  if (scene.goal.up_to == Fidelity::slice) return plan;
  const SegmentTask task{&scene, segment, &plan};
  const model::SegmentResult result = solve_segments(PETSC_COMM_SELF, {&task, 1})[0];
  const SlicePlan higher = climb(scene, segment, plan, result);
  if (higher.asked == plan.asked) return higher;
  return plan_for(scene, segment, forecast, higher.asked * plan.factor);
}

void plan_segments(std::span<const SegmentTask> tasks, std::vector<SlicePlan>& plans) {
  thread_local std::vector<SegmentForecast> forecasts;
  forecasts.clear();
  for (const SegmentTask& task : tasks) forecasts.emplace_back(*task.scene, task.segment);
  SegmentForecast::analyse(forecasts);
  plans.clear();
  for (std::size_t t = 0; t < tasks.size(); ++t)
    plans.push_back(
        plan_for(*tasks[t].scene, tasks[t].segment, forecasts[t], accuracy_of_slices(tasks[t].scene->goal)));
}

// Slices, or something simpler, to what their plans ask for now.
void AutoModel::plan_again(std::span<const SegmentTask> tasks, const std::vector<std::size_t>& chosen) {
  thread_local std::vector<SegmentForecast> forecasts;
  forecasts.clear();
  for (const std::size_t t : chosen) forecasts.emplace_back(*tasks[t].scene, tasks[t].segment);
  SegmentForecast::analyse(forecasts);
  for (std::size_t k = 0; k < chosen.size(); ++k) {
    const SegmentTask& task = tasks[chosen[k]];
    SlicePlan& plan = plans_[chosen[k]];
    const double before = plan.cost + planning_cost;
    plan = plan_for(*task.scene, task.segment, forecasts[k], plan.asked * plan.factor);
    plan.cost += before;
  }
}

// Whether the result is not good enough and the plan could be made finer, and was.
bool AutoModel::refine(SlicePlan& plan, const model::SegmentResult& result) const {
  const bool axisym = plan.fidelity == Fidelity::axisym, sliding = plan.fidelity == Fidelity::sliding;
  // A coarse mesh may have no estimate; the next one has.
  const bool good = axisym ? result.discretisation_error <= plan.tolerance
                           : !(result.discretisation_error > plan.tolerance);
  if (!model::trustworthy(result.status) || good) return false;
  const int most = axisym ? most_refinements : sliding ? most_sliding_slices : most_slices;
  if (plan.slice_count >= most) return false;
  plan.slice_count =
      axisym ? plan.slice_count + 1
             : std::min(most, sliding ? 2 * plan.slice_count : plan.slice_count + (plan.slice_count + 3) / 3);
  return true;
}

void AutoModel::solve_group(std::span<const SegmentTask> tasks, const std::vector<std::size_t>& chosen) {
  std::vector<SegmentTask> own;
  for (const std::size_t t : chosen) own.push_back({tasks[t].scene, tasks[t].segment, &plans_[t]});
  std::vector<model::SegmentResult> others;
  std::span<const model::SegmentResult> found;
  const Fidelity fidelity = plans_[chosen[0]].fidelity;
  if (fidelity == Fidelity::axisym) {
    for (const SegmentTask& task : own) {
      model::Scene scene = *task.scene;
      scene.axisym.refine = task.plan->slice_count;
      scene.axisym.scope = model::AxisymScope::segment;
      if (!task.plan->actuated)
        for (model::Module& module : scene.bandage.modules) module.voltage = 0;
      const SegmentTask alone{&scene, task.segment};
      others.push_back(solve_axisym(group_, {&alone, 1})[0]);
    }
    found = others;
  } else if (fidelity == Fidelity::sliding) {
    others = solve_sliding(MPI_COMM_SELF, own);
    found = others;
  } else {
    found = slices_.solve(own);
  }
  for (std::size_t k = 0; k < chosen.size(); ++k) results_[chosen[k]] = found[k];
}

std::span<const model::SegmentResult> AutoModel::solve(std::span<const SegmentTask> tasks) {
  plan_segments(tasks, plans_);
  results_.assign(tasks.size(), {});
  std::vector<std::size_t> open(tasks.size());
  std::iota(open.begin(), open.end(), std::size_t{0});
  while (!open.empty()) {
    // What is solved together has the same model; sliding slices also the same number. A pack of slices works
    // on as many points of the wall as the one with the most has.
    std::map<std::pair<Fidelity, int>, std::vector<std::size_t>> groups;
    for (const std::size_t t : open)
      groups[{plans_[t].fidelity, plans_[t].fidelity == Fidelity::sliding  ? plans_[t].slice_count
                                  : plans_[t].fidelity == Fidelity::axisym ? 0
                                                                           : plans_[t].wall_points}]
          .push_back(t);
    for (const auto& [key, chosen] : groups) solve_group(tasks, chosen);
    std::vector<std::size_t> finer;
    std::erase_if(open, [&](std::size_t t) {
      SlicePlan& plan = plans_[t];
      if (refine(plan, results_[t])) {
        const double once_more = plan_cost(*tasks[t].scene, tasks[t].segment, plan);
        plan.cost += once_more;
        plan.unforeseen += once_more;
        return false;
      }
      const Fidelity solved = plan.fidelity;
      if (tasks[t].scene->goal.up_to == Fidelity::slice || solved == Fidelity::axisym) return true;
      const bool slid = solved == Fidelity::sliding;
      // Where slices have no answer, finer models may have none either, and cost far more.
      if (!slid && (!model::trustworthy(results_[t].status) || !(results_[t].pressure_rest > 0))) return true;
      const double asked = plan.asked;
      plan = slid ? climb_from_sliding(*tasks[t].scene, tasks[t].segment, plan, results_[t])
                  : climb(*tasks[t].scene, tasks[t].segment, plan, results_[t]);
      if (plan.asked != asked) finer.push_back(t);
      if (plan.fidelity != solved || plan.asked != asked) return false;
      results_[t].model_error = plan.change_beyond;
      model::derive_error(results_[t]);
      return true;
    });
    plan_again(tasks, finer);
  }
  constexpr double none = std::numeric_limits<double>::quiet_NaN();
  for (std::size_t t = 0; t < tasks.size(); ++t) {
    model::SegmentResult& result = results_[t];
    const SlicePlan& plan = plans_[t];
    result.planned_discretisation_error = model::rounded_up(plan.height_error + plan.wall_error);
    result.planned_model_error = model::rounded_up(plan.model_error);
    result.planned_cost = model::rounded_up(plan.cost - plan.unforeseen);
    if (plan.actuated) continue;
    for (double* value : {&result.pressure_actuated, &result.pressure_actuated_rigid,
                          &result.pressure_actuated_area_mean, &result.pressure_actuated_change,
                          &result.actuation_drop, &result.actuation_pressure, &result.volume_actuated,
                          &result.volume_change, &result.radius_actuated, &result.electric_field_max})
      *value = none;
  }
  return results_;
}

}  // namespace gaiter::solvers
