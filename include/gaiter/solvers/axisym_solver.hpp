// SPDX-License-Identifier: BSD-2-Clause
#pragma once

#include <limits>
#include <vector>

#include "gaiter/solvers/axisym_linear.hpp"
#include "gaiter/solvers/axisym_system.hpp"

namespace gaiter::solvers {

// How a solve ended.
struct AxisymReport {
  bool converged = false;
  bool stable = true;  // the tangent has as many negative eigenvalues as pressures and multipliers
  int iterations = 0;
  std::vector<double> steps{};  // largest displacement of each iteration, over the leg's radius
};

// Newton's method for an AxisymSystem: SNES with prefix axisym_, linear systems as in AxisymLinear, full
// steps, shortened only where a displacement would change by more than a tenth of the leg's radius or a trial
// is inadmissible. Converged once a full step is below -axisym_snes_stol (default 1e-7, of the leg's radius)
// and no contact has changed.
template <int P>
class AxisymSolver {
 public:
  explicit AxisymSolver(AxisymSystem<P>& system);  // @note Collective.
  AxisymSolver(const AxisymSolver&) = delete;
  AxisymSolver& operator=(const AxisymSolver&) = delete;

  // From x, to x, in no more than `most` iterations and -axisym_snes_max_it (default 30). Not converged is no
  // error: x is then of no use. @note Collective.
  AxisymReport solve(Vec x, int most = std::numeric_limits<int>::max());

  // Solves one linear system, with the tangent at x, so that all parts of the solver ask for their options.
  // @note Collective.
  void try_at(Vec x);

  // The residual at x, and the tangent there factorised for solve_linear: false, on all ranks alike, where x
  // is inadmissible. @note Collective.
  bool linearise(Vec x, Vec residual);
  // One solution with the tangent linearised. @note Collective.
  void solve_linear(Vec right, Vec solution);
  // Of the tangent factorised last: as many negative eigenvalues as pressures and multipliers. @note
  // Collective.
  bool stable() const;

 private:
  static PetscErrorCode form_function(SNES snes, Vec x, Vec f, void* context);
  static PetscErrorCode form_jacobian(SNES snes, Vec x, Mat jacobian, Mat preconditioner, void* context);
  static PetscErrorCode step(SNESLineSearch search, void* context);
  static PetscErrorCode converged(SNES snes, PetscInt iteration, PetscReal x_norm, PetscReal step_norm,
                                  PetscReal residual_norm, SNESConvergedReason* reason, void* context);
  PetscErrorCode create();
  PetscErrorCode run(Vec x, int most, AxisymReport& report);
  PetscErrorCode assemble();
  PetscErrorCode make_linear(Vec x, Vec residual, bool& admissible);
  PetscErrorCode solve_once(Vec right, Vec solution);

  AxisymSystem<P>& system_;
  petsc::Vector residual_;
  petsc::Snes snes_;
  AxisymLinear linear_;
  int pattern_ = 0;  // of the system, that linear_ is set up for
  double step_tolerance_ = 0;
  PetscInt most_iterations_ = 0;
  std::vector<double> steps_;  // largest displacement of each step taken, over the leg's radius
  bool full_step_ = false;
};

}  // namespace gaiter::solvers
