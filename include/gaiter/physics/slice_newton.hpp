// SPDX-License-Identifier: BSD-2-Clause
#pragma once

#include "gaiter/physics/slice_system.hpp"

// The equilibrium of a slice, for a pack of slices at a time. Unknowns: the leg's strain eps (the radius is
// r = R_c (1 - eps); eps keeps the digits of a small displacement that r would lose) and the interface
// pressure P in units of the pack's pressure scale. Contact is the complementarity P >= 0, P >= P_t, P (P -
// P_t) = 0. Residual:
//   F1 = eps - eps_r(P),   F2 = P - P_t(eps), or P where both P and P_t are not positive;
// Jacobian [1, -eps_r'; -P_t', 1]. On F1 = 0 this is one equation f(P) = P - P_t(eps_r(P)) = 0 whose root is
// bracketed by P = 0 and the pressure that shrinks the leg until the bandage is slack: a step that would
// leave its slice's bracket goes to P = 0, if that was not tried yet, or bisects.
namespace gaiter::physics {

struct PackState {
  Pack strain, pressure;                    // the iterate
  Pack strain_residual, pressure_residual;  // F1, F2
  Pack strain_slope, bandage_slope;         // eps_r'(P); d P_t / d eps, 0 without contact
  Pack low, high;                           // bracket of the pressure; low = -1 until P = 0 has been tried
  Pack rounding;        // pressure at rest, of whose rounding errors an actuated P cannot be rid
  Pack left;            // error of the pressure that closing leaves, as predicted
  Pack settled_slope;   // d P_t / d eps where it closed
  Pack smallest_slope;  // least f' seen: near or below 0 there may be several equilibria
  Pack may_leave;  // part of the pressure that `left` may be, and of the radius; 0: the least; starts keep it
  Pack iterations;
  Pack open;    // 1 while the slice is being solved, else 0
  Pack failed;  // 1 where the fixed point left the admissible range
};

// Rest: from the rigid answer, corrected to first order for the compliance of the leg. Also gives the
// bandage's pressure on a rigid leg (may be negative: slack).
void start_at_rest(const SliceShape& shape, const Pack* rows, PackState& state, Pack& rigid_pressure);

// Actuated: from the rest state held in `state`. The root sought is the largest below the pressure at rest,
// which is the one that a slowly rising voltage reaches. The residual is the actuation pressure, since the
// rest is in equilibrium; so it comes with the start.
void start_actuated(const SliceShape& shape, const Pack* rows, PackState& state);

// The paper's start: the undeformed leg at rest; under voltage the radius at rest, held in `state`.
void start_fixed_point(bool at_rest, PackState& state);

// Residual and Jacobian at the iterate, on F1 = 0 or not.
void evaluate_residual(const SliceShape& shape, const Pack* rows, PackState& state);

// The same of the open slices. A closed one keeps its slopes, from which the voltage starts: they must not
// depend on whether a neighbour is solved again.
void evaluate_open(const SliceShape& shape, const Pack* rows, PackState& state);

// Newton directions y = J^-1 F of (F1, F2) given.
void solve_blocks(const Pack& strain_slope, const Pack& bandage_slope, const Pack& strain_residual,
                  const Pack& pressure_residual, Pack& strain_direction, Pack& pressure_direction);

// The smallest relative error to which slices can close, where `tolerance` is asked for.
double reachable(const SliceShape& shape, double tolerance);

// One damped Newton step of each open slice, P - direction, and the residual there. Far from the solution,
// where bandage and leg differ by more than a factor of four, Newton's step for ln P = ln P_t is taken if it
// is the larger, though not past the middle of the bracket. A slice closes when its next step is predicted to
// leave a relative error below `tolerance`, or surely below what it may leave; that step is still taken.
void advance_newton(const SliceShape& shape, const Pack* rows, const Pack& direction, double tolerance,
                    PackState& state);

// One step of the paper's iteration, P <- P - direction with direction = F2, for each open slice; it closes
// when its radius changes by less than `tolerance` times the undeformed one.
void advance_fixed_point(const SliceShape& shape, const Pack* rows, const Pack& direction, double tolerance,
                         PackState& state);

// Errors of the pressures of closed slices, in units of S.
struct PressureError {
  Pack solution;  // what the last step has left, and rounding
  Pack wall;      // of the quadrature through the wall, beyond `wall_error` itself
};

// The equation amplifies rounding where the bandage is nearly slack (the gap cancels), where the voltage
// takes most of its pressure, and near a limit point (f' is small); the relative error of the quadrature
// through the wall, `passive_wall_error`, in the same way (SegmentConstants). In single precision the leg's
// and the bandage's exponentials and logarithms are rounded, but not the gap: `slope` amplifies these alone.
void pressure_error(const SliceShape& shape, const Pack* rows, const PackState& state, const Pack& wall_error,
                    const Pack& passive_wall_error, PressureError& error);

}  // namespace gaiter::physics
