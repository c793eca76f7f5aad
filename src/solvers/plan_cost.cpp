// SPDX-License-Identifier: BSD-2-Clause
#include <algorithm>
#include <cmath>

#include "gaiter/physics/height_error.hpp"
#include "gaiter/solvers/auto_model.hpp"

namespace gaiter::solvers {

namespace {

using model::Fidelity;

// Measured on one core of a 2.1 GHz x86-64 server, large batches [s]; of a slice in one state, and of its
// pressure at one wall point, per Ogden term.
constexpr double cost_of_segment = 0.14e-6;
constexpr double cost_of_rigid_slice = 8e-9, cost_of_corrected_slice = 19e-9, cost_of_slice = 128e-9;
// Of the steps that Newton's method is spared by each power of two of what it may leave.
constexpr double cost_of_newton_octave = 3.5e-9;
constexpr int least_octave = -28, most_octave = -8;
constexpr double cost_of_own_error = 3e-9;
constexpr double cost_of_rigid_pressure = 2e-9, cost_of_pressure = 13e-9;
constexpr double cost_of_sliding_slice = 8e-6;
constexpr double cost_of_finite_elements = 0.04;  // at refinement 0; four times more with each

// Powers of two by which Newton's method may leave more than what takes it a step less.
int newton_octaves(double leaves) {
  return leaves > 0 ? std::clamp(std::ilogb(leaves), least_octave, most_octave) - least_octave : 0;
}

}  // namespace

double plan_cost(const model::Scene& scene, std::size_t segment, const SlicePlan& plan) {
  const int states = plan.actuated && scene.bandage.modules[segment].voltage != 0 ? 2 : 1;
  const double slices = static_cast<double>(plan.slice_count) * (1 + static_cast<double>(plan.cuts.size()));
  if (plan.fidelity == Fidelity::axisym)
    return states * cost_of_finite_elements * std::pow(4, plan.slice_count);
  if (plan.fidelity == Fidelity::sliding) return states * cost_of_sliding_slice * slices;
  const double points = plan.wall_points * static_cast<double>(scene.bandage.ogden.size());
  const bool solved = plan.fidelity == Fidelity::slice;
  const double slice = (solved                                   ? cost_of_slice
                        : plan.fidelity == Fidelity::first_order ? cost_of_corrected_slice
                                                                 : cost_of_rigid_slice) +
                       (plan.slice_count >= physics::fewest_for_height_error ? cost_of_own_error : 0) +
                       points * (solved ? cost_of_pressure : cost_of_rigid_pressure) -
                       (solved ? cost_of_newton_octave * newton_octaves(plan.newton_leaves) : 0);
  return cost_of_segment + states * slices * slice;
}

}  // namespace gaiter::solvers
