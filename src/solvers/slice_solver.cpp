// SPDX-License-Identifier: BSD-2-Clause
#include "gaiter/solvers/slice_solver.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "gaiter/petsc/check.hpp"
#include "gaiter/physics/slice_kernel.hpp"

namespace gaiter::solvers {

namespace {

using physics::Pack;
using physics::pack_width;
using physics::PackState;

constexpr int newton_steps = 80;
constexpr int fixed_point_steps = 2000;
constexpr double sparse = 0.5;  // part of the packs' slices that are open, below which these are gathered

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
  int open = 0;  // a sum of doubles would be taken one by one
  for (int i = 0; i < pack_width; ++i) open += state.open[i] > 0;
  return open;
}

// A state is an array of packs, one a quantity.
constexpr std::size_t state_rows = sizeof(PackState) / sizeof(Pack);

void copy_slice(const PackState& from, int i, PackState& to, int j) {
  const Pack* source = reinterpret_cast<const Pack*>(&from);
  Pack* target = reinterpret_cast<Pack*>(&to);
  for (std::size_t row = 0; row < state_rows; ++row) target[row][j] = source[row][i];
}

}  // namespace

SliceSolver::SliceSolver(MPI_Comm comm, std::size_t packs, model::SliceSolver algorithm,
                         double fixed_point_tolerance, double newton_tolerance)
    : packs_(packs),
      newton_(algorithm == model::SliceSolver::newton),
      fixed_point_tolerance_(fixed_point_tolerance) {
  petsc::check(create(comm, newton_tolerance));
}

PetscErrorCode SliceSolver::create(MPI_Comm comm, double newton_tolerance) {
  PetscFunctionBegin;
  PetscReal given = 0;
  PetscBool found = PETSC_FALSE;
  PetscCall(PetscOptionsGetReal(nullptr, "slice_", "-snes_rtol", &given, &found));
  tolerance_given_ = found == PETSC_TRUE;
  PetscCall(create_matrix(comm));
  PetscCall(BatchSolver::create(
      comm, static_cast<PetscInt>(2 * pack_width * packs_),
      {"slice_", newton_ ? SNESNEWTONLS : SNESNRICHARDSON, newton_tolerance,
       newton_ ? newton_steps : fixed_point_steps, 2, "inverse of the 2 x 2 block of each slice"}));
  PetscFunctionReturn(PETSC_SUCCESS);
}

// A matrix with entries, where the options ask for one.
PetscErrorCode SliceSolver::create_matrix(MPI_Comm comm) {
  PetscFunctionBegin;
  const PetscInt rows = static_cast<PetscInt>(2 * pack_width * packs_);
  // Differences of the residual need entries to go to.
  PetscBool by_differences = PETSC_FALSE;
  PetscCall(PetscOptionsGetBool(nullptr, "slice_", "-snes_fd", &by_differences, nullptr));
  char type[64] = MATSHELL;
  if (by_differences) PetscCall(PetscStrncpy(type, MATAIJ, sizeof type));
  PetscCall(PetscOptionsGetString(nullptr, "slice_", "-mat_type", type, sizeof type, nullptr));
  PetscBool shell = PETSC_FALSE;
  PetscCall(PetscStrcmp(type, MATSHELL, &shell));
  if (shell) PetscFunctionReturn(PETSC_SUCCESS);
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
  PetscFunctionReturn(PETSC_SUCCESS);
}

SliceReport SliceSolver::solve(const physics::SliceSystem& system, std::vector<PackState>& states,
                               const Start& start, FirstResidual first) {
  system_ = &system;
  states_ = &states;
  SliceReport report;
  petsc::check(run(start, first, report));
  return report;
}

