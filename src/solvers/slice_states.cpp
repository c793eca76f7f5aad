// SPDX-License-Identifier: BSD-2-Clause
// The states that the slices of a batch pass through: at rest, under voltage, and what is found in each.
#include <algorithm>
#include <cmath>

#include "gaiter/petsc/session.hpp"
#include "gaiter/physics/branch.hpp"
#include "gaiter/physics/slice_kernel.hpp"
#include "gaiter/solvers/slice_model.hpp"

namespace gaiter::solvers {

using model::Status;
using physics::Pack;
using physics::pack_width;
using physics::PackState;
using physics::SliceOutcomes;
using physics::SliceShape;

namespace {

// f' of the scalar equation of a slice: 1 for a bandage that does not stiffen or soften with the leg's
// radius. Below this there may be a limit point near by, and the equilibrium is searched for along the path.
constexpr double doubtful_slope = 0.5;
constexpr double small_actuation =
    0.1;  // of the pressure at rest: a part of the path that few points resolve
constexpr double error_of_drop = 1e-12;  // relative, for which its difference of pressures is good enough
constexpr int points_of_drop = 4;        // of the mean slope on this part

}  // namespace

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
    // Spare places of a pack: what is open is all that later steps work on.
    for (int i = places_[k]; i < pack_width; ++i) states_[k].open[i] = 0;
  });
  if (newton_) solve_doubtful(true);
  each_pack([&](const Block& block, std::size_t k) { record_rest(block, k); });
}

void SliceModel::actuate() {
  system_.energise(true);
  each_pack([&](const Block& block, std::size_t k) {
    PackState& state = states_[k];
    rest_pressure_[k] = state.pressure;
    if (newton_)
      physics::start_actuated(system_.shape(), system_.pack(k), state);
    else
      physics::start_fixed_point(false, state);
    for (int i = 0; i < pack_width; ++i) {
      const bool passive = block.segments.constants.voltage[i] == 0;
      const bool lost = outcomes_[k].status_of(i) >= Status::no_equilibrium;
      const bool spare = i >= block.segments.count;
      state.open[i] = passive || lost || spare ? 0 : state.open[i];
    }
  });
  using First = SliceSolver::FirstResidual;
  solver_->solve(
      system_, states_, [](std::size_t) {}, newton_ ? First::known : First::evaluated);
  if (newton_) solve_doubtful(false);
  each_pack([&](const Block& block, std::size_t k) { record_actuated(block, k); });
}

// Slices whose equation was, somewhere on the way, too flat for Newton's root to be surely the one that the
// bandage reaches: find the interval of that one, and solve again inside it.
void SliceModel::solve_doubtful(bool at_rest) {
  double reopened = 0;
  each_pack([&](const Block& block, std::size_t k) {
    const Pack& stiffens = block.segments.constants.stiffens;
    PackState& state = states_[k];
    for (int i = 0; i < block.segments.count; ++i) {
      const bool soft = !(stiffens[i] > 0) || (!at_rest && state.smallest_slope[i] < doubtful_slope);
      if (!soft || state.iterations[i] == 0) continue;
      const double highest = at_rest ? system_.pack(k)[SliceShape::pressure_limit][i] : rest_pressure_[k][i];
      if (!(highest > 0)) continue;
      const auto found = physics::contact_interval(system_, k * pack_width + i, highest, at_rest);
      state.open[i] = found ? 1 : 0;
      if (found) {
        state.low[i] = std::min(found->from, found->to);
        state.high[i] = std::max(found->from, found->to);
        state.pressure[i] = 0.5 * (found->from + found->to);
        ++reopened;
      } else {
        state.pressure[i] = 0;
      }
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

void SliceModel::record_rest(const Block& block, std::size_t k) {
  physics::record_rest(system_.shape(), system_.pack(k), block.segments.constants, states_[k], outcomes_[k]);
}

void SliceModel::record_actuated(const Block& block, std::size_t k) {
  physics::record_actuated(system_.shape(), system_.pack(k), block.segments.constants, states_[k],
                           outcomes_[k]);
}

// Slices of a pack that do not touch the leg under voltage: the bandage's own equilibrium, if it has one.
void SliceModel::float_free(const Block& block, std::size_t pack) {
  SliceOutcomes& outcomes = outcomes_[pack];
  for (int i = 0; i < block.segments.count; ++i) {
    if (outcomes.pressure_actuated[i] != 0 || block.segments.constants.voltage[i] == 0 ||
        outcomes.status_of(i) >= Status::no_equilibrium)
      continue;
    const double start = 1 - outcomes.bandage_radius_actuated[i] / outcomes.leg_radius[i];
    const auto strain = physics::floating_strain(system_, pack * pack_width + i, start);
    const Status floating = outcomes.pressure_rest[i] > 0 ? Status::lifted : Status::slack;
    const Status found = strain ? floating : Status::pulled_in;
    outcomes.status[i] = static_cast<double>(std::max(outcomes.status_of(i), found));
    if (strain) outcomes.bandage_radius_actuated[i] = outcomes.leg_radius[i] * (1 - *strain);
  }
}

// What needs the actuated radius of the bandage: lift-off, actuation pressure, field.
void SliceModel::finish_actuated(model::Fidelity fidelity) {
  each_pack([&](const Block& block, std::size_t k) {
    float_free(block, k);
    physics::record_loads(system_.shape(), system_.pack(k), block.segments.constants.voltage, outcomes_[k]);
    if (fidelity == model::Fidelity::slice) small_drops(k);
  });
}

// A drop that is small beside the pressures, whose difference would have few of its digits: that of the
// residual at rest between the two states, which is the actuation pressure, over its mean slope.
void SliceModel::small_drops(std::size_t k) {
  SliceOutcomes& outcomes = outcomes_[k];
  int small[pack_width], any = 0;
  for (int i = 0; i < pack_width; ++i) {
    small[i] = outcomes.pressure_actuated[i] > 0 &&
               outcomes.actuation_pressure[i] < small_actuation * outcomes.pressure_rest[i] &&
               outcomes.error_of_difference[i] > error_of_drop * outcomes.actuation_drop[i];
    any |= small[i];
  }
  if (!any) return;
  const physics::Quadrature& gauss = wall_rule(points_of_drop);
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
  for (int i = 0; i < pack_width; ++i)
    if (small[i]) outcomes.actuation_drop[i] = outcomes.actuation_pressure[i] / mean_slope[i];
}

}  // namespace gaiter::solvers
