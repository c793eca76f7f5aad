// SPDX-License-Identifier: BSD-2-Clause
#include "gaiter/solvers/auto_climb.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "gaiter/physics/model_error.hpp"
#include "gaiter/physics/segment_forecast.hpp"
#include "gaiter/solvers/auto_model.hpp"
#include "gaiter/solvers/residual_estimate.hpp"

namespace gaiter::solvers {

namespace {

using model::Fidelity;
using physics::SegmentForecast;

constexpr double unknown = std::numeric_limits<double>::infinity();
constexpr int fewest_wall_points = 3;
constexpr double shares_model = 0.98;     // of the tolerance that the model's error may take
constexpr double shares_unknown = 0.7;    // likewise, before it is known
constexpr double caution_of_sliding = 2;  // where sliding slices are the truth
constexpr double least_share = 0.03;      // of the tolerance, that is worth finer slices
constexpr double keeps_clear = 0.8;       // of what is left for these
// A closed form beyond so many times the accuracy is not that far above the truth.
constexpr double hopeless = 3;
// Of the wall over the radius: a thicker one has a stiffness in bending, which keeps it from buckling where
// the sliding slices, a membrane's, have no stable state any more.
constexpr double thickest_membrane = 0.05;
// Of the voltage: finite elements may be stable somewhat beyond the last stable one of sliding slices.
constexpr double far_below = 0.45;
// Of the change by Newton's step, which is added to what the residual finds: of 819 such sums, for slices and
// sliding slices of benchmarks/sobol_scenes.hpp, 10 were below the true error, at most by a third of it.
constexpr double share_of_spread = 0.4;
constexpr double cost_of_residual = 0.0075;  // [s], of a state

// Of the wanted outputs, against the finest model that the goal allows.
double of_wanted(const model::Wanted& goal, const physics::ModelError& error) {
  double worst = 0;
  if (goal.pressure_rest) worst = std::max(worst, error.pressure_rest);
  if (goal.pressure_actuated) worst = std::max(worst, error.pressure_actuated);
  if (goal.actuation_drop) worst = std::max(worst, error.actuation_drop);
  if (goal.volume_change) worst = std::max(worst, error.volume_change);
  return worst;
}

// What slices and sliding slices lack, as far as their closed forms know.
std::pair<double, double> closed_forms(const model::Scene& scene, std::size_t segment,
                                       const SlicePlan& slices, const model::SegmentResult& result) {
  const model::Wanted& goal = scene.goal.of(segment);
  if (scene.goal.up_to != Fidelity::sliding) {
    const physics::ModelErrors errors = physics::model_errors(scene, segment, result);
    return {of_wanted(goal, errors.slice), of_wanted(goal, errors.sliding)};
  }
  SegmentForecast forecast(scene, segment);
  SegmentForecast::analyse({&forecast, 1}, SegmentForecast::Depth::sliding);
  forecast.want(goal.at_rest(), goal.actuated());
  return {caution_of_sliding * slices.factor * forecast.sliding_error(), 0};
}

// From the finite elements' residual: largest error of a wanted output, discretisation included, plus how far
// it is to be trusted; and whether there are stable states on the way to it.
struct Residual {
  double error = unknown;
  bool reliable = false;
};

Residual by_residual(const model::Scene& scene, std::size_t segment, SlicePlan& plan,
                     const model::SegmentResult& result, Fidelity fidelity) {
  model::Scene wanted = scene;
  if (!plan.actuated)
    for (model::Module& module : wanted.bandage.modules) module.voltage = 0;
  const bool energised = wanted.bandage.modules[segment].voltage != 0;
  plan.cost += cost_of_residual * (energised ? 2 : 1);
  const ResidualEstimate found = estimate_by_residual({&wanted, segment}, result, fidelity);
  const model::Wanted& goal = scene.goal.of(segment);
  Residual residual{0, found.reliable};
  const auto add = [&](bool asked, double error) {
    if (asked) residual.error = std::max(residual.error, std::isnan(error) ? unknown : std::fabs(error));
  };
  add(goal.pressure_rest || !energised, found.pressure_rest);
  add(goal.pressure_actuated && energised, found.pressure_actuated);
  add(goal.actuation_drop && energised, found.actuation_drop);
  add(goal.volume_change, found.volume_change);
  residual.error = found.reliable ? residual.error + share_of_spread * found.spread : unknown;
  return residual;
}

SlicePlan without_resolution(SlicePlan plan) {
  plan.cuts.clear();
  plan.height_error = std::numeric_limits<double>::quiet_NaN();
  return plan;
}

SlicePlan to_mesh(const model::Scene& scene, std::size_t segment, const SlicePlan& simpler) {
  SlicePlan plan = without_resolution(simpler);
  plan.fidelity = Fidelity::axisym;
  plan.model_error = plan.change_beyond = 0;
  plan.tolerance = scene.goal.accuracy / simpler.factor;
  plan.wall_points = 0;
  plan.slice_count = 0;  // refinements
  plan.cost += plan_cost(scene, segment, plan);
  return plan;
}

// `of_sliding` may be unknown: then that is found out once they are solved.
SlicePlan to_sliding(const model::Scene& scene, std::size_t segment, const SlicePlan& slices,
                     double of_sliding) {
  SlicePlan plan = without_resolution(slices);
  const double accuracy = scene.goal.accuracy;
  const bool last = scene.goal.up_to == Fidelity::sliding;
  plan.confirm = !(of_sliding <= shares_model * accuracy);
  plan.fidelity = Fidelity::sliding;
  // A wall so coarsely resolved that it would do for a rough pressure may lose its stability too early.
  if (plan.confirm) plan.wall_points = std::max(plan.wall_points, fewest_wall_points);
  const double error = plan.confirm ? shares_unknown * accuracy : of_sliding;
  plan.model_error = plan.confirm ? std::numeric_limits<double>::quiet_NaN() : error / slices.factor;
  plan.change_beyond = last || plan.confirm ? std::numeric_limits<double>::quiet_NaN() : plan.model_error;
  plan.tolerance = (accuracy - error) / slices.factor;
  plan.slice_count = plan.confirm || plan.tolerance < 1e-2 ? 24 : 9;
  plan.cost += plan_cost(scene, segment, plan);
  return plan;
}

// Keeps a plan whose result has so much of an error against finer models.
SlicePlan settled(SlicePlan plan, double error) {
  plan.confirm = false;
  plan.model_error = plan.change_beyond = error / plan.factor;
  return plan;
}

}  // namespace

SlicePlan climb(const model::Scene& scene, std::size_t segment, const SlicePlan& slices,
                const model::SegmentResult& result) {
  const double accuracy = scene.goal.accuracy;
  const auto [of_slices, of_sliding] = closed_forms(scene, segment, slices, result);
  const double resolved = slices.factor * result.discretisation_error;
  const double own = resolved + slices.factor * slices.model_error;
  if (own + of_slices <= accuracy) return settled(slices, of_slices + slices.factor * slices.model_error);
  // Slices would do, but not as few, or not on a leg so simple.
  const double left = (accuracy - of_slices) / slices.factor;
  if (left < slices.asked && left > least_share * accuracy / slices.factor) {
    SlicePlan finer = slices;
    finer.asked = keeps_clear * left;
    return finer;
  }
  if (scene.goal.up_to == Fidelity::sliding || of_sliding <= shares_model * accuracy)
    return to_sliding(scene, segment, slices, of_sliding);
  SlicePlan plan = slices;
  if (of_slices == unknown || of_slices < hopeless * accuracy) {
    const Residual residual = by_residual(scene, segment, plan, result, Fidelity::slice);
    if (resolved + residual.error <= accuracy) return settled(plan, residual.error);
    plan.stable_nearby = residual.reliable;
  }
  if (of_sliding == unknown || of_sliding < hopeless * accuracy)
    return to_sliding(scene, segment, plan, of_sliding);
  return to_mesh(scene, segment, plan);
}

SlicePlan climb_from_sliding(const model::Scene& scene, std::size_t segment, const SlicePlan& sliding,
                             const model::SegmentResult& result) {
  if (scene.goal.up_to == Fidelity::sliding) return sliding;
  if (!model::trustworthy(result.status)) {
    const double radius = scene.leg.segments[segment].mean_radius();
    const bool membrane = scene.bandage.thickness <= thickest_membrane * radius;
    const double voltage = sliding.actuated ? std::fabs(scene.bandage.modules[segment].voltage) : 0;
    const bool close = std::fabs(result.voltage_stable) > far_below * voltage;  // NaN: not even at rest
    const bool none = sliding.confirm && !sliding.stable_nearby && membrane && !close;
    return none ? sliding : to_mesh(scene, segment, sliding);
  }
  if (!sliding.confirm) return sliding;
  SlicePlan plan = sliding;
  const Residual residual = by_residual(scene, segment, plan, result, Fidelity::sliding);
  if (plan.factor * result.discretisation_error + residual.error <= scene.goal.accuracy)
    return settled(plan, residual.error);
  return to_mesh(scene, segment, plan);
}

}  // namespace gaiter::solvers