PetscErrorCode SliceSolver::run(const Start& start, FirstResidual first, SliceReport& report) {
  PetscFunctionBegin;
  // The first residual is taken pack by pack with the start, while its constants are at hand.
  PetscScalar *iterate = nullptr, *residual = nullptr;
  PetscCall(VecGetArrayWrite(solution_.get(), &iterate));
  PetscCall(VecGetArrayWrite(residual_.get(), &residual));
  Totals totals;
  work_.clear();
  for (std::size_t k = 0; k < states_->size(); ++k) {
    PackState& state = (*states_)[k];
    start(k);
    const std::size_t place = 2 * pack_width * k;
    const double open = count_open(state);
    if (open > 0) {
      work_.push_back({system_->pack(k), &state, pack_width * k, nullptr, pack_width});
      if (first == FirstResidual::evaluated)
        physics::evaluate_open(system_->shape(), system_->pack(k), state);
      write_pairs(state.strain_residual, state.pressure_residual, residual + place);
    } else {
      std::fill_n(residual + place, 2 * pack_width, 0.0);
    }
    write_pairs(state.strain, state.pressure, iterate + place);
    totals.open += open;
  }
  PetscInt size = 0;
  PetscCall(VecGetLocalSize(solution_.get(), &size));
  for (PetscInt i = 2 * pack_width * states_->size(); i < size; ++i) iterate[i] = residual[i] = 0;
  PetscCall(VecRestoreArrayWrite(residual_.get(), &residual));
  PetscCall(VecRestoreArrayWrite(solution_.get(), &iterate));
  gathered_.from.clear();
  PetscCall(solve_open(totals, report.iterations));
  put_back();
  report.unsolved = open_;
  PetscFunctionReturn(PETSC_SUCCESS);
}

