// SPDX-License-Identifier: BSD-2-Clause
#include "gaiter/solvers/sliding_solver.hpp"

#include <petscdmshell.h>

#include <cmath>
#include <cstring>

#include "gaiter/petsc/check.hpp"

namespace gaiter::solvers {

namespace {

using physics::Pack;
using physics::pack_width;
using physics::SlidingState;

constexpr double newton_tolerance = 1e-12;
constexpr int newton_steps = 60;

// A pack's part of a Vec, which need not be aligned.
void read(const PetscScalar* part, std::vector<Pack>& rows) {
  std::memcpy(rows.data(), part, rows.size() * sizeof(Pack));
}

void write(const std::vector<Pack>& rows, PetscScalar* part) {
  std::memcpy(part, rows.data(), rows.size() * sizeof(Pack));
}

double count_open(const SlidingState& state) {
  double open = 0;
  for (int i = 0; i < pack_width; ++i) open += state.open[i];
  return open;
}

}  // namespace

SlidingSolver::SlidingSolver(MPI_Comm comm, std::size_t packs, int slices)
    : slices_(slices), right_(pack_rows()), left_(pack_rows()) {
  petsc::check(create(comm, packs));
}

PetscErrorCode SlidingSolver::create(MPI_Comm comm, std::size_t packs) {
  PetscFunctionBegin;
  const PetscInt rows = static_cast<PetscInt>(pack_size() * packs);
  PetscCall(VecCreate(comm, solution_.out()));
  PetscCall(VecSetSizes(solution_.get(), rows, PETSC_DETERMINE));
  PetscCall(VecSetType(solution_.get(), VECSTANDARD));
  PetscCall(VecSet(solution_.get(), 0));
  PetscCall(VecDuplicate(solution_.get(), residual_.out()));

  PetscCall(SNESCreate(comm, snes_.out()));
  SNES snes = snes_.get();
  PetscCall(SNESSetOptionsPrefix(snes, "sliding_"));
  PetscCall(SNESSetFunction(snes, residual_.get(), form_function, this));
  PetscCall(MatCreateShell(comm, rows, rows, PETSC_DETERMINE, PETSC_DETERMINE, this, jacobian_.out()));
  PetscCall(MatShellSetOperation(jacobian_.get(), MATOP_MULT, reinterpret_cast<void (*)(void)>(multiply)));
  PetscCall(SNESSetJacobian(snes, jacobian_.get(), jacobian_.get(), form_jacobian, this));
  PetscCall(SNESSetType(snes, SNESNEWTONLS));
  PetscCall(
      SNESSetTolerances(snes, PETSC_DEFAULT, newton_tolerance, PETSC_DEFAULT, newton_steps, PETSC_DEFAULT));
  PetscCall(SNESSetMaxLinearSolveFailures(snes, newton_steps));
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
  PetscCall(PCSetType(pc, PCSHELL));
  PetscCall(PCShellSetContext(pc, this));
  PetscCall(PCShellSetApply(pc, invert));
  PetscCall(PCShellSetName(pc, "factors of the banded system of each segment"));
  PetscCall(SNESSetFromOptions(snes));
  // The trust region asks the SNES's shell DM for its work vectors before there is a solution to copy.
  DM shell = nullptr;
  PetscCall(SNESGetDM(snes, &shell));
  PetscCall(DMShellSetGlobalVector(shell, solution_.get()));
  PetscCall(SNESSetUp(snes));
  PetscFunctionReturn(PETSC_SUCCESS);
}

SlidingReport SlidingSolver::solve(const physics::SlidingSystem& system, std::vector<SlidingState>& states) {
  system_ = &system;
  states_ = &states;
  SlidingReport report;
  petsc::check(run(report));
  return report;
}

PetscErrorCode SlidingSolver::run(SlidingReport& report) {
  PetscFunctionBegin;
  PetscScalar *iterate = nullptr, *residual = nullptr;
  PetscCall(VecGetArrayWrite(solution_.get(), &iterate));
  PetscCall(VecGetArrayWrite(residual_.get(), &residual));
  Totals totals;
  for (std::size_t k = 0; k < states_->size(); ++k) {
    SlidingState& state = (*states_)[k];
    physics::evaluate_sliding(*system_, k, state.unknown, state.tangent);
    write(state.unknown, iterate + k * pack_size());
    write(state.tangent.residual, residual + k * pack_size());
    for (int i = 0; i < pack_width; ++i) {
      if (state.open[i] > 0 && !(state.tangent.admissible[i] > 0)) {
        state.open[i] = 0;
        state.failed[i] = 1;
      }
      if (state.open[i] > 0) continue;
      // What is not solved for must not spoil the norm of the residual.
      for (std::size_t row = 0; row < pack_rows(); ++row)
        residual[k * pack_size() + row * pack_width + i] = 0;
    }
    totals.open += count_open(state);
  }
  PetscCall(VecRestoreArrayWrite(residual_.get(), &residual));
  PetscCall(VecRestoreArrayWrite(solution_.get(), &iterate));
  PetscCall(add_over_ranks(totals));
  open_ = totals.open;
  report = {};
  if (open_ == 0) PetscFunctionReturn(PETSC_SUCCESS);
  current_ = true;
  blockwise_ = true;
  PetscCall(SNESGetTolerances(snes_.get(), nullptr, &tolerance_, nullptr, nullptr, nullptr));
  PetscCall(SNESSetInitialFunction(snes_.get(), residual_.get()));
  PetscCall(SNESSolve(snes_.get(), nullptr, solution_.get()));

  // Our own line search leaves the solution in the states; others leave it in the Vec alone.
  if (!current_) {
    bool admissible = true;
    PetscCall(evaluate(solution_.get(), admissible));
  }
  PetscInt iterations = 0;
  PetscCall(SNESGetIterationNumber(snes_.get(), &iterations));
  totals = {};
  for (SlidingState& state : *states_)
    for (int i = 0; i < pack_width; ++i) {
      if (state.open[i] > 0) state.failed[i] = 1;
      totals.failed += state.failed[i];
    }
  PetscCall(add_over_ranks(totals));
  report = {static_cast<int>(iterations), totals.failed};
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode SlidingSolver::add_over_ranks(Totals& totals) const {
  PetscFunctionBegin;
  double local[3] = {totals.open, totals.failed, totals.residual_square}, all[3];
  PetscCallMPI(MPI_Allreduce(local, all, 3, MPI_DOUBLE, MPI_SUM, PetscObjectComm((PetscObject)snes_.get())));
  totals = {all[0], all[1], all[2]};
  PetscFunctionReturn(PETSC_SUCCESS);
}

// Tangents of all open segments at x.
PetscErrorCode SlidingSolver::evaluate(Vec x, bool& admissible) {
  PetscFunctionBegin;
  const PetscScalar* iterate = nullptr;
  PetscCall(VecGetArrayRead(x, &iterate));
  for (std::size_t k = 0; k < states_->size(); ++k) {
    SlidingState& state = (*states_)[k];
    read(iterate + k * pack_size(), state.unknown);
    physics::evaluate_sliding(*system_, k, state.unknown, state.tangent);
    for (int i = 0; i < pack_width; ++i)
      if (state.open[i] > 0 && !(state.tangent.admissible[i] > 0)) admissible = false;
  }
  PetscCall(VecRestoreArrayRead(x, &iterate));
  current_ = true;
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode SlidingSolver::form_function(SNES snes, Vec x, Vec f, void* context) {
  PetscFunctionBegin;
  auto& self = *static_cast<SlidingSolver*>(context);
  bool admissible = true;
  PetscCall(self.evaluate(x, admissible));
  PetscScalar* residual = nullptr;
  PetscCall(VecGetArrayWrite(f, &residual));
  for (std::size_t k = 0; k < self.states_->size(); ++k) {
    const SlidingState& state = (*self.states_)[k];
    write(state.tangent.residual, residual + k * self.pack_size());
    for (int i = 0; i < pack_width; ++i)
      for (std::size_t row = 0; !(state.open[i] > 0) && row < self.pack_rows(); ++row)
        residual[k * self.pack_size() + row * pack_width + i] = 0;
  }
  PetscCall(VecRestoreArrayWrite(f, &residual));
  self.blockwise_ = false;
  if (!admissible) PetscCall(SNESSetFunctionDomainError(snes));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode SlidingSolver::form_jacobian(SNES, Vec x, Mat, Mat, void* context) {
  PetscFunctionBegin;
  auto& self = *static_cast<SlidingSolver*>(context);
  bool admissible = true;
  // The last point that a global line search has tried need not be the one it took.
  if (!self.blockwise_ || !self.current_) PetscCall(self.evaluate(x, admissible));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode SlidingSolver::multiply(Mat jacobian, Vec x, Vec y) {
  PetscFunctionBegin;
  void* context = nullptr;
  PetscCall(MatShellGetContext(jacobian, &context));
  auto& self = *static_cast<SlidingSolver*>(context);
  const PetscScalar* in = nullptr;
  PetscScalar* out = nullptr;
  PetscCall(VecGetArrayRead(x, &in));
  PetscCall(VecGetArrayWrite(y, &out));
  for (std::size_t k = 0; k < self.states_->size(); ++k) {
    read(in + k * self.pack_size(), self.right_);
    physics::multiply_sliding(*self.system_, k, (*self.states_)[k].tangent, self.right_, self.left_);
    write(self.left_, out + k * self.pack_size());
  }
  PetscCall(VecRestoreArrayWrite(y, &out));
  PetscCall(VecRestoreArrayRead(x, &in));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode SlidingSolver::invert(PC preconditioner, Vec x, Vec y) {
  PetscFunctionBegin;
  void* context = nullptr;
  PetscCall(PCShellGetContext(preconditioner, &context));
  auto& self = *static_cast<SlidingSolver*>(context);
  const PetscScalar* in = nullptr;
  PetscScalar* out = nullptr;
  PetscCall(VecGetArrayRead(x, &in));
  PetscCall(VecGetArrayWrite(y, &out));
  for (std::size_t k = 0; k < self.states_->size(); ++k) {
    SlidingState& state = (*self.states_)[k];
    if (count_open(state) == 0) continue;
    Pack negative;
    read(in + k * self.pack_size(), self.right_);
    physics::solve_sliding_tangent(*self.system_, k, state.tangent, self.right_, self.left_, negative);
    for (int i = 0; i < pack_width; ++i)
      if (state.open[i] > 0) state.negative[i] = negative[i];
    write(self.left_, out + k * self.pack_size());
  }
  PetscCall(VecRestoreArrayWrite(y, &out));
  PetscCall(VecRestoreArrayRead(x, &in));
  PetscFunctionReturn(PETSC_SUCCESS);
}

// The line search: each open segment takes its own step, and its tangent is renewed on the way.
PetscErrorCode SlidingSolver::advance(SNESLineSearch search, void* context) {
  PetscFunctionBegin;
  auto& self = *static_cast<SlidingSolver*>(context);
  Vec x = nullptr, f = nullptr, y = nullptr;
  PetscCall(SNESLineSearchGetVecs(search, &x, &f, &y, nullptr, nullptr));
  const PetscScalar* direction = nullptr;
  PetscScalar *iterate = nullptr, *residual = nullptr;
  PetscCall(VecGetArrayRead(y, &direction));
  PetscCall(VecGetArray(x, &iterate));
  PetscCall(VecGetArray(f, &residual));
  Totals totals;
  for (std::size_t k = 0; k < self.states_->size(); ++k) {
    SlidingState& state = (*self.states_)[k];
    if (count_open(state) == 0) continue;
    read(direction + k * self.pack_size(), self.left_);
    physics::advance_sliding(*self.system_, k, self.left_, self.tolerance_, state);
    write(state.unknown, iterate + k * self.pack_size());
    write(state.tangent.residual, residual + k * self.pack_size());
    totals.open += count_open(state);
    for (const Pack& row : state.tangent.residual)
      for (int i = 0; i < pack_width; ++i) totals.residual_square += state.open[i] > 0 ? row[i] * row[i] : 0;
  }
  PetscCall(VecRestoreArray(f, &residual));
  PetscCall(VecRestoreArray(x, &iterate));
  PetscCall(VecRestoreArrayRead(y, &direction));
  self.current_ = true;
  self.blockwise_ = true;
  PetscCall(self.add_over_ranks(totals));
  self.open_ = totals.open;
  PetscCall(SNESLineSearchSetNorms(search, 1, std::sqrt(totals.residual_square), 1));
  PetscFunctionReturn(PETSC_SUCCESS);
}

// After a step that another line search or solver has taken: segments whose next Newton step would be small
// close.
PetscErrorCode SlidingSolver::close_small_steps(SNES snes) {
  PetscFunctionBegin;
  Vec x = nullptr;
  bool admissible = true;
  PetscCall(SNESGetSolution(snes, &x));
  PetscCall(evaluate(x, admissible));
  for (std::size_t k = 0; k < states_->size(); ++k) {
    SlidingState& state = (*states_)[k];
    Pack negative, size;
    physics::solve_sliding_tangent(*system_, k, state.tangent, state.tangent.residual, left_, negative);
    physics::step_size(*system_, k, state, left_, size);
    for (int i = 0; i < pack_width; ++i) {
      if (!(state.open[i] > 0)) continue;
      state.negative[i] = negative[i];
      state.iterations[i] += 1;
      // The step itself is not taken: its size is the error.
      if (size[i] > tolerance_) continue;
      state.open[i] = 0;
      state.failed[i] = negative[i] > 0 ? 1 : 0;
    }
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode SlidingSolver::converged(SNES snes, PetscInt iteration, PetscReal, PetscReal, PetscReal,
                                        SNESConvergedReason* reason, void* context) {
  PetscFunctionBegin;
  auto& self = *static_cast<SlidingSolver*>(context);
  if (!self.blockwise_ && iteration > 0) {
    PetscCall(self.close_small_steps(snes));
    Totals totals;
    for (const SlidingState& state : *self.states_) totals.open += count_open(state);
    PetscCall(self.add_over_ranks(totals));
    self.open_ = totals.open;
  }
  *reason = self.open_ == 0 ? SNES_CONVERGED_FNORM_ABS : SNES_CONVERGED_ITERATING;
  PetscFunctionReturn(PETSC_SUCCESS);
}

}  // namespace gaiter::solvers
