// SPDX-License-Identifier: BSD-2-Clause
#include "gaiter/solvers/auto_model.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numeric>
#include <tuple>

#include "gaiter/physics/height_error.hpp"
#include "gaiter/physics/segment_forecast.hpp"
#include "gaiter/solvers/auto_climb.hpp"
#include "gaiter/solvers/axisym_model.hpp"
#include "gaiter/solvers/quick_segments.hpp"
#include "gaiter/solvers/sliding_model.hpp"

namespace gaiter::solvers {

namespace {

using model::Fidelity;
using physics::SegmentForecast;

constexpr int most_slices = 256;
constexpr std::size_t slices_in_batch = 2048;
constexpr int most_smooth_slices = 12;  // beyond, slices are checked once solved
// In each piece of the height, where the bandage leaves the leg.
constexpr double error_of_two_slices = 0.035;
constexpr int most_sliding_slices = 192;
constexpr int most_refinements = 3;
// Of the tolerance, what the model's error may take: the rigid leg's, and that of the first order, from
// mid-height alone, where the tolerance is small, and from two heights.
constexpr double share_of_rigid = 0.9, share_of_first_order = 0.7, strict_tolerance = 5e-5,
                 strict_share = 0.05, share_if_known = 0.98;
// An error of the first order at mid-height, over the tolerance, up to which it is worth another look.
constexpr double may_suffice = 1.6;
// Below, the error that the fewest slices tell of themselves is mostly too large, and one more is cheaper.
constexpr double tolerance_of_fewest_slices = 3e-6;
// Of the tolerance, what Newton's method may leave, and never more of a pressure than the second.
constexpr double share_of_newton = 0.05, newton_leaves_at_most = 0.01;
constexpr double least_in_single = 1e-4;  // accuracy for which quick forecasts in single precision do
constexpr double share_of_slices = 0.3;   // of the goal, for slices that finer models' errors are added to

// Measured as those of plan_cost [s]; of quick forecasts in single and in double precision.
template <typename Number>
constexpr double cost_of_quick_forecast = sizeof(Number) == sizeof(float) ? 0.094e-6 : 0.154e-6;
template <typename Number>
constexpr double cost_of_second_look = sizeof(Number) == sizeof(float) ? 0.18e-6 : 0.3e-6;
constexpr double cost_of_forecast = 0.9e-6;

// Errors of the wanted outputs over those of the pressure.
template <typename Forecast>
double worst_factor(const model::Wanted& goal, const Forecast& forecast) {
  double factor = 1;
  if (goal.actuation_drop) factor = std::max(factor, forecast.drop_factor());
  if (goal.volume_change) factor = std::max(factor, forecast.volume_factor());
  return factor;
}

// At least `slices`. What is solved together fills packs of 64 segments with equally many, so the rare plans
// with many choose among few numbers.
int common_count(int slices) {
  int count = physics::fewest_for_height_error + 1;
  while (count < slices) count += (count + 1) / 2;
  return std::min(count, most_slices);
}

double volume_error(const SegmentTask& task, const physics::LoadedLeg& loaded, int slices) {
  const model::Segment& segment = task.scene->leg.segments[task.segment];
  return physics::volume_height_error(task.scene->leg, segment, loaded, segment.taper(), slices);
}

// In each piece of the height, unless the bandage stiffens too fast over it.
bool two_slices_do(const SegmentTask& task, double tolerance) {
  double steepest = 0;
  for (const model::OgdenTerm& term : task.scene->bandage.ogden)
    steepest = std::max(steepest, std::fabs(term.alpha));
  const double rate = 2 * steepest * std::fabs(task.scene->leg.segments[task.segment].taper());
  return error_of_two_slices < tolerance &&
         physics::gauss_error_of_exponential(2, rate) < error_of_two_slices;
}

// False: the forecast does not reach far enough.
template <typename Forecast>
bool choose_points(const SegmentTask& task, const Forecast& forecast, SlicePlan& plan) {
  const double tolerance = plan.tolerance;
  plan.newton_leaves = std::min(share_of_newton * tolerance, newton_leaves_at_most);
  const bool cut = !plan.cuts.empty();
  const double for_wall = (cut ? 0.1 : 0.25) * tolerance;
  plan.wall_points = 1;
  while ((plan.wall_error = forecast.wall_error(plan.wall_points)) > for_wall &&
         plan.wall_points < Forecast::most_wall_points)
    ++plan.wall_points;
  // Of a small error more terms count than the forecast has.
  const double share = tolerance > 5e-5 ? 0.9 : tolerance > 5e-6 ? 0.7 : 0.5;
  const double left = share * tolerance - plan.wall_error;
  const auto height_error = [&](int slices) {
    const double of_pressure = forecast.height_error(slices);
    if (!task.scene->goal.of(task.segment).volume_change) return of_pressure;
    return std::max(of_pressure, volume_error(task, forecast.loaded(), slices) / plan.factor);
  };
  plan.roughness = 0;
  plan.slice_count = 1;
  while ((plan.height_error = height_error(plan.slice_count)) > left &&
         plan.slice_count < Forecast::most_slices)
    plan.slice_count += 1 + plan.slice_count / most_smooth_slices;
  if (plan.slice_count == physics::fewest_for_height_error && tolerance < tolerance_of_fewest_slices)
    ++plan.slice_count;
  if (cut && two_slices_do(task, left)) {
    plan.slice_count = 2;
    plan.height_error = error_of_two_slices;
  } else if (cut || plan.slice_count > most_smooth_slices) {
    // Past a cut the pressure rises from 0 like no exponential, and near one it changes fast. The forecast of
    // the leg's singularities is too cautious there, so that slices are checked once solved.
    int fewest = physics::fewest_for_height_error + 1;
    for (double reached = 1e-2; reached > 1.5 * tolerance; reached *= 0.1) fewest += 2;
    plan.roughness = 1;
    plan.height_error = 0;
    plan.slice_count = common_count(std::clamp(plan.slice_count / 2, fewest, fewest * fewest / 3));
    return !(plan.wall_error > for_wall);
  }
  return !(plan.wall_error > for_wall) && !(plan.height_error > left);
}

// Rigid leg, first order or slices, to an accuracy of the wanted outputs. `contact`: somewhere the bandage
// presses on the leg, and does so from end to end; `known`: the models' errors are, from two heights. False
// as choose_points.
template <typename Forecast>
bool choose_model(const SegmentTask& task, double accuracy, const Forecast& forecast, bool contact,
                  bool known, SlicePlan& plan) {
  const model::Scene& scene = *task.scene;
  const model::Wanted& goal = scene.goal.of(task.segment);
  plan.factor = worst_factor(goal, forecast);
  const double tolerance = plan.asked = accuracy / plan.factor;
  plan.actuated = goal.actuated();
  plan.fidelity = Fidelity::slice;
  plan.model_error = 0;
  if (scene.leg.model == model::LegModel::rigid) {
    plan.fidelity = Fidelity::rigid;
  } else if (contact) {
    const double rigid = forecast.compliance_error(), first = forecast.first_order_error();
    const double cautious = tolerance < strict_tolerance ? strict_share : share_of_first_order;
    if (!goal.volume_change && rigid < (known ? share_if_known : share_of_rigid) * tolerance) {
      plan.fidelity = Fidelity::rigid;
      plan.model_error = rigid;
    } else if (first < (known ? share_if_known : cautious) * tolerance) {
      plan.fidelity = Fidelity::first_order;
      plan.model_error = first;
    }
  }
  plan.tolerance = tolerance - plan.model_error;
  return choose_points(task, forecast, plan);
}

SlicePlan plan_for(const model::Scene& scene, std::size_t segment, SegmentForecast& forecast,
                   double accuracy) {
  const model::Wanted& goal = scene.goal.of(segment);
  forecast.want(goal.at_rest(), goal.actuated());
  SlicePlan plan;
  plan.cuts = forecast.cuts();
  const bool contact = plan.cuts.empty() && !forecast.open_everywhere();
  choose_model({&scene, segment}, accuracy, forecast, contact, false, plan);
  plan.cost = cost_of_forecast + plan_cost(scene, segment, plan);
  return plan;
}

// Of the accuracy that is asked for, what slices may take.
double accuracy_of_slices(const model::Goal& goal) {
  return goal.up_to == Fidelity::slice ? goal.accuracy : share_of_slices * goal.accuracy;
}

}  // namespace

SlicePlan plan_segment(const model::Scene& scene, std::size_t segment) {
  const SegmentTask asked{&scene, segment};
  std::vector<SlicePlan> plans;
  plan_segments({&asked, 1}, plans);
  const SlicePlan& plan = plans[0];
  if (scene.goal.up_to == Fidelity::slice) return plan;
  const SegmentTask task{&scene, segment, &plan};
  const model::SegmentResult result = solve_segments(PETSC_COMM_SELF, {&task, 1})[0];
  const SlicePlan higher = climb(scene, segment, plan, result);
  if (higher.asked == plan.asked) return higher;
  SegmentForecast forecast(scene, segment);
  forecast.analyse();
  return plan_for(scene, segment, forecast, higher.asked * plan.factor);
}

namespace {

// The plans of `chosen` tasks that quick forecasts can make. Where first order may suffice but the forecast
// at mid-height is too cautious to tell, it looks again. The other tasks are added to `doubtful`.
template <typename Number>
void plan_quickly(std::span<const SegmentTask> tasks, std::span<const std::size_t> chosen,
                  std::vector<SlicePlan>& plans, std::vector<std::size_t>& doubtful) {
  thread_local std::vector<std::size_t> contested, unsure;
  contested.clear();
  const auto choose = [&](std::size_t t, const QuickSegment<Number>& forecast, bool known, SlicePlan& plan) {
    const model::Scene& scene = *tasks[t].scene;
    const double accuracy = accuracy_of_slices(scene.goal);
    if (!choose_model(tasks[t], accuracy, forecast, true, known, plan)) return false;
    plan.cost += plan_cost(scene, tasks[t].segment, plan);
    return true;
  };
  const auto wanted = [&](std::size_t t) { return tasks[t].scene->goal.of(tasks[t].segment); };
  forecast_quickly<Number>(
      tasks, chosen, Look::once, wanted,
      [&](std::size_t t, const QuickSegment<Number>& forecast) {
        SlicePlan& plan = plans[t];
        plan.cuts.clear();
        plan.cost = cost_of_quick_forecast<Number>;
        if (!choose(t, forecast, false, plan)) return false;
        if (plan.fidelity == Fidelity::slice && forecast.first_order_at_middle() < may_suffice * plan.asked)
          contested.push_back(t);
        return true;
      },
      doubtful);
  if (contested.empty()) return;
  for (const std::size_t t : contested) plans[t].cost += cost_of_second_look<Number>;
  // Slices remain where one of the heights is not sure.
  forecast_quickly<Number>(
      tasks, contested, Look::twice, wanted,
      [&](std::size_t t, const QuickSegment<Number>& forecast) {
        SlicePlan again = plans[t];
        again.cost = cost_of_quick_forecast<Number> + cost_of_second_look<Number>;
        if (!choose(t, forecast, true, again)) return false;
        plans[t] = again;
        return true;
      },
      unsure);
}

double spent_on_quick_forecast(const model::Goal& goal) {
  if (goal.up_to != Fidelity::slice) return 0;
  return goal.accuracy < least_in_single ? cost_of_quick_forecast<double> : cost_of_quick_forecast<float>;
}

}  // namespace

void plan_segments(std::span<const SegmentTask> tasks, std::vector<SlicePlan>& plans) {
  thread_local std::vector<std::size_t> roughly, finely, doubtful;
  thread_local std::vector<SegmentForecast> forecasts;
  plans.resize(tasks.size());
  for (auto* chosen : {&roughly, &finely, &doubtful}) chosen->clear();
  for (std::size_t t = 0; t < tasks.size(); ++t) {
    const model::Goal& goal = tasks[t].scene->goal;
    const bool slices = goal.up_to == Fidelity::slice;
    (!slices ? doubtful : goal.accuracy < least_in_single ? finely : roughly).push_back(t);
  }
  plan_quickly<float>(tasks, roughly, plans, doubtful);
  plan_quickly<double>(tasks, finely, plans, doubtful);
  forecasts.clear();
  for (const std::size_t t : doubtful) forecasts.emplace_back(*tasks[t].scene, tasks[t].segment);
  SegmentForecast::analyse(forecasts);
  for (std::size_t k = 0; k < doubtful.size(); ++k) {
    const SegmentTask& task = tasks[doubtful[k]];
    const double accuracy = accuracy_of_slices(task.scene->goal);
    plans[doubtful[k]] = plan_for(*task.scene, task.segment, forecasts[k], accuracy);
    plans[doubtful[k]].cost += spent_on_quick_forecast(task.scene->goal);
  }
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
    const double before = plan.cost;
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
  const int now = plan.slice_count, more = plan.roughness > 0 ? common_count(now + 1) : now + (now + 3) / 3;
  plan.slice_count = axisym ? now + 1 : std::min(most, sliding ? 2 * now : more);
  return true;
}

// Those with equally many slices together, as many at a time as the caches hold.
void AutoModel::solve_slices(std::span<const SegmentTask> tasks, std::vector<std::size_t>& chosen) {
  std::sort(chosen.begin(), chosen.end(), [&](std::size_t a, std::size_t b) {
    const SlicePlan &one = plans_[a], &other = plans_[b];
    return std::tuple(one.cuts.size(), one.slice_count, one.wall_points, a) <
           std::tuple(other.cuts.size(), other.slice_count, other.wall_points, b);
  });
  for (std::size_t first = 0, end = 0; first < chosen.size(); first = end) {
    own_.clear();
    for (std::size_t held = 0; end < chosen.size() && held < slices_in_batch; ++end) {
      const std::size_t t = chosen[end];
      held += plans_[t].slice_count * (1 + plans_[t].cuts.size());
      own_.push_back({tasks[t].scene, tasks[t].segment, &plans_[t]});
    }
    const auto found = slices_.solve(own_);
    for (std::size_t k = first; k < end; ++k) results_[chosen[k]] = found[k - first];
  }
}

// By finite elements or sliding slices.
void AutoModel::solve_finer(std::span<const SegmentTask> tasks, const std::vector<std::size_t>& chosen) {
  std::vector<SegmentTask> own;
  for (const std::size_t t : chosen) own.push_back({tasks[t].scene, tasks[t].segment, &plans_[t]});
  std::vector<model::SegmentResult> others;
  if (plans_[chosen[0]].fidelity == Fidelity::axisym) {
    for (const SegmentTask& task : own) {
      model::Scene scene = *task.scene;
      scene.axisym.refine = task.plan->slice_count;
      scene.axisym.scope = model::AxisymScope::segment;
      if (!task.plan->actuated)
        for (model::Module& module : scene.bandage.modules) module.voltage = 0;
      const SegmentTask alone{&scene, task.segment};
      others.push_back(solve_axisym(group_, {&alone, 1})[0]);
    }
  } else {
    others = solve_sliding(MPI_COMM_SELF, own);
  }
  for (std::size_t k = 0; k < chosen.size(); ++k) results_[chosen[k]] = others[k];
}

std::span<const model::SegmentResult> AutoModel::solve(std::span<const SegmentTask> tasks) {
  plan_segments(tasks, plans_);
  results_.assign(tasks.size(), {});
  std::vector<std::size_t> open(tasks.size());
  std::iota(open.begin(), open.end(), std::size_t{0});
  while (!open.empty()) {
    // What is solved together has the same model; sliding slices also the same number.
    std::map<std::pair<Fidelity, int>, std::vector<std::size_t>> groups;
    for (const std::size_t t : open)
      groups[{plans_[t].fidelity, plans_[t].fidelity == Fidelity::sliding ? plans_[t].slice_count : 0}]
          .push_back(t);
    for (auto& [key, chosen] : groups) {
      const bool coupled = key.first == Fidelity::axisym || key.first == Fidelity::sliding;
      coupled ? solve_finer(tasks, chosen) : solve_slices(tasks, chosen);
    }
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
    const auto foreseen = [&](double error) {
      return std::isfinite(error) ? model::rounded_up(error) : none;
    };
    result.planned_discretisation_error = foreseen(plan.expected_discretisation_error());
    result.planned_model_error = foreseen(plan.expected_model_error());
    result.planned_cost = model::rounded_up(plan.cost - plan.unforeseen);
    if (plan.factor > 1 && model::trustworthy(result.status)) {
      result.discretisation_error *= plan.factor;
      result.model_error *= plan.factor;
      model::derive_error(result, plan.expected_model_error());
    }
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
