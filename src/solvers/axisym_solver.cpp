// SPDX-License-Identifier: BSD-2-Clause
#include "gaiter/solvers/axisym_solver.hpp"

#include <algorithm>
#include <cmath>

#include "gaiter/petsc/check.hpp"

namespace gaiter::solvers {

namespace {

constexpr double longest_step = 0.1;     // of a displacement, over the leg's radius
constexpr double step_tolerance = 1e-7;  // Newton is quadratic there: what is left is some 1e-14
constexpr int most_iterations = 30;
constexpr int most_halvings = 12;

}  // namespace

template <int P>
AxisymSolver<P>::AxisymSolver(AxisymSystem<P>& system) : system_(system) {
  petsc::check(create());
  linear_.require_available();
}

template <int P>
PetscErrorCode AxisymSolver<P>::create() {
  PetscFunctionBegin;
  PetscCall(DMCreateGlobalVector(system_.space().plex.get(), residual_.out()));
  PetscCall(SNESCreate(system_.comm(), snes_.out()));
  SNES snes = snes_.get();
  PetscCall(SNESSetOptionsPrefix(snes, "axisym_"));
  PetscCall(SNESSetFunction(snes, residual_.get(), form_function, this));
  PetscCall(SNESSetJacobian(snes, system_.matrix(), system_.matrix(), form_jacobian, this));
  PetscCall(SNESSetTolerances(snes, 0, 0, step_tolerance, most_iterations, -1));
  PetscCall(SNESSetConvergenceTest(snes, converged, this, nullptr));
  SNESLineSearch search = nullptr;
  PetscCall(SNESGetLineSearch(snes, &search));
  PetscCall(SNESLineSearchSetType(search, SNESLINESEARCHSHELL));
  PetscCall(SNESLineSearchShellSetUserFunc(search, step, this));
  KSP ksp = nullptr;
  PetscCall(SNESGetKSP(snes, &ksp));
  PetscCall(linear_.create(system_.space().plex.get(), system_.matrix(), ksp));
  PetscCall(SNESSetFromOptions(snes));
  PetscCall(SNESGetTolerances(snes, nullptr, nullptr, &step_tolerance_, &most_iterations_, nullptr));
  PetscCall(linear_.prepare());
  pattern_ = system_.pattern();
  PetscFunctionReturn(PETSC_SUCCESS);
}

template <int P>
AxisymReport AxisymSolver<P>::solve(Vec x, int most) {
  AxisymReport report;
  petsc::check(run(x, most, report));
  return report;
}

template <int P>
PetscErrorCode AxisymSolver<P>::run(Vec x, int most, AxisymReport& report) {
  PetscFunctionBegin;
  steps_.clear();
  full_step_ = false;
  PetscCall(SNESSetTolerances(snes_.get(), PETSC_DEFAULT, PETSC_DEFAULT, PETSC_DEFAULT,
                              std::min<PetscInt>(most, most_iterations_), PETSC_DEFAULT));
  PetscCall(SNESSolve(snes_.get(), nullptr, x));
  SNESConvergedReason reason = SNES_CONVERGED_ITERATING;
  PetscInt iterations = 0;
  PetscCall(SNESGetConvergedReason(snes_.get(), &reason));
  PetscCall(SNESGetIterationNumber(snes_.get(), &iterations));
  report.steps = steps_;
  report.converged = reason > 0;
  report.iterations = static_cast<int>(iterations);
  // Of the last tangent made, which is that of the solution but for the last, tiny step.
  if (report.converged) report.stable = stable();
  PetscFunctionReturn(PETSC_SUCCESS);
}

template <int P>
void AxisymSolver<P>::try_at(Vec x) {
  petsc::Vector direction;
  petsc::check(VecDuplicate(x, direction.out()));
  if (!linearise(x, residual_.get())) return;
  solve_linear(residual_.get(), direction.get());
}

template <int P>
bool AxisymSolver<P>::linearise(Vec x, Vec residual) {
  bool admissible = true;
  petsc::check(make_linear(x, residual, admissible));
  return admissible;
}

template <int P>
PetscErrorCode AxisymSolver<P>::make_linear(Vec x, Vec residual, bool& admissible) {
  PetscFunctionBegin;
  KSP ksp = nullptr;
  PetscCall(system_.evaluate(x, residual, admissible));
  if (!admissible) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(assemble());
  PetscCall(SNESGetKSP(snes_.get(), &ksp));
  PetscCall(KSPSetOperators(ksp, system_.matrix(), system_.matrix()));
  PetscCall(KSPSetUp(ksp));
  PetscFunctionReturn(PETSC_SUCCESS);
}

template <int P>
void AxisymSolver<P>::solve_linear(Vec right, Vec solution) {
  petsc::check(solve_once(right, solution));
}

template <int P>
PetscErrorCode AxisymSolver<P>::solve_once(Vec right, Vec solution) {
  PetscFunctionBegin;
  KSP ksp = nullptr;
  PetscCall(SNESGetKSP(snes_.get(), &ksp));
  PetscCall(KSPSolve(ksp, right, solution));
  PetscFunctionReturn(PETSC_SUCCESS);
}

template <int P>
bool AxisymSolver<P>::stable() const {
  PetscInt negative = 0;
  petsc::check(linear_.count_negative(&negative));
  return negative == system_.space().negative_eigenvalues();
}

template <int P>
PetscErrorCode AxisymSolver<P>::assemble() {
  PetscFunctionBegin;
  PetscCall(system_.assemble());
  if (pattern_ != system_.pattern()) PetscCall(linear_.renew());
  pattern_ = system_.pattern();
  PetscFunctionReturn(PETSC_SUCCESS);
}

template <int P>
PetscErrorCode AxisymSolver<P>::form_function(SNES snes, Vec x, Vec f, void* context) {
  PetscFunctionBegin;
  auto& self = *static_cast<AxisymSolver*>(context);
  bool admissible = true;
  PetscCall(self.system_.evaluate(x, f, admissible));
  if (!admissible) PetscCall(SNESSetFunctionDomainError(snes));
  PetscFunctionReturn(PETSC_SUCCESS);
}

template <int P>
PetscErrorCode AxisymSolver<P>::form_jacobian(SNES, Vec, Mat, Mat, void* context) {
  PetscFunctionBegin;
  auto& self = *static_cast<AxisymSolver*>(context);
  // evaluate() was last called at this x: with the first residual, or with the step taken.
  PetscCall(self.assemble());
  PetscFunctionReturn(PETSC_SUCCESS);
}

template <int P>
PetscErrorCode AxisymSolver<P>::step(SNESLineSearch search, void* context) {
  PetscFunctionBegin;
  auto& self = *static_cast<AxisymSolver*>(context);
  Vec x = nullptr, f = nullptr, y = nullptr, trial = nullptr;
  PetscCall(SNESLineSearchGetVecs(search, &x, &f, &y, &trial, nullptr));
  double largest = 0;
  PetscCall(self.system_.largest_displacement(y, largest));
  double length = largest > longest_step ? longest_step / largest : 1;
  bool admissible = false;
  for (int halving = 0; std::isfinite(largest) && halving < most_halvings; ++halving, length *= 0.5) {
    PetscCall(VecWAXPY(trial, -length, y, x));
    PetscCall(self.system_.evaluate(trial, f, admissible));
    if (admissible) break;
  }
  PetscCall(SNESLineSearchSetReason(search,
                                    admissible ? SNES_LINESEARCH_SUCCEEDED : SNES_LINESEARCH_FAILED_DOMAIN));
  if (!admissible) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(VecCopy(trial, x));
  self.steps_.push_back(length * largest);
  self.full_step_ = length == 1;
  PetscReal x_norm = 0, f_norm = 0, y_norm = 0;
  PetscCall(VecNorm(x, NORM_2, &x_norm));
  PetscCall(VecNorm(f, NORM_2, &f_norm));
  PetscCall(VecNorm(y, NORM_2, &y_norm));
  PetscCall(SNESLineSearchSetNorms(search, x_norm, f_norm, length * y_norm));
  PetscFunctionReturn(PETSC_SUCCESS);
}

template <int P>
PetscErrorCode AxisymSolver<P>::converged(SNES snes, PetscInt iteration, PetscReal, PetscReal,
                                          PetscReal residual_norm, SNESConvergedReason* reason,
                                          void* context) {
  PetscFunctionBegin;
  auto& self = *static_cast<AxisymSolver*>(context);
  *reason = SNES_CONVERGED_ITERATING;
  if (!std::isfinite(residual_norm))
    *reason = SNES_DIVERGED_FNORM_NAN;
  else if (iteration > 0 && self.full_step_ && self.steps_.back() < self.step_tolerance_ &&
           self.system_.active_changes() == 0)
    *reason = SNES_CONVERGED_SNORM_RELATIVE;
  PetscCall(PetscInfo(snes, "step %g, contacts changed %d\n", self.steps_.empty() ? 0.0 : self.steps_.back(),
                      self.system_.active_changes()));
  PetscFunctionReturn(PETSC_SUCCESS);
}

template class AxisymSolver<2>;
template class AxisymSolver<3>;
template class AxisymSolver<4>;

}  // namespace gaiter::solvers
