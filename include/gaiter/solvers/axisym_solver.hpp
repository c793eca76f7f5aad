// SPDX-License-Identifier: BSD-2-Clause
#pragma once

#include <vector>

#include "gaiter/solvers/axisym_system.hpp"

namespace gaiter::solvers {

// How a solve ended.
struct AxisymReport {
  bool converged = false;
  bool stable = true;  // the tangent has as many negative pivots as pressures and multipliers (where known)
  bool inertia_known = false;
  int iterations = 0;
  std::vector<double> steps{};  // largest displacement of each iteration, over the leg's radius
  double assembly_seconds = 0;  // of the whole solve, residuals and tangents
};

// Newton's method for an AxisymSystem: SNES with prefix axisym_, by default MUMPS' symmetric factorisation
// and full steps, shortened only where a displacement would change by more than a tenth of the leg's radius
// or a trial is inadmissible. Converged once a full step is below -axisym_snes_stol (default 1e-7, of the
// leg's radius) and no contact has changed.
template <int P>
class AxisymSolver {
 public:
  explicit AxisymSolver(AxisymSystem<P>& system);  // @note Collective.
  AxisymSolver(const AxisymSolver&) = delete;
  AxisymSolver& operator=(const AxisymSolver&) = delete;

  // From x, to x. Not converged is no error: x is then of no use. @note Collective.
  AxisymReport solve(Vec x);

 private:
  static PetscErrorCode form_function(SNES snes, Vec x, Vec f, void* context);
  static PetscErrorCode form_jacobian(SNES snes, Vec x, Mat jacobian, Mat preconditioner, void* context);
  static PetscErrorCode step(SNESLineSearch search, void* context);
  static PetscErrorCode converged(SNES snes, PetscInt iteration, PetscReal x_norm, PetscReal step_norm,
                                  PetscReal residual_norm, SNESConvergedReason* reason, void* context);
  PetscErrorCode create();
  PetscErrorCode uses_mumps(bool* yes) const;
  PetscErrorCode run(Vec x, AxisymReport& report);

  AxisymSystem<P>& system_;
  petsc::Vector residual_;
  petsc::Snes snes_;
  double step_tolerance_ = 0;
  double last_step_ = 0;  // largest displacement of the last step taken, over the leg's radius
  bool full_step_ = false, counts_pivots_ = false;
  AxisymReport report_;
};

}  // namespace gaiter::solvers
