// SPDX-License-Identifier: BSD-2-Clause
#include "gaiter/solvers/auto_model.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

#include "gaiter/physics/height_error.hpp"
#include "gaiter/physics/segment_forecast.hpp"
#include "gaiter/solvers/axisym_model.hpp"
#include "gaiter/solvers/sliding_model.hpp"

namespace gaiter::solvers {

namespace {

using model::Fidelity;
using physics::SegmentForecast;

constexpr int most_planned_slices = 8, most_slices = 256;
constexpr int most_planned_wall_points = 24;
constexpr double largest_trusted_gain = 0.3;
constexpr double strict_tolerance = 5e-5;  // below which few slices are not trusted to tell their own error
constexpr int fewest_strict = 6;
constexpr int most_sliding_slices = 192;
constexpr int most_refinements = 3;
constexpr double shares_model = 0.7;  // of the tolerance that the model's error may take

// Measured on one core of a 2.1 GHz x86-64 server, batches of some hundred segments [s].
constexpr double cost_of_segment = 1.2e-6;
constexpr double cost_of_pressure = 12e-9;  // of a slice, per Ogden term and wall point
constexpr double cost_of_slice = 60e-9;
constexpr double cost_of_sliding_slice = 8e-6;
constexpr double cost_of_finite_elements = 0.04;  // at refinement 0; four times more with each

}  // namespace

double plan_cost(const model::Scene& scene, std::size_t segment, const SlicePlan& plan) {
  const int states = plan.actuated && scene.bandage.modules[segment].voltage != 0 ? 2 : 1;
  const double evaluations = plan.fidelity == Fidelity::rigid         ? 1
                             : plan.fidelity == Fidelity::first_order ? 1.5
                                                                      : 4;
  const double slices = static_cast<double>(plan.slice_count) * (1 + static_cast<double>(plan.cuts.size()));
  if (plan.fidelity == Fidelity::axisym)
    return states * cost_of_finite_elements * std::pow(4, plan.slice_count);
  if (plan.fidelity == Fidelity::sliding) return states * cost_of_sliding_slice * slices;
  const double points = plan.wall_points * static_cast<double>(scene.bandage.ogden.size());
  return cost_of_segment + states * slices * (cost_of_slice + evaluations * points * cost_of_pressure);
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
         forecast.wall_error(plan.wall_points) > (cut ? 0.03 : 0.3) * tolerance)
    ++plan.wall_points;
  plan.wall_error = forecast.wall_error(plan.wall_points);
  // Past a cut the pressure rises from 0 like no exponential, and where the leg's law rules like no power of
  // the radius: slices there are checked once solved.
  const double gain = forecast.gain();
  const bool strict = tolerance < strict_tolerance;
  const int few = strict                               ? fewest_strict
                  : cut || gain > largest_trusted_gain ? physics::fewest_for_height_error
                                                       : 1;
  const int fewest = cut ? few + 2 : few;
  plan.roughness = cut ? 1 : gain / (1 + gain);
  // Behind a leg that gives way much, or for small errors, small terms count that the forecast leaves out.
  if ((strict || gain > largest_trusted_gain) && tolerance < 1e-2) {
    ++plan.wall_points;
    plan.wall_error = forecast.wall_error(plan.wall_points);
  }
  plan.slice_count = fewest;
  while (plan.slice_count < most_planned_slices && forecast.height_error(plan.slice_count) > 0.6 * tolerance)
    ++plan.slice_count;
  // Beyond two, the forecast is not trusted alone.
  if (plan.slice_count == physics::fewest_for_height_error - 1) ++plan.slice_count;
  plan.height_error = forecast.height_error(plan.slice_count);
}

double tolerance_of(const model::Scene& scene, const SegmentForecast& forecast) {
  return scene.goal.accuracy / worst_factor(scene.goal, forecast);
}

}  // namespace

