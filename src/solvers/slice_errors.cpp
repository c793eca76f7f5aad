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

constexpr double caution = 10;            // of an error estimated from starting values instead of solutions
constexpr double smallest_error = 4e-15;  // of a sum of some slices, by rounding
constexpr int most_check_points = 128;    // over the height, of the rule that an error estimate compares with

}  // namespace

// From the pressures of a block alone, where these leave no doubt.
void SliceModel::height_errors(const Block& block) {
  const model::SliceRule rule = tasks_[block.tasks[0]].scene->discretisation.slice_rule;
  const auto slices = std::span(outcomes_).subspan(block.first_pack, block.rule->nodes.size());
  if (slices.size() < physics::fewest_for_height_error || rule != model::SliceRule::gauss) {
    unclear_.insert(unclear_.end(), block.tasks.begin(), block.tasks.end());
    return;
  }
  Pack rest, actuated{};
  physics::height_error(*block.rule, slices, &SliceOutcomes::pressure_rest, rest);
  if (energised_) physics::height_error(*block.rule, slices, &SliceOutcomes::pressure_actuated, actuated);
  for (std::size_t i = 0; i < block.tasks.size(); ++i) {
    const int place = static_cast<int>(i);
    const double error = std::max({smallest_error, rest[place], actuated[place]});
    height_error_[block.tasks[i]] = error;
    if (!(error < physics::largest_height_error)) unclear_.push_back(block.tasks[i]);
  }
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
  check_.set_segments(0, heights, segments, radii);
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
