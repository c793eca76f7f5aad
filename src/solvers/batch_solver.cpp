// SPDX-License-Identifier: BSD-2-Clause
#include "gaiter/solvers/batch_solver.hpp"

#include <petscdmshell.h>

#include <cmath>

#include "gaiter/petsc/check.hpp"

namespace gaiter::solvers {

PetscErrorCode BatchSolver::create(MPI_Comm comm, PetscInt rows, const Setup& setup) {
  PetscFunctionBegin;
  PetscCall(VecCreate(comm, solution_.out()));
  PetscCall(VecSetSizes(solution_.get(), rows, PETSC_DETERMINE));
  PetscCall(VecSetBlockSize(solution_.get(), setup.block_rows));
  PetscCall(VecSetType(solution_.get(), VECSTANDARD));
  PetscCall(VecSet(solution_.get(), 0));
  PetscCall(VecDuplicate(solution_.get(), residual_.out()));

  const bool assembled = jacobian_.get() != nullptr;
  if (!assembled) {
    PetscCall(MatCreateShell(comm, rows, rows, PETSC_DETERMINE, PETSC_DETERMINE, this, jacobian_.out()));
    PetscCall(
        MatShellSetOperation(jacobian_.get(), MATOP_MULT, reinterpret_cast<void (*)(void)>(apply_jacobian)));
  }
  PetscCall(SNESCreate(comm, snes_.out()));
  SNES snes = snes_.get();
  PetscCall(SNESSetOptionsPrefix(snes, setup.prefix));
  PetscCall(SNESSetFunction(snes, residual_.get(), form_function, this));
  PetscCall(SNESSetJacobian(snes, jacobian_.get(), jacobian_.get(), form_jacobian, this));
  PetscCall(SNESSetType(snes, setup.snes_type));
  PetscCall(
      SNESSetTolerances(snes, PETSC_DEFAULT, setup.tolerance, PETSC_DEFAULT, setup.steps, PETSC_DEFAULT));
  PetscCall(SNESSetMaxLinearSolveFailures(snes, setup.steps));
  PetscCall(SNESSetConvergenceTest(snes, converged, this, nullptr));

  SNESLineSearch search = nullptr;
  PetscCall(SNESGetLineSearch(snes, &search));
  PetscCall(SNESLineSearchSetType(search, SNESLINESEARCHSHELL));
  PetscCall(SNESLineSearchShellSetUserFunc(search, advance, this));

  KSP ksp = nullptr;
  PC pc = nullptr;
  PetscCall(SNESGetKSP(snes, &ksp));
  PetscCall(KSPSetType(ksp, KSPPREONLY));
  PetscCall(KSPGetPC(ksp, &pc));
  PetscCall(PCSetType(pc, assembled ? PCPBJACOBI : PCSHELL));
  if (!assembled) {
    PetscCall(PCShellSetContext(pc, this));
    PetscCall(PCShellSetApply(pc, apply_inverse));
    PetscCall(PCShellSetName(pc, setup.inverse_name));
  }
  PetscCall(SNESSetFromOptions(snes));
  // The trust region asks the SNES's shell DM for its work vectors before there is a solution to copy.
  DM shell = nullptr;
  PetscCall(SNESGetDM(snes, &shell));
  PetscCall(DMShellSetGlobalVector(shell, solution_.get()));
  PetscCall(SNESSetUp(snes));

  PetscBool direct = PETSC_FALSE, ours = PETSC_FALSE;
  PetscCall(PetscObjectTypeCompare((PetscObject)ksp, KSPPREONLY, &direct));
  PetscCall(PetscObjectTypeCompare((PetscObject)pc, PCSHELL, &ours));
  own_inverse_ = direct && ours;
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode BatchSolver::add_over_ranks(Totals& totals) const {
  PetscFunctionBegin;
  double local[4] = {totals.open, totals.failed, totals.residual_square, totals.step_square}, all[4];
  PetscCallMPI(MPI_Allreduce(local, all, 4, MPI_DOUBLE, MPI_SUM, PetscObjectComm((PetscObject)snes_.get())));
  totals = {all[0], all[1], all[2], all[3]};
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode BatchSolver::solve_open(Totals totals, int& iterations) {
  PetscFunctionBegin;
  iterations = 0;
  PetscCall(add_over_ranks(totals));
  open_ = totals.open;
  if (open_ == 0) PetscFunctionReturn(PETSC_SUCCESS);
  current_ = true;
  blockwise_ = true;
  PetscCall(SNESGetTolerances(snes_.get(), nullptr, &tolerance_, nullptr, nullptr, nullptr));
  PetscCall(SNESSetInitialFunction(snes_.get(), residual_.get()));
  PetscCall(SNESSolve(snes_.get(), nullptr, solution_.get()));
  // Our own line search leaves the solution with the blocks; others leave it in the Vec alone.
  bool admissible = true;
  if (!current_) PetscCall(renew(solution_.get(), nullptr, admissible));
  PetscInt taken = 0;
  PetscCall(SNESGetIterationNumber(snes_.get(), &taken));
  iterations = static_cast<int>(taken);
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode BatchSolver::renew(Vec x, Vec f, bool& admissible) {
  PetscFunctionBegin;
  PetscCall(evaluate(x, f, admissible));
  current_ = x == solution_.get();
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode BatchSolver::form_function(SNES snes, Vec x, Vec f, void* context) {
  PetscFunctionBegin;
  auto& self = *static_cast<BatchSolver*>(context);
  bool admissible = true;
  PetscCall(self.renew(x, f, admissible));
  self.blockwise_ = false;
  if (!admissible) PetscCall(SNESSetFunctionDomainError(snes));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode BatchSolver::form_jacobian(SNES, Vec x, Mat, Mat preconditioner, void* context) {
  PetscFunctionBegin;
  auto& self = *static_cast<BatchSolver*>(context);
  // Tangents come with the residual. The last point that another line search has tried need not be the one it
  // took.
  bool admissible = true;
  if (!self.blockwise_ || !self.current_) PetscCall(self.renew(x, nullptr, admissible));
  PetscBool shell = PETSC_FALSE;
  PetscCall(PetscObjectTypeCompare((PetscObject)preconditioner, MATSHELL, &shell));
  if (!shell) PetscCall(self.assemble(preconditioner));
  PetscCall(MatAssemblyBegin(preconditioner, MAT_FINAL_ASSEMBLY));
  PetscCall(MatAssemblyEnd(preconditioner, MAT_FINAL_ASSEMBLY));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode BatchSolver::apply_jacobian(Mat jacobian, Vec x, Vec y) {
  PetscFunctionBegin;
  void* context = nullptr;
  PetscCall(MatShellGetContext(jacobian, &context));
  const PetscScalar* in = nullptr;
  PetscScalar* out = nullptr;
  PetscCall(VecCopy(x, y));
  PetscCall(VecGetArrayRead(x, &in));
  PetscCall(VecGetArray(y, &out));
  static_cast<BatchSolver*>(context)->multiply(in, out);
  PetscCall(VecRestoreArray(y, &out));
  PetscCall(VecRestoreArrayRead(x, &in));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode BatchSolver::apply_inverse(PC preconditioner, Vec x, Vec y) {
  PetscFunctionBegin;
  void* context = nullptr;
  PetscCall(PCShellGetContext(preconditioner, &context));
  auto& self = *static_cast<BatchSolver*>(context);
  const PetscScalar* in = nullptr;
  PetscScalar* out = nullptr;
  // Rows that belong to no open block pass through.
  if (!self.own_inverse_) PetscCall(VecCopy(x, y));
  PetscCall(VecGetArrayRead(x, &in));
  PetscCall(VecGetArray(y, &out));
  self.invert(in, out);
  PetscCall(VecRestoreArray(y, &out));
  PetscCall(VecRestoreArrayRead(x, &in));
  PetscFunctionReturn(PETSC_SUCCESS);
}

// The line search: each open block takes its own step.
PetscErrorCode BatchSolver::advance(SNESLineSearch search, void* context) {
  PetscFunctionBegin;
  auto& self = *static_cast<BatchSolver*>(context);
  Vec x = nullptr, f = nullptr, y = nullptr;
  PetscCall(SNESLineSearchGetVecs(search, &x, &f, &y, nullptr, nullptr));
  const PetscScalar* direction = nullptr;
  PetscScalar *iterate = nullptr, *residual = nullptr;
  Totals totals;
  PetscCall(VecGetArrayRead(y, &direction));
  PetscCall(VecGetArray(x, &iterate));
  PetscCall(VecGetArray(f, &residual));
  self.step(direction, iterate, residual, totals);
  PetscCall(VecRestoreArray(f, &residual));
  PetscCall(VecRestoreArray(x, &iterate));
  PetscCall(VecRestoreArrayRead(y, &direction));
  self.current_ = true;
  self.blockwise_ = true;
  PetscCall(self.add_over_ranks(totals));
  self.open_ = totals.open;
  PetscCall(
      SNESLineSearchSetNorms(search, 1, std::sqrt(totals.residual_square), std::sqrt(totals.step_square)));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode BatchSolver::converged(SNES snes, PetscInt iteration, PetscReal, PetscReal, PetscReal,
                                      SNESConvergedReason* reason, void* context) {
  PetscFunctionBegin;
  auto& self = *static_cast<BatchSolver*>(context);
  if (!self.blockwise_ && iteration > 0) {
    Vec x = nullptr;
    bool admissible = true;
    Totals totals;
    PetscCall(SNESGetSolution(snes, &x));
    if (!self.current_) PetscCall(self.renew(x, nullptr, admissible));
    self.close_small_steps(totals);
    PetscCall(self.add_over_ranks(totals));
    self.open_ = totals.open;
  }
  *reason = self.open_ == 0 ? SNES_CONVERGED_FNORM_ABS : SNES_CONVERGED_ITERATING;
  PetscFunctionReturn(PETSC_SUCCESS);
}

}  // namespace gaiter::solvers
