// SPDX-License-Identifier: BSD-2-Clause
#include "gaiter/solvers/sliding_solver.hpp"

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
  petsc::check(create(comm, static_cast<PetscInt>(pack_size() * packs),
                      {"sliding_", SNESNEWTONLS, newton_tolerance, newton_steps, 1,
                       "factors of the banded system of each segment"}));
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
  int iterations = 0;
  PetscCall(solve_open(totals, iterations));
  totals = {};
  for (SlidingState& state : *states_)
    for (int i = 0; i < pack_width; ++i) {
      if (state.open[i] > 0) state.failed[i] = 1;
      totals.failed += state.failed[i];
    }
  PetscCall(add_over_ranks(totals));
  report = {iterations, totals.failed};
  PetscFunctionReturn(PETSC_SUCCESS);
}

// Tangents of all segments at x. What is not solved for must not spoil the norm of the residual.
PetscErrorCode SlidingSolver::evaluate(Vec x, Vec f, bool& admissible) {
  PetscFunctionBegin;
  const PetscScalar* iterate = nullptr;
  PetscScalar* residual = nullptr;
  PetscCall(VecGetArrayRead(x, &iterate));
  if (f) PetscCall(VecGetArrayWrite(f, &residual));
  for (std::size_t k = 0; k < states_->size(); ++k) {
    SlidingState& state = (*states_)[k];
    read(iterate + k * pack_size(), state.unknown);
    physics::evaluate_sliding(*system_, k, state.unknown, state.tangent);
    if (residual) write(state.tangent.residual, residual + k * pack_size());
    for (int i = 0; i < pack_width; ++i) {
      if (state.open[i] > 0 && !(state.tangent.admissible[i] > 0)) admissible = false;
      for (std::size_t row = 0; residual && !(state.open[i] > 0) && row < pack_rows(); ++row)
        residual[k * pack_size() + row * pack_width + i] = 0;
    }
  }
  if (f) PetscCall(VecRestoreArrayWrite(f, &residual));
  PetscCall(VecRestoreArrayRead(x, &iterate));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode SlidingSolver::assemble(Mat) {
  return PETSC_ERR_SUP;  // the matrix is always a shell
}

void SlidingSolver::multiply(const PetscScalar* in, PetscScalar* out) {
  for (std::size_t k = 0; k < states_->size(); ++k) {
    read(in + k * pack_size(), right_);
    physics::multiply_sliding(*system_, k, (*states_)[k].tangent, right_, left_);
    write(left_, out + k * pack_size());
  }
}

void SlidingSolver::invert(const PetscScalar* in, PetscScalar* out) {
  for (std::size_t k = 0; k < states_->size(); ++k) {
    SlidingState& state = (*states_)[k];
    if (count_open(state) == 0) continue;
    Pack negative;
    read(in + k * pack_size(), right_);
    physics::solve_sliding_tangent(*system_, k, state.tangent, right_, left_, negative);
    for (int i = 0; i < pack_width; ++i)
      if (state.open[i] > 0) state.negative[i] = negative[i];
    write(left_, out + k * pack_size());
  }
}

void SlidingSolver::step(const PetscScalar* direction, PetscScalar* iterate, PetscScalar* residual,
                         Totals& totals) {
  for (std::size_t k = 0; k < states_->size(); ++k) {
    SlidingState& state = (*states_)[k];
    if (count_open(state) == 0) continue;
    read(direction + k * pack_size(), left_);
    physics::advance_sliding(*system_, k, left_, tolerance_, state);
    write(state.unknown, iterate + k * pack_size());
    write(state.tangent.residual, residual + k * pack_size());
    totals.open += count_open(state);
    for (const Pack& row : state.tangent.residual)
      for (int i = 0; i < pack_width; ++i) totals.residual_square += state.open[i] > 0 ? row[i] * row[i] : 0;
  }
  totals.step_square = 1;  // unknowns of several units have no common norm
}

void SlidingSolver::close_small_steps(Totals& totals) {
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
    totals.open += count_open(state);
  }
}

}  // namespace gaiter::solvers
