// SPDX-License-Identifier: BSD-2-Clause
#include "gaiter/solvers/slice_solver.hpp"

#include <petscdmshell.h>

#include <cmath>

#include "gaiter/petsc/check.hpp"
#include "gaiter/physics/slice_kernel.hpp"

namespace gaiter::solvers {

namespace {

using physics::Pack;
using physics::pack_width;
using physics::PackState;

constexpr double newton_tolerance = 1e-12;
constexpr int newton_steps = 80;
constexpr int fixed_point_steps = 2000;

// A pack's part of a Vec: (strain, pressure) of each slice in turn.
void read_pairs(const PetscScalar* pairs, Pack& first, Pack& second) {
  for (int i = 0; i < pack_width; ++i) {
    first[i] = pairs[2 * i];
    second[i] = pairs[2 * i + 1];
  }
}

void write_pairs(const Pack& first, const Pack& second, PetscScalar* pairs) {
  for (int i = 0; i < pack_width; ++i) {
    pairs[2 * i] = first[i];
    pairs[2 * i + 1] = second[i];
  }
}

double count_open(const PackState& state) {
  double open = 0;
  for (int i = 0; i < pack_width; ++i) open += state.open[i];
  return open;
}

}  // namespace

SliceSolver::SliceSolver(MPI_Comm comm, std::size_t packs, model::SliceSolver algorithm,
                         double fixed_point_tolerance)
    : newton_(algorithm == model::SliceSolver::newton), fixed_point_tolerance_(fixed_point_tolerance) {
  petsc::check(create(comm, packs));
}

PetscErrorCode SliceSolver::create(MPI_Comm comm, std::size_t packs) {
  PetscFunctionBegin;
  const PetscInt rows = static_cast<PetscInt>(2 * pack_width * packs);
  PetscCall(VecCreate(comm, solution_.out()));
  PetscCall(VecSetSizes(solution_.get(), rows, PETSC_DETERMINE));
  PetscCall(VecSetBlockSize(solution_.get(), 2));
  PetscCall(VecSetType(solution_.get(), VECSTANDARD));
  PetscCall(VecSet(solution_.get(), 0));
  PetscCall(VecDuplicate(solution_.get(), residual_.out()));

  PetscCall(SNESCreate(comm, snes_.out()));
  SNES snes = snes_.get();
  PetscCall(SNESSetOptionsPrefix(snes, "slice_"));
  PetscCall(SNESSetFunction(snes, residual_.get(), form_function, this));
  PetscCall(create_matrix(comm, rows));
  PetscCall(SNESSetJacobian(snes, jacobian_.get(), jacobian_.get(), form_jacobian, this));
  PetscCall(SNESSetType(snes, newton_ ? SNESNEWTONLS : SNESNRICHARDSON));
  PetscCall(SNESSetTolerances(snes, PETSC_DEFAULT, newton_tolerance, PETSC_DEFAULT,
                              newton_ ? newton_steps : fixed_point_steps, PETSC_DEFAULT));
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
  PetscCall(PCSetType(pc, assembled_ ? PCPBJACOBI : PCSHELL));
  if (!assembled_) {
    PetscCall(PCShellSetContext(pc, this));
    PetscCall(PCShellSetApply(pc, invert));
    PetscCall(PCShellSetName(pc, "inverse of the 2 x 2 block of each slice"));
  }
  PetscCall(SNESSetFromOptions(snes));
  // The trust region asks the SNES's shell DM for its work vectors before there is a solution to copy.
  DM shell = nullptr;
  PetscCall(SNESGetDM(snes, &shell));
  PetscCall(DMShellSetGlobalVector(shell, solution_.get()));
  PetscCall(SNESSetUp(snes));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode SliceSolver::create_matrix(MPI_Comm comm, PetscInt rows) {
  PetscFunctionBegin;
  // Differences of the residual need entries to go to.
  PetscBool by_differences = PETSC_FALSE;
  PetscCall(PetscOptionsGetBool(nullptr, "slice_", "-snes_fd", &by_differences, nullptr));
  char type[64] = MATSHELL;
  if (by_differences) PetscCall(PetscStrncpy(type, MATAIJ, sizeof type));
  PetscCall(PetscOptionsGetString(nullptr, "slice_", "-mat_type", type, sizeof type, nullptr));
  PetscBool shell = PETSC_FALSE;
  PetscCall(PetscStrcmp(type, MATSHELL, &shell));
  assembled_ = !shell;
  if (assembled_) {
    PetscCall(MatCreate(comm, jacobian_.out()));
    PetscCall(MatSetOptionsPrefix(jacobian_.get(), "slice_"));
    PetscCall(MatSetSizes(jacobian_.get(), rows, rows, PETSC_DETERMINE, PETSC_DETERMINE));
    PetscCall(MatSetBlockSize(jacobian_.get(), 2));
    PetscCall(MatSetFromOptions(jacobian_.get()));
    PetscCall(MatXAIJSetPreallocation(jacobian_.get(), 2, nullptr, nullptr, nullptr, nullptr));
    PetscCall(MatSeqBAIJSetPreallocation(jacobian_.get(), 2, 1, nullptr));
    PetscCall(MatMPIBAIJSetPreallocation(jacobian_.get(), 2, 1, nullptr, 0, nullptr));
    PetscCall(MatSeqAIJSetPreallocation(jacobian_.get(), 2, nullptr));
    PetscCall(MatMPIAIJSetPreallocation(jacobian_.get(), 2, nullptr, 0, nullptr));
  } else {
    PetscCall(MatCreateShell(comm, rows, rows, PETSC_DETERMINE, PETSC_DETERMINE, this, jacobian_.out()));
    PetscCall(MatShellSetOperation(jacobian_.get(), MATOP_MULT, reinterpret_cast<void (*)(void)>(multiply)));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

SliceReport SliceSolver::solve(const physics::SliceSystem& system, std::vector<PackState>& states,
                               const Start& start) {
  system_ = &system;
  states_ = &states;
  SliceReport report;
  petsc::check(run(start, report));
  return report;
}

PetscErrorCode SliceSolver::run(const Start& start, SliceReport& report) {
  PetscFunctionBegin;
  // The first residual is taken pack by pack with the start, while its constants are at hand.
  PetscScalar *iterate = nullptr, *residual = nullptr;
  PetscCall(VecGetArrayWrite(solution_.get(), &iterate));
  PetscCall(VecGetArrayWrite(residual_.get(), &residual));
  for (std::size_t k = 0; k < states_->size(); ++k) {
    PackState& state = (*states_)[k];
    start(k);
    physics::evaluate_residual(system_->shape(), system_->pack(k), state);
    write_pairs(state.strain, state.pressure, iterate + 2 * pack_width * k);
    write_pairs(state.strain_residual, state.pressure_residual, residual + 2 * pack_width * k);
  }
  PetscInt size = 0;
  PetscCall(VecGetLocalSize(solution_.get(), &size));
  for (PetscInt i = 2 * pack_width * states_->size(); i < size; ++i) iterate[i] = residual[i] = 0;
  PetscCall(VecRestoreArrayWrite(residual_.get(), &residual));
  PetscCall(VecRestoreArrayWrite(solution_.get(), &iterate));
  current_ = true;
  blockwise_ = false;
  PetscCall(SNESGetTolerances(snes_.get(), nullptr, &tolerance_, nullptr, nullptr, nullptr));
  PetscCall(SNESSetInitialFunction(snes_.get(), residual_.get()));
  PetscCall(SNESSolve(snes_.get(), nullptr, solution_.get()));

  // Our own line search leaves the solution in the states; others leave it in the Vec alone.
  const PetscScalar* result = nullptr;
  PetscCall(VecGetArrayRead(solution_.get(), &result));
  for (std::size_t k = 0; !blockwise_ && k < states_->size(); ++k)
    read_pairs(result + 2 * pack_width * k, (*states_)[k].strain, (*states_)[k].pressure);
  PetscCall(VecRestoreArrayRead(solution_.get(), &result));
  PetscInt iterations = 0;
  PetscCall(SNESGetIterationNumber(snes_.get(), &iterations));
  report = {static_cast<int>(iterations), open_};
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode SliceSolver::add_over_ranks(Totals& totals) const {
  PetscFunctionBegin;
  double local[3] = {totals.open, totals.residual_square, totals.step_square}, all[3];
  PetscCallMPI(MPI_Allreduce(local, all, 3, MPI_DOUBLE, MPI_SUM, PetscObjectComm((PetscObject)snes_.get())));
  totals = {all[0], all[1], all[2]};
  PetscFunctionReturn(PETSC_SUCCESS);
}

// Residuals and slopes of all slices at x; of the padding beyond the system they stay 0.
PetscErrorCode SliceSolver::evaluate(Vec x, Vec f) {
  PetscFunctionBegin;
  const PetscScalar* iterate = nullptr;
  PetscScalar* residual = nullptr;
  PetscCall(VecGetArrayRead(x, &iterate));
  if (f) PetscCall(VecGetArrayWrite(f, &residual));
  for (std::size_t k = 0; k < states_->size(); ++k) {
    PackState& state = (*states_)[k];
    const std::size_t place = 2 * pack_width * k;
    read_pairs(iterate + place, state.strain, state.pressure);
    physics::evaluate_residual(system_->shape(), system_->pack(k), state);
    if (residual) write_pairs(state.strain_residual, state.pressure_residual, residual + place);
  }
  if (f) {
    PetscInt size = 0;
    PetscCall(VecGetLocalSize(f, &size));
    for (PetscInt i = 2 * pack_width * states_->size(); i < size; ++i) residual[i] = 0;
    PetscCall(VecRestoreArrayWrite(f, &residual));
  }
  PetscCall(VecRestoreArrayRead(x, &iterate));
  current_ = x == solution_.get();
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode SliceSolver::form_function(SNES, Vec x, Vec f, void* context) {
  PetscFunctionBegin;
  auto& self = *static_cast<SliceSolver*>(context);
  self.blockwise_ = false;
  PetscCall(self.evaluate(x, f));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode SliceSolver::form_jacobian(SNES, Vec x, Mat, Mat preconditioner, void* context) {
  PetscFunctionBegin;
  auto& self = *static_cast<SliceSolver*>(context);
  // The slopes usually come with the residual; another line search may have left them at a trial point.
  if (!self.current_) PetscCall(self.evaluate(x, nullptr));
  if (self.assembled_) {
    PetscInt first = 0, last = 0;
    PetscCall(MatGetOwnershipRange(preconditioner, &first, &last));
    for (PetscInt row = first / 2; row < last / 2; ++row) {
      const std::size_t slice = row - first / 2, pack = slice / pack_width, place = slice % pack_width;
      const bool padding = pack >= self.states_->size();
      const PetscScalar block[4] = {1, padding ? 0 : -(*self.states_)[pack].strain_slope[place],
                                    padding ? 0 : -(*self.states_)[pack].bandage_slope[place], 1};
      PetscCall(MatSetValuesBlocked(preconditioner, 1, &row, 1, &row, block, INSERT_VALUES));
    }
  }
  PetscCall(MatAssemblyBegin(preconditioner, MAT_FINAL_ASSEMBLY));
  PetscCall(MatAssemblyEnd(preconditioner, MAT_FINAL_ASSEMBLY));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode SliceSolver::multiply(Mat jacobian, Vec x, Vec y) {
  PetscFunctionBegin;
  void* context = nullptr;
  PetscCall(MatShellGetContext(jacobian, &context));
  const auto& states = *static_cast<SliceSolver*>(context)->states_;
  const PetscScalar* in = nullptr;
  PetscScalar* out = nullptr;
  PetscCall(VecCopy(x, y));
  PetscCall(VecGetArrayRead(x, &in));
  PetscCall(VecGetArray(y, &out));
  for (std::size_t k = 0; k < states.size(); ++k)
    for (int i = 0; i < pack_width; ++i) {
      const std::size_t place = 2 * (pack_width * k + i);
      out[place] -= states[k].strain_slope[i] * in[place + 1];
      out[place + 1] -= states[k].bandage_slope[i] * in[place];
    }
  PetscCall(VecRestoreArray(y, &out));
  PetscCall(VecRestoreArrayRead(x, &in));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode SliceSolver::invert(PC preconditioner, Vec x, Vec y) {
  PetscFunctionBegin;
  void* context = nullptr;
  PetscCall(PCShellGetContext(preconditioner, &context));
  const auto& states = *static_cast<SliceSolver*>(context)->states_;
  const PetscScalar* in = nullptr;
  PetscScalar* out = nullptr;
  PetscCall(VecGetArrayRead(x, &in));
  PetscCall(VecGetArrayWrite(y, &out));
  Pack strain_residual, pressure_residual, strain, pressure;
  for (std::size_t k = 0; k < states.size(); ++k) {
    const std::size_t place = 2 * pack_width * k;
    read_pairs(in + place, strain_residual, pressure_residual);
    physics::solve_blocks(states[k].strain_slope, states[k].bandage_slope, strain_residual, pressure_residual,
                          strain, pressure);
    write_pairs(strain, pressure, out + place);
  }
  PetscInt size = 0;
  PetscCall(VecGetLocalSize(y, &size));
  for (PetscInt i = 2 * pack_width * states.size(); i < size; ++i) out[i] = in[i];
  PetscCall(VecRestoreArrayWrite(y, &out));
  PetscCall(VecRestoreArrayRead(x, &in));
  PetscFunctionReturn(PETSC_SUCCESS);
}

// The line search: each open slice takes its own step, and its residual and slopes are renewed on the way.
PetscErrorCode SliceSolver::advance(SNESLineSearch search, void* context) {
  PetscFunctionBegin;
  auto& self = *static_cast<SliceSolver*>(context);
  Vec x = nullptr, f = nullptr, y = nullptr;
  PetscCall(SNESLineSearchGetVecs(search, &x, &f, &y, nullptr, nullptr));
  const PetscScalar* direction = nullptr;
  PetscScalar *iterate = nullptr, *residual = nullptr;
  PetscCall(VecGetArrayRead(y, &direction));
  PetscCall(VecGetArray(x, &iterate));
  PetscCall(VecGetArray(f, &residual));
  Totals totals;
  for (std::size_t k = 0; k < self.states_->size(); ++k) {
    PackState& state = (*self.states_)[k];
    if (count_open(state) == 0) continue;
    const std::size_t place = 2 * pack_width * k;
    Pack unused, pressure, before = state.pressure;
    read_pairs(direction + place, unused, pressure);
    if (self.newton_)
      physics::advance_newton(self.system_->shape(), self.system_->pack(k), pressure, self.tolerance_, state);
    else
      physics::advance_fixed_point(self.system_->shape(), self.system_->pack(k), pressure,
                                   self.fixed_point_tolerance_, state);
    write_pairs(state.strain, state.pressure, iterate + place);
    write_pairs(state.strain_residual, state.pressure_residual, residual + place);
    for (int i = 0; i < pack_width; ++i) {
      const double step = state.pressure[i] - before[i];
      totals.open += state.open[i];
      totals.residual_square += state.open[i] * state.pressure_residual[i] * state.pressure_residual[i];
      totals.step_square += step * step;
    }
  }
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

// After a step that another line search or solver has taken: slices whose next Newton step is small enough
// close.
PetscErrorCode SliceSolver::close_where_converged(SNES snes) {
  PetscFunctionBegin;
  Vec x = nullptr;
  PetscCall(SNESGetSolution(snes, &x));
  if (!current_) PetscCall(evaluate(x, nullptr));
  Pack strain, pressure;
  for (PackState& state : *states_) {
    physics::solve_blocks(state.strain_slope, state.bandage_slope, state.strain_residual,
                          state.pressure_residual, strain, pressure);
    for (int i = 0; i < pack_width; ++i)
      if (std::fabs(pressure[i]) <= tolerance_ * std::fabs(state.pressure[i])) state.open[i] = 0;
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode SliceSolver::converged(SNES snes, PetscInt iteration, PetscReal, PetscReal, PetscReal,
                                      SNESConvergedReason* reason, void* context) {
  PetscFunctionBegin;
  auto& self = *static_cast<SliceSolver*>(context);
  if (!self.blockwise_) {
    if (iteration > 0) {
      PetscCall(self.close_where_converged(snes));
      for (PackState& state : *self.states_)
        for (int i = 0; i < pack_width; ++i) state.iterations[i] += state.open[i];
    }
    Totals totals;
    for (const PackState& state : *self.states_) totals.open += count_open(state);
    PetscCall(self.add_over_ranks(totals));
    self.open_ = totals.open;
  }
  *reason = self.open_ == 0 ? SNES_CONVERGED_FNORM_ABS : SNES_CONVERGED_ITERATING;
  PetscFunctionReturn(PETSC_SUCCESS);
}

}  // namespace gaiter::solvers