SlicePlan plan_segment(const model::Scene& scene, std::size_t segment) {
  const model::Goal& goal = scene.goal;
  SegmentForecast forecast(scene, segment);
  forecast.want(goal.pressure_rest || goal.actuation_drop, goal.actuated());
  forecast.analyse();
  const double tolerance = tolerance_of(scene, forecast);

  SlicePlan plan;
  plan.actuated = goal.actuated();
  plan.cuts = forecast.cuts();
  const bool cylinder = scene.leg.segments[segment].lower_radius == scene.leg.segments[segment].upper_radius;
  const double sliding = forecast.sliding_error();
  // Beyond slices, what sliding changes must be small; beyond sliding slices, the ends of the segment and the
  // shear of the leg, of which only a cylinder is known to have none.
  const bool slices_do = goal.up_to == Fidelity::slice || cylinder ||
                         (goal.up_to == Fidelity::sliding && sliding < shares_model * tolerance);
  const double beyond = goal.up_to == Fidelity::slice || cylinder ? 0 : sliding;
  if (slices_do) {
    const bool rigid_leg = scene.leg.model == model::LegModel::rigid;
    const bool sure = plan.cuts.empty() && !forecast.open_everywhere();
    plan.fidelity = Fidelity::slice;
    plan.model_error = beyond;
    const double rigid = beyond + forecast.compliance_error(), first = beyond + forecast.first_order_error();
    if (rigid_leg || (sure && !goal.volume_change && rigid < shares_model * tolerance)) {
      plan.fidelity = Fidelity::rigid;
      plan.model_error = rigid_leg ? beyond : rigid;
    } else if (sure && first < shares_model * tolerance && tolerance >= strict_tolerance) {
      plan.fidelity = Fidelity::first_order;
      plan.model_error = first;
    }
    choose_points(forecast, tolerance - plan.model_error, plan);
  } else if (goal.up_to == Fidelity::sliding) {
    plan.fidelity = Fidelity::sliding;
    plan.cuts.clear();
    choose_points(forecast, tolerance, plan);
    plan.slice_count = tolerance < 1e-2 ? 24 : 9;
  } else {
    plan.fidelity = Fidelity::axisym;
    plan.cuts.clear();
    plan.wall_points = 0;
    plan.slice_count = tolerance < 1e-3 ? 2 : 1;  // refinements
    plan.height_error = std::numeric_limits<double>::quiet_NaN();
  }
  if (plan.fidelity == Fidelity::sliding) plan.height_error = std::numeric_limits<double>::quiet_NaN();
  plan.cost = plan_cost(scene, segment, plan);
  return plan;
}

// Whether the result is not good enough and the plan could be made finer, and was.
bool AutoModel::refine(const SegmentTask& task, SlicePlan& plan, const model::SegmentResult& result) const {
  if (!model::trustworthy(result.status)) return false;
  SegmentForecast forecast(*task.scene, task.segment);
  forecast.analyse();
  const double allowed = tolerance_of(*task.scene, forecast) - plan.model_error;
  if (!(result.discretisation_error > allowed)) return false;
  const bool axisym = plan.fidelity == Fidelity::axisym, sliding = plan.fidelity == Fidelity::sliding;
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
  plans_.clear();
  results_.assign(tasks.size(), {});
  std::vector<std::size_t> open;
  for (std::size_t t = 0; t < tasks.size(); ++t) {
    plans_.push_back(plan_segment(*tasks[t].scene, tasks[t].segment));
    open.push_back(t);
  }
  while (!open.empty()) {
    // What is solved together has the same model; sliding slices also the same number.
    std::map<std::pair<Fidelity, int>, std::vector<std::size_t>> groups;
    for (const std::size_t t : open)
      groups[{plans_[t].fidelity, plans_[t].fidelity == Fidelity::sliding ? plans_[t].slice_count : 0}]
          .push_back(t);
    for (const auto& [key, chosen] : groups) solve_group(tasks, chosen);
    std::erase_if(open, [&](std::size_t t) {
      if (!refine(tasks[t], plans_[t], results_[t])) return true;
      plans_[t].cost += plan_cost(*tasks[t].scene, tasks[t].segment, plans_[t]);
      return false;
    });
  }
  constexpr double none = std::numeric_limits<double>::quiet_NaN();
  for (std::size_t t = 0; t < tasks.size(); ++t) {
    model::SegmentResult& result = results_[t];
    if (plans_[t].actuated) continue;
    for (double* value : {&result.pressure_actuated, &result.pressure_actuated_rigid,
                          &result.pressure_actuated_area_mean, &result.pressure_actuated_change,
                          &result.actuation_drop, &result.actuation_pressure, &result.volume_actuated,
                          &result.volume_change, &result.radius_actuated, &result.electric_field_max})
      *value = none;
  }
  return results_;
}

}  // namespace gaiter::solvers
