// SPDX-License-Identifier: BSD-2-Clause
// The states that the slices of a batch pass through: at rest, under voltage, and what is found in each.
#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <span>

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
// A drop is the difference of two pressures unless it is so small a part of these that what Newton's
// tolerance may leave in them shows, or its error is estimated to be larger.
constexpr double small_drop = 0.01, error_of_drop = 1e-11, error_of_drop_in_single = 1e-4;
constexpr int fewest_points_of_drop = 2;
// Actuation pressures over that at rest: parts of the path between the two states on which so many points,
// and one and two more, give the mean slope to 1e-12 even if it changes ten times as fast as the pressure.
constexpr std::array<double, 3> parts_of_drop{5e-4, 0.01, 0.1};
// After an early end of Newton's method, of larger parts too, where a stiff bandage still drops by little: of
// its exponential the most points give the mean slope to 1e-8.
constexpr double part_of_stiff_drop = 0.7;

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
    // What is open is all that later steps work on. Many packs of plans have spare places; elsewhere these
    // are few, and solved with the others every block of the Jacobian is that of its residual.
    for (int i = planned_ ? places_[k] : pack_width; i < pack_width; ++i) states_[k].open[i] = 0;
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
      state.may_leave[i] = 0;
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

// Slices that do not touch the leg under voltage: the bandage's own equilibrium, if it has one.
void SliceModel::float_free() {
  floating_.clear();
  each_pack([&](const Block& block, std::size_t k) {
    const SliceOutcomes& outcomes = outcomes_[k];
    for (int i = 0; i < block.segments.count; ++i)
      if (outcomes.pressure_actuated[i] == 0 && block.segments.constants.voltage[i] != 0 &&
          outcomes.status_of(i) < Status::no_equilibrium)
        floating_.push_back({k, i, block.segments.constants.stiffens[i] > 0});
  });
  for (std::size_t first = 0; first < floating_.size(); first += pack_width) {
    const std::size_t count = std::min<std::size_t>(pack_width, floating_.size() - first);
    float_free(std::span(floating_).subspan(first, count));
  }
}

void SliceModel::float_free(std::span<const FloatingSlice> slices) {
  std::array<std::size_t, pack_width> places;
  Pack start, strain, found;
  for (int i = 0; i < pack_width; ++i) {
    const auto& [pack, place, stiffens] = slices[std::min<std::size_t>(i, slices.size() - 1)];
    places[i] = pack * pack_width + place;
    start[i] = 1 - outcomes_[pack].bandage_radius_actuated[place] / outcomes_[pack].leg_radius[place];
  }
  gathered_.resize(system_.rows_per_pack());
  system_.gather(places, gathered_.data());
  SliceShape shape = system_.shape();
  shape.single = false;
  physics::floating_strains(shape, gathered_.data(), start, strain, found);
  for (int i = 0; i < static_cast<int>(slices.size()); ++i) {
    const auto& [pack, place, stiffens] = slices[i];
    const auto own = stiffens && found[i] > 0 ? std::optional(strain[i])
                                              : physics::floating_strain(system_, places[i], start[i]);
    SliceOutcomes& outcomes = outcomes_[pack];
    const Status floating = outcomes.pressure_rest[place] > 0 ? Status::lifted : Status::slack;
    const Status status = own ? floating : Status::pulled_in;
    outcomes.status[place] = static_cast<double>(std::max(outcomes.status_of(place), status));
    if (own) outcomes.bandage_radius_actuated[place] = outcomes.leg_radius[place] * (1 - *own);
  }
}

// What needs the actuated radius of the bandage: lift-off, actuation pressure, field.
void SliceModel::finish_actuated(model::Fidelity fidelity) {
  float_free();
  each_pack([&](const Block& block, std::size_t k) {
    physics::record_loads(system_.shape(), system_.pack(k), block.segments.constants.voltage, outcomes_[k]);
  });
  if (fidelity == model::Fidelity::slice) small_drops();
}

// Drops whose difference of pressures would have few of their digits: of the residual at rest between the two
// states, which is the actuation pressure, over its mean slope. Those that need equally many points for it go
// into packs of their own.
void SliceModel::small_drops() {
  for (auto& slices : small_drops_) slices.clear();
  const double enough = system_.shape().single ? error_of_drop_in_single : error_of_drop;
  each_pack([&](const Block& block, std::size_t k) {
    const SliceOutcomes& outcomes = outcomes_[k];
    for (int i = 0; i < block.segments.count; ++i) {
      const double part = outcomes.actuation_pressure[i] / outcomes.pressure_rest[i];
      const double drop = outcomes.actuation_drop[i];
      const double may_leave = states_[k].may_leave[i];
      const bool small = drop < small_drop * outcomes.pressure_rest[i] ||
                         outcomes.error_of_difference[i] > std::max(enough, may_leave) * drop;
      const bool stiff = may_leave > 0 && drop < parts_of_drop.back() * outcomes.pressure_rest[i];
      const bool resolved = part > 0 && part < (stiff ? part_of_stiff_drop : parts_of_drop.back());
      if (!small || !resolved || !(outcomes.pressure_actuated[i] > 0)) continue;
      const auto range = std::upper_bound(parts_of_drop.begin(), parts_of_drop.end() - 1, part);
      small_drops_[static_cast<std::size_t>(range - parts_of_drop.begin())].push_back(k * pack_width + i);
    }
  });
  system_.energise(false);
  for (std::size_t range = 0; range < small_drops_.size(); ++range) {
    const physics::Quadrature& gauss = wall_rule(fewest_points_of_drop + static_cast<int>(range));
    for (std::size_t first = 0; first < small_drops_[range].size(); first += pack_width) {
      const std::span slices = std::span(small_drops_[range]).subspan(first);
      small_drops(gauss, slices.first(std::min<std::size_t>(pack_width, slices.size())));
    }
  }
  system_.energise(true);
}

void SliceModel::small_drops(const physics::Quadrature& gauss, std::span<const std::size_t> slices) {
  gathered_.resize(system_.rows_per_pack());
  system_.gather(slices, gathered_.data());
  Pack at_rest, actuated, mean_slope{};
  for (int i = 0; i < pack_width; ++i) {
    const std::size_t slice = slices[std::min<std::size_t>(i, slices.size() - 1)];
    at_rest[i] = rest_pressure_[slice / pack_width][slice % pack_width];
    actuated[i] = states_[slice / pack_width].pressure[slice % pack_width];
  }
  for (std::size_t point = 0; point < gauss.nodes.size(); ++point) {
    const double share = gauss.nodes[point];
    Pack pressure, strain, strain_slope, bandage, bandage_slope;
    for (int i = 0; i < pack_width; ++i) pressure[i] = share * at_rest[i] + (1 - share) * actuated[i];
    physics::leg_strain(system_.shape(), gathered_.data(), pressure, strain, strain_slope);
    physics::bandage_pressure(system_.shape(), gathered_.data(), strain, bandage, bandage_slope);
    for (int i = 0; i < pack_width; ++i)
      mean_slope[i] += gauss.weights[point] * (1 - bandage_slope[i] * strain_slope[i]);
  }
  for (std::size_t i = 0; i < slices.size(); ++i) {
    SliceOutcomes& outcomes = outcomes_[slices[i] / pack_width];
    const std::size_t place = slices[i] % pack_width;
    outcomes.actuation_drop[place] = outcomes.actuation_pressure[place] / mean_slope[static_cast<int>(i)];
  }
}

}  // namespace gaiter::solvers
