// SPDX-License-Identifier: BSD-2-Clause
#include "gaiter/solvers/slice_model.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "gaiter/petsc/session.hpp"
#include "gaiter/physics/model_error.hpp"
#include "gaiter/physics/segment_summary.hpp"
#include "gaiter/physics/slice_kernel.hpp"
#include "gaiter/physics/wall_resolution.hpp"
#include "gaiter/solvers/quick_segments.hpp"

namespace gaiter::solvers {

namespace {

using model::Status;
using physics::Pack;
using physics::pack_width;
using physics::SliceShape;

// Of the quadrature through the wall, where the points are chosen here.
constexpr double wall_tolerance = 1e-12, wall_tolerance_in_single = 1e-8;

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

// Where more is wanted than slices themselves tell.
void SliceModel::foresee() {
  foreseen_.clear();
  const auto asks = [](const SegmentTask& task) {
    const model::Scene& scene = *task.scene;
    return scene.fidelity != model::Fidelity::slice || scene.discretisation.wall_points > 0 ||
           scene.discretisation.slice_count < fewest_to_tell;
  };
  if (planned_ || std::none_of(tasks_.begin(), tasks_.end(), asks)) return;
  foreseen_.resize(tasks_.size());
  std::vector<std::size_t> all(tasks_.size()), doubtful;
  std::iota(all.begin(), all.end(), std::size_t{0});
  const auto tell = [&](std::size_t t, const auto& forecast, bool sure) {
    const model::Scene& scene = *tasks_[t].scene;
    const int points = scene.discretisation.wall_points, slices = scene.discretisation.slice_count;
    const bool gauss = scene.discretisation.slice_rule == model::SliceRule::gauss;
    foreseen_[t].wall_error = points > 0 ? forecast.wall_error(points) : 0;
    foreseen_[t].height_error =
        sure && gauss && slices < fewest_to_tell ? forecast.height_error(slices) : not_known;
    foreseen_[t].model_error =
        scene.fidelity == model::Fidelity::rigid ? forecast.compliance_error() : forecast.first_order_error();
    return true;
  };
  forecast_quickly<double>(
      tasks_, all, Look::once, [](std::size_t) { return model::Wanted{}; },
      [&](std::size_t t, const auto& forecast) { return tell(t, forecast, true); }, doubtful);
  std::vector<physics::SegmentForecast> forecasts;
  for (const std::size_t t : doubtful) forecasts.emplace_back(*tasks_[t].scene, tasks_[t].segment);
  physics::SegmentForecast::analyse(forecasts);
  for (std::size_t k = 0; k < doubtful.size(); ++k) tell(doubtful[k], forecasts[k], false);
}

// The tasks' slices, set up in the memory of the batch before.
void SliceModel::take(std::span<const SegmentTask> tasks) {
  tasks_ = tasks;
  numbers_.clear();
  SliceShape shape;
  bool voltage_somewhere = false, all_newton = true;
  for (const SegmentTask& task : tasks) {
    const model::Scene& scene = *task.scene;
    numbers_.push_back(physics::segment_numbers(scene, task.segment));
    if (task.plan) {
      numbers_.back().wall_points = task.plan->wall_points;
      if (!task.plan->actuated) numbers_.back().voltage = 0;
    }
    const bool voltage = numbers_.back().voltage != 0;
    shape.layers = std::max(shape.layers, voltage ? scene.bandage.layers : 0);
    shape.ogden_terms = static_cast<int>(scene.bandage.ogden.size());
    shape.material = scene.leg.material;
    shape.single = !task.plan && scene.fidelity == model::Fidelity::slice &&
                   scene.leg.model != model::LegModel::rigid &&
                   scene.discretisation.slice_precision == model::SlicePrecision::in_single;
    voltage_somewhere = voltage_somewhere || voltage;
    all_newton = all_newton && scene.discretisation.slice_solver == model::SliceSolver::newton;
  }
  energised_ = !petsc::agree(comm_, !voltage_somewhere);
  newton_ = petsc::agree(comm_, all_newton);
  planned_ = std::any_of(tasks.begin(), tasks.end(), [](const SegmentTask& task) { return task.plan; });
  foresee();
  if (!planned_)
    physics::choose_wall_points(numbers_, shape.single ? wall_tolerance_in_single : wall_tolerance);
  for (std::size_t t = 0; t < tasks.size(); ++t) {
    if (!tasks[t].plan && tasks[t].scene->discretisation.wall_points == 0) continue;
    physics::SegmentNumbers& numbers = numbers_[t];
    numbers.wall_error = tasks[t].plan ? tasks[t].plan->wall_error : foreseen_[t].wall_error;
    numbers.passive_wall_error = 0;  // the forecast is that of the pressure in equilibrium
    // Where it expects no pressure, the estimate for the passive one remains.
    if (!std::isfinite(numbers.wall_error))
      numbers.wall_error = numbers.passive_wall_error =
          physics::wall_error(*tasks[t].scene, tasks[t].segment, static_cast<int>(numbers.wall_points));
  }
  arrange();
  double most_points = 1;
  for (const auto& numbers : numbers_) most_points = std::max(most_points, numbers.wall_points);
  shape.wall = wall_rule(static_cast<int>(most_points));
  const std::size_t packs = blocks_.empty() ? 0 : blocks_.back().end_pack();
  system_.reset(std::move(shape), packs * pack_width);
  states_.resize(packs);
  rigid_pressure_.resize(packs);
  rest_pressure_.resize(packs);
  radii_.resize(packs);
  places_.resize(packs);
  outcomes_.assign(packs, {});
  for (Block& block : blocks_) {
    set_segments(block.tasks, block.segments);
    system_.set_segments(block.first_pack, block.heights, block.segments,
                         std::span(radii_).subspan(block.first_pack));
    for (std::size_t k = block.first_pack; k < block.end_pack(); ++k) {
      places_[k] = block.segments.count;
      outcomes_[k].leg_radius = radii_[k];
      outcomes_[k].inner_radius = block.segments.constants.inner_radius;
    }
  }
}

// Tasks in blocks: those with equally many slices, thin walls before the thicker ones, so that most packs
// have no more wall points than their slices need.
void SliceModel::arrange() {
  struct Counts {
    int slices, pieces, wall_points;
    auto operator<=>(const Counts&) const = default;
  };
  std::map<Counts, std::vector<std::size_t>> alike;
  for (std::size_t t = 0; t < tasks_.size(); ++t) {
    const SlicePlan* plan = tasks_[t].plan;
    const int slices = plan ? plan->slice_count : tasks_[t].scene->discretisation.slice_count;
    const int pieces = plan ? static_cast<int>(plan->cuts.size()) + 1 : 1;
    alike[{slices, pieces, static_cast<int>(numbers_[t].wall_points)}].push_back(t);
  }
  std::size_t blocks = 0, packs = 0;
  Counts before{};
  for (const auto& [counts, tasks] : alike)
    for (const std::size_t task : tasks) {
      const bool same = counts.slices == before.slices && counts.pieces == before.pieces;
      if (blocks == 0 || !same || blocks_[blocks - 1].tasks.size() == pack_width) {
        if (++blocks > blocks_.size()) blocks_.emplace_back();
        Block& block = blocks_[blocks - 1];
        before = counts;
        const model::SliceRule rule =
            tasks_[task].plan ? model::SliceRule::gauss : tasks_[task].scene->discretisation.slice_rule;
        block.first_pack = packs;
        block.rule = &height_rule(rule, counts.slices);
        block.pieces = counts.pieces;
        block.heights.resize(block.rule->nodes.size() * static_cast<std::size_t>(counts.pieces));
        block.tasks.clear();
        packs = block.end_pack();
      }
      blocks_[blocks - 1].tasks.push_back(task);
    }
  blocks_.resize(blocks);
  for (Block& block : blocks_) lay_slices(block);
}

// The rule's points on each piece of the height between the plan's cuts.
void SliceModel::lay_slices(Block& block) {
  const std::size_t count = block.rule->nodes.size();
  block.weights.resize(block.heights.size());
  for (int i = 0; i < pack_width; ++i) {
    const std::size_t task = block.tasks[std::min<std::size_t>(i, block.tasks.size() - 1)];
    for (int piece = 0; piece < block.pieces; ++piece) {
      const double from = piece == 0 ? 0 : tasks_[task].plan->cuts[piece - 1];
      const double to = piece + 1 == block.pieces ? 1 : tasks_[task].plan->cuts[piece];
      for (std::size_t k = 0; k < count; ++k) {
        const std::size_t slice = static_cast<std::size_t>(piece) * count + k;
        block.heights[slice][i] = from + (to - from) * block.rule->nodes[k];
        block.weights[slice][i] = (to - from) * block.rule->weights[k];
      }
    }
  }
}

// Up to 64 tasks to a pack of segments.
void SliceModel::set_segments(std::span<const std::size_t> tasks, physics::SegmentPack& segments) {
  for (std::size_t i = 0; i < tasks.size(); ++i) {
    const physics::SegmentNumbers& numbers = numbers_[tasks[i]];
    segments.set(static_cast<int>(i), numbers, tasks_[tasks[i]].scene->bandage,
                 wall_rule(static_cast<int>(numbers.wall_points)));
  }
  segments.close(static_cast<int>(tasks.size()));
}

// One solver serves all batches, unless one is larger than any before.
void SliceModel::prepare_solver(model::SliceSolver algorithm, double fixed_point_tolerance,
                                double newton_tolerance) {
  const bool fits = solver_ && system_.packs() <= solver_->packs() && algorithm == algorithm_ &&
                    fixed_point_tolerance == fixed_point_tolerance_ && newton_tolerance == newton_tolerance_;
  if (petsc::agree(comm_, fits)) return;
  algorithm_ = algorithm;
  fixed_point_tolerance_ = fixed_point_tolerance;
  newton_tolerance_ = newton_tolerance;
  solver_ = std::make_unique<SliceSolver>(comm_, system_.packs(), algorithm, fixed_point_tolerance,
                                          newton_tolerance);
}

// What Newton's method may leave, by the plans. A bandage that may have several equilibria is not rushed to
// one.
void SliceModel::allow_newton() {
  const bool allowed = planned_ && !solver_->tolerance_given();
  Pack may_leave{};
  for (const Block& block : blocks_) {
    const Pack& stiffens = block.segments.constants.stiffens;
    for (std::size_t i = 0; allowed && i < block.tasks.size(); ++i)
      may_leave[i] = stiffens[i] > 0 ? tasks_[block.tasks[i]].plan->newton_leaves : 0;
    for (std::size_t k = block.first_pack; k < block.end_pack(); ++k) states_[k].may_leave = may_leave;
  }
}

// On a leg that does not give way.
void SliceModel::rigid_pressures() {
  const Pack none{};
  Pack slope, relief{};
  system_.energise(true);
  each_pack([&](const Block&, std::size_t k) {
    if (energised_) physics::actuation_pressure(system_.shape(), system_.pack(k), none, relief, slope);
    physics::record_rigid(system_.pack(k), rigid_pressure_[k], relief, outcomes_[k]);
  });
}

void SliceModel::solve_rigid() {
  const Pack none{};
  Pack slope;
  system_.energise(false);
  each_pack([&](const Block&, std::size_t k) {
    physics::bandage_pressure(system_.shape(), system_.pack(k), none, rigid_pressure_[k], slope);
  });
  rigid_pressures();
  each_pack([&](const Block&, std::size_t k) { physics::adopt_rigid(outcomes_[k]); });
}

// What the slices start from, taken for the answer: no equation is solved.
void SliceModel::solve_first_order() {
  for (const bool at_rest : {true, false}) {
    if (!at_rest && !energised_) break;
    system_.energise(!at_rest);
    each_pack([&](const Block& block, std::size_t k) {
      Pack pressure;
      physics::start_at_rest(system_.shape(), system_.pack(k), states_[k], pressure);
      for (int i = 0; i < pack_width; ++i) states_[k].open[i] = 0;
      if (at_rest) {
        rigid_pressure_[k] = pressure;
        record_rest(block, k);
      } else {
        record_actuated(block, k);
      }
    });
    if (at_rest) rigid_pressures();
  }
}

std::span<const model::SegmentResult> SliceModel::solve(std::span<const SegmentTask> tasks) {
  take(tasks);
  const model::Scene* scene = tasks.empty() ? nullptr : tasks[0].scene;
  const model::Fidelity asked = !scene          ? model::Fidelity::slice
                                : tasks[0].plan ? tasks[0].plan->fidelity
                                                : scene->fidelity;
  const bool rigid = petsc::largest(comm_, scene && (asked == model::Fidelity::rigid ||
                                                     scene->leg.model == model::LegModel::rigid)) > 0;
  const bool first_order = !rigid && petsc::largest(comm_, asked == model::Fidelity::first_order) > 0;
  if (rigid) {
    solve_rigid();
  } else if (first_order) {
    solve_first_order();
  } else {
    prepare_solver(newton_ ? model::SliceSolver::newton : model::SliceSolver::fixed_point,
                   petsc::largest(comm_, scene ? scene->discretisation.fixed_point_tolerance : 0),
                   petsc::largest(comm_, scene ? scene->discretisation.newton_tolerance : 0));
    allow_newton();
    rest();
    rigid_pressures();
    if (energised_) actuate();
  }
  system_.energise(true);
  const model::Fidelity fidelity = rigid         ? model::Fidelity::rigid
                                   : first_order ? model::Fidelity::first_order
                                                 : model::Fidelity::slice;
  if (energised_) finish_actuated(fidelity);
  summarise(fidelity);
  return results_;
}

void SliceModel::summarise(model::Fidelity fidelity) {
  unclear_.clear();
  height_error_.resize(tasks_.size());
  for (const Block& block : blocks_) height_errors(block);
  errors_of_start(fidelity == model::Fidelity::rigid);
  results_.resize(tasks_.size());
  for (const Block& block : blocks_) {
    const auto slices = std::span(outcomes_).subspan(block.first_pack, block.heights.size());
    const physics::SegmentSummary summary(slices, block.weights, block.segments);
    physics::SlicesFound found;
    Pack beyond, highest;
    summary.find(found);
    physics::bound_slice_pressures(block.segments, system_.shape().material, found, beyond, highest);
    for (std::size_t i = 0; i < block.tasks.size(); ++i) {
      const std::size_t task = block.tasks[i];
      const physics::SegmentNumbers& numbers = numbers_[task];
      model::SegmentResult& result = results_[task];
      result = summary.result(static_cast<int>(i), height_error_[task] + numbers.wall_error);
      result.fidelity = fidelity;
      result.slice_count = static_cast<int>(block.heights.size());
      result.wall_points = static_cast<int>(numbers.wall_points);
      if (fidelity == model::Fidelity::slice) result.unknowns = 2 * result.slice_count;
      // A slice's state is that of the branch from rest; where this one ends is not looked for.
      result.voltage_stable =
          result.status < Status::pulled_in ? numbers.voltage : std::numeric_limits<double>::quiet_NaN();
      // The few slices of a plan need not come near the end of the segment.
      const bool leg = fidelity != model::Fidelity::rigid && tasks_[task].plan;
      if (leg && result.status == Status::contact &&
          highest[static_cast<int>(i)] > block.segments.constants.data_limit[static_cast<int>(i)])
        result.status = Status::extrapolated;
      if (!model::trustworthy(result.status)) continue;
      const double before = error_before_slices(task, fidelity), after = beyond[static_cast<int>(i)];
      result.model_error = std::isfinite(after) ? after + before : not_known;
      model::derive_error(result, before);
    }
  }
}

std::vector<model::SegmentResult> solve_segments(MPI_Comm comm, std::span<const SegmentTask> tasks) {
  SliceModel model(comm);
  const auto results = model.solve(tasks);
  return {results.begin(), results.end()};
}

}  // namespace gaiter::solvers
