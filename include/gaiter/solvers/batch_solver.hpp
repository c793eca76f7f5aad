// SPDX-License-Identifier: BSD-2-Clause
#pragma once

#include "gaiter/petsc/handle.hpp"

namespace gaiter::solvers {

// What the batched solvers share: one SNES for many small systems of equations, its blocks, none of which
// depends on another. Newton's direction comes from the KSP; a shell line search takes it block by block:
// damping is decided in each, a converged one stops moving, and the solve ends when none is open. So a hard
// block neither slows nor spoils its neighbours, and the answer does not depend on the number of ranks. With
// PETSc's own line searches and SNES types, which damp globally, blocks close after the step.
class BatchSolver {
 public:
  BatchSolver(const BatchSolver&) = delete;
  BatchSolver& operator=(const BatchSolver&) = delete;

  SNES snes() const { return snes_.get(); }

 protected:
  // Sums over this rank's blocks, then over all ranks.
  struct Totals {
    double open = 0, failed = 0, residual_square = 0, step_square = 0;
  };
  struct Setup {
    const char* prefix;        // of PETSc's options
    const char* snes_type;     // unless the options say another
    double tolerance;          // of a block, likewise (-snes_rtol)
    int steps;                 // at most, likewise (-snes_max_it)
    int block_rows;            // unknowns of a block, where they are neighbours in the Vec; else 1
    const char* inverse_name;  // of the shell preconditioner
  };

  BatchSolver() = default;
  virtual ~BatchSolver() = default;

  // The SNES with its vectors. `jacobian_` may have been made before; else it becomes a shell.
  PetscErrorCode create(MPI_Comm comm, PetscInt rows, const Setup& setup);
  // Solves from the iterate and residual that solution_ and residual_ hold, whose blocks `totals` counts.
  PetscErrorCode solve_open(Totals totals, int& iterations);
  PetscErrorCode add_over_ranks(Totals& totals) const;

  // What a kind of block does. Residuals (f may be null) and tangents of all blocks at x; `admissible`
  // becomes false where one cannot be evaluated.
  virtual PetscErrorCode evaluate(Vec x, Vec f, bool& admissible) = 0;
  virtual PetscErrorCode assemble(Mat jacobian) = 0;  // only where it is not a shell
  virtual void multiply(const PetscScalar* in, PetscScalar* out) = 0;
  virtual void invert(const PetscScalar* in, PetscScalar* out) = 0;
  // Each open block takes its own step; iterate, residual and tangents follow.
  virtual void step(const PetscScalar* direction, PetscScalar* iterate, PetscScalar* residual,
                    Totals& totals) = 0;
  // After a step that another line search or solver has taken, with tangents at hand: blocks whose next step
  // would be small enough close.
  virtual void close_small_steps(Totals& totals) = 0;

  petsc::Vector solution_, residual_;
  petsc::Matrix jacobian_;
  petsc::Snes snes_;
  double tolerance_ = 0;      // of a block, while it is solved
  double open_ = 0;           // blocks, over all ranks
  bool own_inverse_ = false;  // directions come from invert() alone, so that those of closed blocks are free

 private:
  static PetscErrorCode form_function(SNES snes, Vec x, Vec f, void* context);
  static PetscErrorCode form_jacobian(SNES snes, Vec x, Mat jacobian, Mat preconditioner, void* context);
  static PetscErrorCode apply_jacobian(Mat jacobian, Vec x, Vec y);
  static PetscErrorCode apply_inverse(PC preconditioner, Vec x, Vec y);
  static PetscErrorCode advance(SNESLineSearch search, void* context);
  static PetscErrorCode converged(SNES snes, PetscInt iteration, PetscReal x_norm, PetscReal step_norm,
                                  PetscReal residual_norm, SNESConvergedReason* reason, void* context);
  PetscErrorCode renew(Vec x, Vec f, bool& admissible);

  bool blockwise_ = false;  // the last step was taken by advance()
  bool current_ = false;    // tangents are those of solution_
};

}  // namespace gaiter::solvers
