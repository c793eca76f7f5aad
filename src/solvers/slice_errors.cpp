// SPDX-License-Identifier: BSD-2-Clause
// Relative errors of the height averages of a batch of slices.
#include <algorithm>
#include <cmath>

#include "gaiter/physics/height_error.hpp"
#include "gaiter/physics/slice_kernel.hpp"
#include "gaiter/solvers/slice_model.hpp"

namespace gaiter::solvers {

using physics::Pack;
using physics::pack_width;
using physics::SliceOutcomes;

namespace {

constexpr double caution = 10;  // of an error estimated from starting values instead of solutions
constexpr double largest_own_error =
    1e-4;                                 // that the slices' own pressures tell; beyond, there may be a kink
constexpr double smallest_error = 4e-15;  // of a sum of some slices, by rounding
constexpr int most_check_points = 128;    // over the height, of the rule that an error estimate compares with

}  // namespace

// Relative, of the average of a quantity over the height, of the pieces of which each tells by itself.
void SliceModel::height_error(const Block& block, Pack SliceOutcomes::*quantity, Pack& relative) const {
  const std::size_t count = block.rule->nodes.size();
  const physics::SegmentConstants<Pack>& leg = block.segments.constants;
  Pack sum{}, whole{};
  for (int piece = 0; piece < block.pieces; ++piece) {
    const std::size_t from = static_cast<std::size_t>(piece) * count;
    Pack roughness, error, mean, share{};
    for (std::size_t k = 0; k < count; ++k)
      for (int i = 0; i < pack_width; ++i) share[i] += block.weights[from + k][i];
    for (int i = 0; i < pack_width; ++i) {
      const double ends = leg.upper_radius[i] + leg.lower_radius[i];
      roughness[i] = std::fabs((leg.upper_radius[i] - leg.lower_radius[i]) / ends) * share[i];
      const SlicePlan* plan = tasks_[block.tasks[std::min<std::size_t>(i, block.tasks.size() - 1)]].plan;
      if (plan) roughness[i] = std::max(roughness[i], plan->roughness);
    }
    physics::height_error(*block.rule, std::span(outcomes_).subspan(block.first_pack + from, count), quantity,
                          roughness, error, mean);
    for (int i = 0; i < pack_width; ++i) {
      sum[i] += share[i] * error[i];
      whole[i] += share[i] * mean[i];
    }
  }
  for (int i = 0; i < pack_width; ++i) relative[i] = whole[i] != 0 ? sum[i] / std::fabs(whole[i]) : 0;
}

// From the pressures of a block alone, where these leave no doubt.
void SliceModel::height_errors(const Block& block) {
  const std::size_t count = block.rule->nodes.size();
  const auto tell = [&](auto&& error_of) {
    for (std::size_t i = 0; i < block.tasks.size(); ++i)
      height_error_[block.tasks[i]] = error_of(static_cast<int>(i), tasks_[block.tasks[i]].plan);
  };
  const SegmentTask& first = tasks_[block.tasks[0]];
  const bool planned = first.plan != nullptr;
  const bool gauss = planned || first.scene->discretisation.slice_rule == model::SliceRule::gauss;
  const int fewest = planned ? physics::fewest_for_height_error : fewest_to_tell;
  if (static_cast<int>(count) < fewest || !gauss) {
    if (planned) tell([](int, const SlicePlan* plan) { return plan->height_error; });
    for (std::size_t i = 0; !planned && i < block.tasks.size(); ++i) {
      const std::size_t task = block.tasks[i];
      const double foreseen = foreseen_.empty() ? not_known : foreseen_[task].height_error;
      if (std::isfinite(foreseen))
        height_error_[task] = std::max(smallest_error, foreseen);
      else
        unclear_.push_back(task);
    }
    return;
  }
  Pack worst{}, found;
  height_error(block, &SliceOutcomes::pressure_rest, worst);
  if (energised_) {
    height_error(block, &SliceOutcomes::pressure_actuated, found);
    for (int i = 0; i < pack_width; ++i) worst[i] = std::max(worst[i], found[i]);
  }
  const auto wants_volume = [&](std::size_t task) {
    return planned && tasks_[task].scene->goal.of(tasks_[task].segment).volume_change;
  };
  if (std::any_of(block.tasks.begin(), block.tasks.end(), wants_volume)) {
    height_error(block, &SliceOutcomes::strain_actuated, found);
    for (std::size_t i = 0; i < block.tasks.size(); ++i)
      if (const int place = static_cast<int>(i); wants_volume(block.tasks[i]))
        worst[place] = std::max(worst[place], found[place] / tasks_[block.tasks[i]].plan->factor);
  }
  tell([&](int place, const SlicePlan* plan) {
    // The forecast may not have known.
    const double foreseen = plan && std::isfinite(plan->height_error) ? plan->height_error : 0;
    return std::max({smallest_error, worst[place], foreseen});
  });
  for (std::size_t i = 0; !planned && i < block.tasks.size(); ++i)
    if (!(worst[static_cast<int>(i)] < largest_own_error)) unclear_.push_back(block.tasks[i]);
}

// What slices would change in the pressures of a simpler model; not_known: that is not known.
double SliceModel::error_before_slices(std::size_t task, model::Fidelity fidelity) const {
  const model::Scene& scene = *tasks_[task].scene;
  if (fidelity == model::Fidelity::slice || scene.leg.model == model::LegModel::rigid) return 0;
  if (tasks_[task].plan) return tasks_[task].plan->model_error;
  // A leg without compliance has none to correct for.
  const bool known = scene.leg.material != model::LegMaterial::compliance ||
                     scene.leg.segments[tasks_[task].segment].compliance.b > 0;
  // A leg that gives way may feel nothing at all, and no multiple of that is the error.
  const double error = foreseen_.empty() ? not_known : foreseen_[task].model_error;
  return known && std::isfinite(error) ? error : not_known;
}

// Of the tasks left, from the average of the starting values, which are close to the pressures.
void SliceModel::errors_of_start(bool rigid) {
  for (std::size_t first = 0, end = 0; first < unclear_.size(); first = end) {
    const auto slices = [&](std::size_t k) { return tasks_[unclear_[k]].scene->discretisation.slice_count; };
    while (end < unclear_.size() && end - first < pack_width && slices(end) == slices(first)) ++end;
    errors_of_start(std::span(unclear_).subspan(first, end - first), rigid);
  }
}

// Up to 64 tasks with equally many slices: the average by their rule against the one by a finer rule.
void SliceModel::errors_of_start(std::span<const std::size_t> tasks, bool rigid) {
  const model::Discretisation& how = tasks_[tasks[0]].scene->discretisation;
  const physics::Quadrature& own = height_rule(how.slice_rule, how.slice_count);
  const physics::Quadrature& fine =
      height_rule(model::SliceRule::gauss, std::min(2 * how.slice_count + 4, most_check_points));
  std::vector<double> heights = fine.nodes;
  heights.insert(heights.end(), own.nodes.begin(), own.nodes.end());
  std::vector<Pack> radii(heights.size());
  physics::SegmentPack segments;
  set_segments(tasks, segments);
  check_.reset(system_.shape(), heights.size() * pack_width);
  std::vector<Pack> places(heights.size());
  for (std::size_t k = 0; k < heights.size(); ++k)
    for (int i = 0; i < pack_width; ++i) places[k][i] = heights[k];
  check_.set_segments(0, places, segments, radii);
  Pack error;
  for (int i = 0; i < pack_width; ++i) error[i] = smallest_error;
  for (bool on : {false, true}) {
    if (on && !energised_) break;
    check_.energise(on);
    Pack finer{}, coarse{}, pressure;
    physics::PackState start;
    for (std::size_t k = 0; k < heights.size(); ++k) {
      const bool is_fine = k < fine.nodes.size();
      const double weight = is_fine ? fine.weights[k] : own.weights[k - fine.nodes.size()];
      Pack& average = is_fine ? finer : coarse;
      physics::start_at_rest(check_.shape(), check_.pack(k), start, pressure);
      for (int i = 0; i < pack_width; ++i)
        average[i] += weight * (rigid ? std::max(0.0, pressure[i]) : start.pressure[i]);
    }
    for (int i = 0; i < pack_width; ++i)
      if (finer[i] > 0) error[i] = std::max(error[i], caution * std::fabs(coarse[i] / finer[i] - 1));
  }
  for (std::size_t i = 0; i < tasks.size(); ++i) height_error_[tasks[i]] = error[static_cast<int>(i)];
}

}  // namespace gaiter::solvers
