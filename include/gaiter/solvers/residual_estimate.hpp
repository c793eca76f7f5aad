// SPDX-License-Identifier: BSD-2-Clause
#pragma once

#include "gaiter/model/result.hpp"
#include "gaiter/solvers/slice_model.hpp"

namespace gaiter::solvers {

// Relative errors of a simpler model's outputs against the axisymmetric finite elements, estimated: value
// over theirs, less 1 [1]. NaN where the simpler model has no contact, and under voltage where there is none.
struct ResidualEstimate {
  // The way to the finite elements' state is one whole step of Newton's method, through stable states. Where
  // this is false the numbers may be as good, but there may also be no such state: a bandage whose fold at
  // rest or under voltage the simpler models do not see.
  bool reliable = false;
  double pressure_rest = 0, pressure_actuated = 0;
  double actuation_drop = 0;  // pressure_rest - pressure_actuated
  double volume_change = 0;   // of the last state that there is, as in SegmentResult

  // Largest change of these by Newton's step (see below): far from the finite elements, where the estimate is
  // rough, about as large as the errors themselves. largest() + spread was above the true error of pressure
  // and actuation_drop wherever there was one to compare with.
  double spread = 0;

  double largest() const;  // magnitude, of those that are not NaN; NaN if all are
};

// How far the slices, or the sliding slices, are from the finite elements on one segment, without solving
// these: the simpler model's displacements, pressures and contact pressures are put into the residual on the
// coarsest mesh, which is weighted by the dual solution of each output (AxisymDual), then once more after a
// step of Newton's method, without which the ends that lift off do not show. The mesh's own error is below
// some 1e-4. What it found against solved finite elements is in tests/residual_estimate.cpp and
// benchmarks/axisym_residual_estimate.cpp.
//
// `own` is the segment's result by `fidelity`, slice or sliding. On this rank alone.
ResidualEstimate estimate_by_residual(const SegmentTask& task, const model::SegmentResult& own,
                                      model::Fidelity fidelity);

}  // namespace gaiter::solvers
