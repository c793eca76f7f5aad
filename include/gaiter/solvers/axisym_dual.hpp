// SPDX-License-Identifier: BSD-2-Clause
#pragma once

#include "gaiter/solvers/axisym_solver.hpp"
#include "gaiter/solvers/axisym_summary.hpp"

namespace gaiter::solvers {

// How far an output J is off at a state that is not the equilibrium of a system: of a coarser mesh, or of a
// simpler model. With the residual r and the tangent K there, and the dual K z = dJ/dx (K is symmetric),
//   J(equilibrium) - J(state) = - z . r + what is quadratic in the distance between the two.
// The contacts are those that are active at the state.
template <int P>
class AxisymDual {
 public:
  // @note Collective.
  AxisymDual(AxisymSystem<P>& system, AxisymSolver<P>& solver);

  // Residual and tangent at a state. False where it is inadmissible, or where the tangent is not that of a
  // stable state: then an equilibrium close by is not to be expected. @note Collective.
  bool linearise(Vec state);

  // Estimate of J(equilibrium) - J(state) for the tube of a block, in the units of AxisymSummary. The weight
  // z stays until the next call. @note Collective.
  double error(int block, AxisymOutput output);

  // Takes Newton's step from the state that was linearised, shortened where AxisymSolver would do so too.
  // False where it was, or where it found no admissible state and took none. @note Collective.
  bool advance(Vec state);

  Vec residual() const { return residual_.get(); }
  Vec weight() const { return weight_.get(); }

 private:
  AxisymSystem<P>& system_;
  AxisymSolver<P>& solver_;
  petsc::Vector residual_, gradient_, weight_, trial_;
};

}  // namespace gaiter::solvers
