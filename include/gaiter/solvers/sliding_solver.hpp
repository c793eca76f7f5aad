// SPDX-License-Identifier: BSD-2-Clause
#pragma once

#include <functional>
#include <vector>

#include "gaiter/petsc/handle.hpp"
#include "gaiter/physics/sliding_newton.hpp"

namespace gaiter::solvers {

// How the sliding segments of all ranks were solved.
struct SlidingReport {
  int iterations = 0;   // of the SNES
  double unsolved = 0;  // segments, over all ranks, that failed or were still open at the end
};

// The equilibria of many sliding segments as one SNES over a distributed Vec. A rank holds packs of 64
// segments; a pack's part of the Vec is its 2n rows of 64 numbers in the order of
// physics::SlidingState::unknown, so that each segment is a banded system of its own. A shell preconditioner
// factorises and solves 64 of them at a time; a shell line search damps each segment by itself, and a
// converged one stops moving: a hard segment neither slows nor spoils its neighbours, and the answer does not
// depend on the number of ranks.
//
// Options (prefix sliding_): -sliding_snes_rtol is the relative size of a segment's next step at which it
// closes, -sliding_snes_max_it bounds the steps; every option of SNES, KSP and PC, other line searches and
// SNES types among them, which then damp globally.
class SlidingSolver {
 public:
  // @note Collective. `packs`: packs of 64 segments that this rank will hand to solve().
  SlidingSolver(MPI_Comm comm, std::size_t packs, int slices);
  SlidingSolver(const SlidingSolver&) = delete;
  SlidingSolver& operator=(const SlidingSolver&) = delete;

  // @note Collective. `states`, a pack each, hold the started iterates and take the solution. Segments that
  // are not open stay as they are.
  SlidingReport solve(const physics::SlidingSystem& system, std::vector<physics::SlidingState>& states);

  SNES snes() const { return snes_.get(); }

 private:
  // Sums over this rank's segments, then over all ranks.
  struct Totals {
    double open = 0, failed = 0, residual_square = 0;
  };

  static PetscErrorCode form_function(SNES snes, Vec x, Vec f, void* context);
  static PetscErrorCode form_jacobian(SNES snes, Vec x, Mat jacobian, Mat preconditioner, void* context);
  static PetscErrorCode multiply(Mat jacobian, Vec x, Vec y);
  static PetscErrorCode invert(PC preconditioner, Vec x, Vec y);
  static PetscErrorCode advance(SNESLineSearch search, void* context);
  static PetscErrorCode converged(SNES snes, PetscInt iteration, PetscReal x_norm, PetscReal step_norm,
                                  PetscReal residual_norm, SNESConvergedReason* reason, void* context);

  PetscErrorCode create(MPI_Comm comm, std::size_t packs);
  PetscErrorCode run(SlidingReport& report);
  PetscErrorCode evaluate(Vec x, bool& admissible);
  PetscErrorCode close_small_steps(SNES snes);
  PetscErrorCode add_over_ranks(Totals& totals) const;
  std::size_t pack_rows() const { return 2 * static_cast<std::size_t>(slices_); }
  std::size_t pack_size() const { return pack_rows() * physics::pack_width; }

  int slices_;
  std::vector<physics::Pack> right_, left_;  // a pack's part of a Vec, aligned
  petsc::Vector solution_, residual_;
  petsc::Matrix jacobian_;
  petsc::Snes snes_;

  const physics::SlidingSystem* system_ = nullptr;
  std::vector<physics::SlidingState>* states_ = nullptr;
  double tolerance_ = 0;    // of a segment's next step
  double open_ = 0;         // segments, over all ranks
  bool blockwise_ = false;  // the last step was taken by advance()
  bool current_ = false;    // the states' tangents are those of the solution Vec
};

}  // namespace gaiter::solvers
