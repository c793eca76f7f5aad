// SPDX-License-Identifier: BSD-2-Clause
#pragma once

#include <functional>
#include <vector>

#include "gaiter/model/scene.hpp"
#include "gaiter/petsc/handle.hpp"
#include "gaiter/physics/slice_newton.hpp"

namespace gaiter::solvers {

// How the slices of all ranks were solved.
struct SliceReport {
  int iterations = 0;   // of the SNES
  double unsolved = 0;  // slices, over all ranks, that were still open at the end
};

// The equilibria of many slices as one SNES over a distributed Vec with blocks (strain, pressure), a slice a
// block. Newton's direction comes from the KSP; a shell line search takes it slice by slice: damping is
// decided in each block, a converged block stops moving, and the solve ends when no block is open. So a hard
// slice neither slows nor spoils its neighbours, and the answer does not depend on the number of ranks.
//
// Options (prefix slice_): -slice_snes_rtol is the relative error of a slice's pressure at which it closes,
// -slice_snes_max_it bounds the steps; -slice_mat_type shell (default: the blocks are inverted as stored) or
// baij (an assembled matrix, by default with point-block Jacobi); every option of SNES, KSP and PC, other
// line searches and SNES types among them, which then damp globally.
class SliceSolver {
 public:
  // @note Collective. `packs`: most packs of 64 slices that this rank will ever hand to solve().
  SliceSolver(MPI_Comm comm, std::size_t packs, model::SliceSolver algorithm, double fixed_point_tolerance);
  SliceSolver(const SliceSolver&) = delete;
  SliceSolver& operator=(const SliceSolver&) = delete;

  // Sets the iterate of one pack.
  using Start = std::function<void(std::size_t pack)>;

  // @note Collective. `states`, a pack each, take the solution; they hold the started iterates, or `start`
  // sets them. Slices that are not open stay as they are. The system may have fewer packs than the solver,
  // none too.
  SliceReport solve(
      const physics::SliceSystem& system, std::vector<physics::PackState>& states,
      const Start& start = [](std::size_t) {});

  SNES snes() const { return snes_.get(); }

 private:
  // Sums over this rank's slices, then over all ranks.
  struct Totals {
    double open = 0, residual_square = 0, step_square = 0;
  };

  static PetscErrorCode form_function(SNES snes, Vec x, Vec f, void* context);
  static PetscErrorCode form_jacobian(SNES snes, Vec x, Mat jacobian, Mat preconditioner, void* context);
  static PetscErrorCode multiply(Mat jacobian, Vec x, Vec y);
  static PetscErrorCode invert(PC preconditioner, Vec x, Vec y);
  static PetscErrorCode advance(SNESLineSearch search, void* context);
  static PetscErrorCode converged(SNES snes, PetscInt iteration, PetscReal x_norm, PetscReal step_norm,
                                  PetscReal residual_norm, SNESConvergedReason* reason, void* context);

  PetscErrorCode create(MPI_Comm comm, std::size_t packs);
  PetscErrorCode create_matrix(MPI_Comm comm, PetscInt rows);
  PetscErrorCode run(const Start& start, SliceReport& report);
  PetscErrorCode evaluate(Vec x, Vec f);
  PetscErrorCode close_where_converged(SNES snes);
  PetscErrorCode add_over_ranks(Totals& totals) const;

  bool newton_;
  double fixed_point_tolerance_;
  petsc::Vector solution_, residual_;
  petsc::Matrix jacobian_;
  petsc::Snes snes_;
  bool assembled_ = false;

  const physics::SliceSystem* system_ = nullptr;
  std::vector<physics::PackState>* states_ = nullptr;
  double tolerance_ = 0;    // relative, of the pressure
  double open_ = 0;         // slices, over all ranks
  bool blockwise_ = false;  // the last step was taken by advance()
  bool current_ = false;    // the states' residuals and slopes are those of the solution Vec
};

}  // namespace gaiter::solvers
