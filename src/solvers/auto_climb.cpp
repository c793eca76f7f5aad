// SPDX-License-Identifier: BSD-2-Clause
#include "gaiter/solvers/auto_climb.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "gaiter/physics/model_error.hpp"
#include "gaiter/physics/segment_forecast.hpp"
#include "gaiter/solvers/auto_model.hpp"

namespace gaiter::solvers {

namespace {

using model::Fidelity;
using physics::SegmentForecast;

constexpr double shares_model = 0.7;      // of the tolerance that the model's error may take
constexpr double caution_of_sliding = 2;  // where sliding slices are the truth

// Of the wanted outputs, against the finest model that the goal allows.
double of_wanted(const model::Goal& goal, const physics::ModelError& error) {
  double worst = 0;
  if (goal.pressure_rest) worst = std::max(worst, error.pressure_rest);
  if (goal.pressure_actuated) worst = std::max(worst, error.pressure_actuated);
  if (goal.actuation_drop) worst = std::max(worst, error.actuation_drop);
  if (goal.volume_change) worst = std::max(worst, error.volume_change);
  return worst;
}

// Outside of what physics::model_errors was fitted to, its shifts still tell the size of the pressures'
// errors: where the finite elements had an answer, they were below 2.5 times the sum of all
// (benchmarks/auto_axisym_study).
double of_shifts(const model::Goal& goal, const physics::ModelShifts& shifts,
                 const model::SegmentResult& result) {
  constexpr double caution = 3, floor = 5e-4, largest = 0.3,
                   unknown = std::numeric_limits<double>::infinity();
  const bool in_contact =
      result.status == model::Status::contact || result.status == model::Status::extrapolated;
  if (!in_contact || goal.actuation_drop || goal.volume_change) return unknown;
  const auto size = [](const physics::ModelShift& shift) {
    return std::fabs(shift.sliding) + std::fabs(shift.slope) + std::fabs(shift.ends);
  };
  const double sum = std::max(size(shifts.pressure_rest), size(shifts.pressure_actuated));
  return sum < largest ? caution * sum + floor : unknown;
}

}  // namespace

SlicePlan climb(const model::Scene& scene, std::size_t segment, const SlicePlan& slices,
                const model::SegmentResult& result) {
  const model::Goal& goal = scene.goal;
  const physics::ModelErrors errors = physics::model_errors(scene, segment, result);
  const bool sliding_only = goal.up_to == Fidelity::sliding;
  const bool wrinkles = std::isnan(slices.change_beyond);
  double of_slices = of_wanted(goal, errors.slice), of_sliding = of_wanted(goal, errors.sliding);
  if (!std::isfinite(of_slices) && !wrinkles)
    of_slices = of_sliding = of_shifts(goal, physics::model_shifts(scene, segment, result), result);
  if (sliding_only) of_sliding = 0;
  if (sliding_only) {
    SegmentForecast forecast(scene, segment);
    SegmentForecast::analyse({&forecast, 1}, SegmentForecast::Depth::sliding);
    forecast.want(goal.pressure_rest || goal.actuation_drop, goal.actuated());
    of_slices = caution_of_sliding * slices.factor * forecast.sliding_error();
  }
  SlicePlan plan = slices;
  const double own = slices.factor * (result.discretisation_error + slices.model_error);
  if (own + of_slices <= goal.accuracy) {
    plan.model_error += of_slices / slices.factor;
    plan.change_beyond = plan.model_error;
    return plan;
  }
  plan.cuts.clear();
  plan.height_error = std::numeric_limits<double>::quiet_NaN();
  if (of_sliding <= shares_model * goal.accuracy) {
    plan.fidelity = Fidelity::sliding;
    plan.model_error = of_sliding / slices.factor;
    plan.change_beyond = sliding_only ? std::numeric_limits<double>::quiet_NaN() : plan.model_error;
    plan.tolerance = (goal.accuracy - of_sliding) / slices.factor;
    plan.slice_count = plan.tolerance < 1e-2 ? 24 : 9;
  } else {
    plan.fidelity = Fidelity::axisym;
    plan.model_error = plan.change_beyond = 0;
    plan.tolerance = goal.accuracy / slices.factor;
    plan.wall_points = 0;
    plan.slice_count = 0;  // refinements
  }
  plan.cost += plan_cost(scene, segment, plan);
  return plan;
}

}  // namespace gaiter::solvers
