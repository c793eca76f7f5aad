// SPDX-License-Identifier: BSD-2-Clause
#include "gaiter/solvers/axisym_dual.hpp"

#include <cmath>

#include "gaiter/petsc/check.hpp"

namespace gaiter::solvers {

namespace {

constexpr double longest_step = 0.1;  // of a displacement, over the leg's radius, as of AxisymSolver
constexpr int most_halvings = 12;

}  // namespace

template <int P>
AxisymDual<P>::AxisymDual(AxisymSystem<P>& system, AxisymSolver<P>& solver)
    : system_(system), solver_(solver) {
  for (petsc::Vector* vector : {&residual_, &gradient_, &weight_, &trial_})
    petsc::check(DMCreateGlobalVector(system.space().plex.get(), vector->out()));
}

template <int P>
bool AxisymDual<P>::linearise(Vec state) {
  return solver_.linearise(state, residual_.get()) && solver_.stable();
}

template <int P>
double AxisymDual<P>::error(int block, AxisymOutput output) {
  PetscScalar product = 0;
  petsc::check(differentiate_output(system_, block, output, gradient_.get()));
  solver_.solve_linear(gradient_.get(), weight_.get());
  petsc::check(VecDot(weight_.get(), residual_.get(), &product));
  return -product;
}

template <int P>
bool AxisymDual<P>::advance(Vec state) {
  double largest = 0;
  bool admissible = false;
  solver_.solve_linear(residual_.get(), weight_.get());
  petsc::check(system_.largest_displacement(weight_.get(), largest));
  double length = largest > longest_step ? longest_step / largest : 1;
  for (int halving = 0; std::isfinite(largest) && halving < most_halvings; ++halving, length *= 0.5) {
    petsc::check(VecWAXPY(trial_.get(), -length, weight_.get(), state));
    petsc::check(system_.evaluate(trial_.get(), gradient_.get(), admissible));
    if (admissible) break;
  }
  if (admissible) petsc::check(VecCopy(trial_.get(), state));
  return admissible && length == 1;
}

template class AxisymDual<2>;
template class AxisymDual<3>;
template class AxisymDual<4>;

}  // namespace gaiter::solvers