// Residuals and slopes of all slices at x; of the padding beyond the system they stay 0.
PetscErrorCode SliceSolver::evaluate(Vec x, Vec f, bool&) {
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
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode SliceSolver::assemble(Mat jacobian) {
  PetscFunctionBegin;
  PetscInt first = 0, last = 0;
  PetscCall(MatGetOwnershipRange(jacobian, &first, &last));
  for (PetscInt row = first / 2; row < last / 2; ++row) {
    const std::size_t slice = row - first / 2, pack = slice / pack_width, place = slice % pack_width;
    const bool padding = pack >= states_->size();
    const PetscScalar block[4] = {1, padding ? 0 : -(*states_)[pack].strain_slope[place],
                                  padding ? 0 : -(*states_)[pack].bandage_slope[place], 1};
    PetscCall(MatSetValuesBlocked(jacobian, 1, &row, 1, &row, block, INSERT_VALUES));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

void SliceSolver::multiply(const PetscScalar* in, PetscScalar* out) {
  for (std::size_t k = 0; k < states_->size(); ++k)
    for (int i = 0; i < pack_width; ++i) {
      const std::size_t place = 2 * (pack_width * k + i);
      out[place] -= (*states_)[k].strain_slope[i] * in[place + 1];
      out[place + 1] -= (*states_)[k].bandage_slope[i] * in[place];
    }
}

void SliceSolver::invert(const PetscScalar* in, PetscScalar* out) {
  Pack strain_residual, pressure_residual, strain, pressure;
  for (const Work& work : work_) {
    if (work.from) {
      for (int i = 0; i < pack_width; ++i) {
        strain_residual[i] = in[2 * work.slice(i)];
        pressure_residual[i] = in[2 * work.slice(i) + 1];
      }
    } else {
      read_pairs(in + 2 * work.first, strain_residual, pressure_residual);
    }
    physics::solve_blocks(work.state->strain_slope, work.state->bandage_slope, strain_residual,
                          pressure_residual, strain, pressure);
    if (!work.from) write_pairs(strain, pressure, out + 2 * work.first);
    for (int i = 0; work.from && i < work.count; ++i) {
      out[2 * work.slice(i)] = strain[i];
      out[2 * work.slice(i) + 1] = pressure[i];
    }
  }
}

void SliceSolver::step(const PetscScalar* direction, PetscScalar* iterate, PetscScalar* residual,
                       Totals& totals) {
  Pack unused, pressure, before, residual_square{}, step_square{};
  std::size_t left = 0;  // packs that are still open move to the front
  for (const Work& work : work_) {
    PackState& state = *work.state;
    before = state.pressure;
    if (work.from)
      for (int i = 0; i < pack_width; ++i) pressure[i] = direction[2 * work.slice(i) + 1];
    else
      read_pairs(direction + 2 * work.first, unused, pressure);
    if (newton_)
      physics::advance_newton(system_->shape(), work.rows, pressure, tolerance_, state);
    else
      physics::advance_fixed_point(system_->shape(), work.rows, pressure, fixed_point_tolerance_, state);
    if (!work.from) {
      write_pairs(state.strain, state.pressure, iterate + 2 * work.first);
      write_pairs(state.strain_residual, state.pressure_residual, residual + 2 * work.first);
    }
    for (int i = 0; i < pack_width; ++i) {
      const double change = state.pressure[i] - before[i];
      residual_square[i] += state.open[i] * state.pressure_residual[i] * state.pressure_residual[i];
      step_square[i] += change * change;
    }
    for (int i = 0; work.from && i < work.count; ++i) {
      const std::size_t place = 2 * work.slice(i);
      iterate[place] = state.strain[i];
      iterate[place + 1] = state.pressure[i];
      residual[place] = state.strain_residual[i];
      residual[place + 1] = state.pressure_residual[i];
    }
    const double open = count_open(state);
    totals.open += open;
    if (open > 0) work_[left++] = work;
  }
  for (int i = 0; i < pack_width; ++i) {
    totals.residual_square += residual_square[i];
    totals.step_square += step_square[i];
  }
  work_.resize(left);
  if (own_inverse_ && left > 1 && totals.open < sparse * pack_width * static_cast<double>(left))
    gather_open();
}

// Open slices into packs of their own.
void SliceSolver::gather_open() {
  std::vector<std::size_t> open;
  for (const Work& work : work_)
    for (int i = 0; i < work.count; ++i)
      if (work.state->open[i] > 0) open.push_back(work.slice(i));
  put_back();
  const std::size_t packs = (open.size() + pack_width - 1) / pack_width, rows = system_->rows_per_pack();
  gathered_.rows.resize(packs * rows);
  gathered_.states.resize(packs);
  gathered_.from = std::move(open);
  gathered_.count = gathered_.from.size();
  gathered_.from.resize(packs * pack_width, gathered_.from.back());
  work_.clear();
  for (std::size_t k = 0; k < packs; ++k) {
    const std::size_t first = k * pack_width;
    Pack* constants = gathered_.rows.data() + k * rows;
    system_->gather(std::span(gathered_.from).subspan(first, pack_width), constants);
    for (int i = 0; i < pack_width; ++i) {
      const std::size_t slice = gathered_.from[first + i];
      copy_slice((*states_)[slice / pack_width], slice % pack_width, gathered_.states[k], i);
      // The spare places of the last pack repeat its last slice, closed.
      if (first + i >= gathered_.count) gathered_.states[k].open[i] = 0;
    }
    work_.push_back({constants, &gathered_.states[k], 0, gathered_.from.data() + first,
                     static_cast<int>(std::min<std::size_t>(pack_width, gathered_.count - first))});
  }
}

void SliceSolver::put_back() {
  for (std::size_t j = 0; j < gathered_.from.size() && j < gathered_.count; ++j) {
    const std::size_t slice = gathered_.from[j];
    copy_slice(gathered_.states[j / pack_width], j % pack_width, (*states_)[slice / pack_width],
               slice % pack_width);
  }
  gathered_.from.clear();
}

void SliceSolver::close_small_steps(Totals& totals) {
  Pack strain, pressure;
  const double tolerance = physics::reachable(system_->shape(), tolerance_);
  for (PackState& state : *states_) {
    physics::solve_blocks(state.strain_slope, state.bandage_slope, state.strain_residual,
                          state.pressure_residual, strain, pressure);
    for (int i = 0; i < pack_width; ++i) {
      if (state.open[i] > 0) {
        state.left[i] = std::fabs(pressure[i]);
        state.settled_slope[i] = state.bandage_slope[i];
      }
      const double enough = std::max(tolerance, state.may_leave[i]);
      if (std::fabs(pressure[i]) <= enough * std::fabs(state.pressure[i])) state.open[i] = 0;
      state.iterations[i] += state.open[i];
    }
    totals.open += count_open(state);
  }
}

}  // namespace gaiter::solvers
