// SPDX-License-Identifier: BSD-2-Clause
#pragma once

#include <vector>

#include "gaiter/physics/sliding_newton.hpp"
#include "gaiter/solvers/batch_solver.hpp"

namespace gaiter::solvers {

// How the sliding segments of all ranks were solved.
struct SlidingReport {
  int iterations = 0;   // of the SNES
  double unsolved = 0;  // segments, over all ranks, that failed or were still open at the end
};

// The equilibria of many sliding segments as one SNES over a distributed Vec. A rank holds packs of 64
// segments; a pack's part of the Vec is its 2n rows of 64 numbers in the order of
// physics::SlidingState::unknown, so that each segment is a banded system of its own. A shell preconditioner
// factorises and solves 64 of them at a time.
//
// Options (prefix sliding_): -sliding_snes_rtol is the relative size of a segment's next step at which it
// closes, -sliding_snes_max_it bounds the steps; every option of SNES, KSP and PC, other line searches and
// SNES types among them, which then damp globally.
class SlidingSolver : public BatchSolver {
 public:
  // @note Collective. `packs`: packs of 64 segments that this rank will hand to solve().
  SlidingSolver(MPI_Comm comm, std::size_t packs, int slices);

  // @note Collective. `states`, a pack each, hold the started iterates and take the solution. Segments that
  // are not open stay as they are.
  SlidingReport solve(const physics::SlidingSystem& system, std::vector<physics::SlidingState>& states);

 private:
  PetscErrorCode run(SlidingReport& report);
  PetscErrorCode evaluate(Vec x, Vec f, bool& admissible) override;
  PetscErrorCode assemble(Mat jacobian) override;
  void multiply(const PetscScalar* in, PetscScalar* out) override;
  void invert(const PetscScalar* in, PetscScalar* out) override;
  void step(const PetscScalar* direction, PetscScalar* iterate, PetscScalar* residual,
            Totals& totals) override;
  void close_small_steps(Totals& totals) override;
  std::size_t pack_rows() const { return 2 * static_cast<std::size_t>(slices_); }
  std::size_t pack_size() const { return pack_rows() * physics::pack_width; }

  int slices_;
  std::vector<physics::Pack> right_, left_;  // a pack's part of a Vec, aligned
  const physics::SlidingSystem* system_ = nullptr;
  std::vector<physics::SlidingState>* states_ = nullptr;
};

}  // namespace gaiter::solvers
