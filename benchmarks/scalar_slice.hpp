// SPDX-License-Identifier: BSD-2-Clause
#pragma once

#include <petscsnes.h>

#include <cstddef>

#include "gaiter/petsc/handle.hpp"
#include "gaiter/physics/slice_system.hpp"

namespace gaiter::benchmarks {

// What one would write first: a SNES of two unknowns, used again for every slice, with dense LU and scalar
// laws. Same equations, same start, same accuracy as the batched solver.
class ScalarSliceSolver {
 public:
  explicit ScalarSliceSolver(double tolerance);

  // Pressure (in units of the slice's scale) at rest, from a strain and a pressure to start at.
  double solve(const physics::SliceSystem& system, std::size_t slice, double strain, double pressure);

 private:
  static PetscErrorCode form_function(SNES snes, Vec x, Vec f, void* context);
  static PetscErrorCode form_jacobian(SNES snes, Vec x, Mat jacobian, Mat preconditioner, void* context);
  PetscErrorCode create(double tolerance);
  PetscErrorCode run(double strain, double pressure, double& solution);

  const physics::SliceSystem* system_ = nullptr;
  std::size_t slice_ = 0;
  petsc::Vector solution_, residual_;
  petsc::Matrix jacobian_;
  petsc::Snes snes_;
};

}  // namespace gaiter::benchmarks
