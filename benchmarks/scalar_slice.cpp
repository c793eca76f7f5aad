// SPDX-License-Identifier: BSD-2-Clause
#include "scalar_slice.hpp"

#include <cmath>

#include "gaiter/petsc/check.hpp"

namespace gaiter::benchmarks {

namespace {

using physics::SliceShape;
using physics::SliceSystem;

struct Laws {
  double strain, strain_slope, bandage, bandage_slope;
};

// The laws of slice_kernel.hpp for one slice and a leg with the strain law.
Laws laws(const SliceSystem& system, std::size_t slice, double strain, double pressure) {
  const SliceShape& shape = system.shape();
  const auto row = [&](int index) { return system.constant(slice, index); };
  Laws result{};
  const double grown = std::expm1(pressure), decay = row(SliceShape::leg_3),
               decayed = std::expm1(decay * pressure);
  const double a = row(SliceShape::leg_0), c = row(SliceShape::leg_1);
  result.strain = row(SliceShape::leg_2) + a * grown + c * decayed;
  result.strain_slope = a * (1 + grown) + c * decay * (1 + decayed);
  const double excess = row(SliceShape::gap) - row(SliceShape::leg_radius) * strain;
  const double swell = excess * (2 + excess);
  for (std::size_t j = 0; j < shape.wall.nodes.size(); ++j) {
    const double ratio = row(shape.wall_row(static_cast<int>(j)));
    const double log_stretch = 0.5 * std::log1p(swell * ratio), inverse = 1 / (1 + swell * ratio);
    double stress = 0, slope = 0;
    for (int term = 0; term < shape.ogden_terms; ++term) {
      const double alpha = row(shape.alpha_row(term)), power = std::expm1(alpha * log_stretch);
      const double sine = 0.5 * (power + power / (1 + power)), cosine = sine + 1 / (1 + power);
      stress += row(shape.mu_row(term)) * sine;
      slope += row(shape.mu_row(term)) * (alpha * cosine - 2 * sine);
    }
    result.bandage += shape.wall.weights[j] * inverse * stress;
    result.bandage_slope += shape.wall.weights[j] * inverse * inverse * ratio * slope;
  }
  const double log_wall = row(SliceShape::log_wall);
  result.bandage *= log_wall;
  result.bandage_slope *= -log_wall * row(SliceShape::leg_radius) * (1 + excess);
  return result;
}

}  // namespace

ScalarSliceSolver::ScalarSliceSolver(double tolerance) {
  petsc::check(create(tolerance));
}

PetscErrorCode ScalarSliceSolver::create(double tolerance) {
  PetscFunctionBegin;
  PetscCall(VecCreateSeq(PETSC_COMM_SELF, 2, solution_.out()));
  PetscCall(VecDuplicate(solution_.get(), residual_.out()));
  PetscCall(MatCreateSeqDense(PETSC_COMM_SELF, 2, 2, nullptr, jacobian_.out()));
  PetscCall(SNESCreate(PETSC_COMM_SELF, snes_.out()));
  PetscCall(SNESSetOptionsPrefix(snes_.get(), "scalar_"));
  PetscCall(SNESSetFunction(snes_.get(), residual_.get(), form_function, this));
  PetscCall(SNESSetJacobian(snes_.get(), jacobian_.get(), jacobian_.get(), form_jacobian, this));
  PetscCall(SNESSetTolerances(snes_.get(), tolerance, 0, 0, 50, -1));
  KSP ksp = nullptr;
  PC pc = nullptr;
  PetscCall(SNESGetKSP(snes_.get(), &ksp));
  PetscCall(KSPSetType(ksp, KSPPREONLY));
  PetscCall(KSPGetPC(ksp, &pc));
  PetscCall(PCSetType(pc, PCLU));
  PetscCall(SNESSetFromOptions(snes_.get()));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode ScalarSliceSolver::form_function(SNES, Vec x, Vec f, void* context) {
  PetscFunctionBegin;
  const auto& self = *static_cast<ScalarSliceSolver*>(context);
  const PetscScalar* in = nullptr;
  PetscScalar* out = nullptr;
  PetscCall(VecGetArrayRead(x, &in));
  PetscCall(VecGetArrayWrite(f, &out));
  const Laws at = laws(*self.system_, self.slice_, in[0], in[1]);
  out[0] = in[0] - at.strain;
  out[1] = in[1] - at.bandage;
  PetscCall(VecRestoreArrayWrite(f, &out));
  PetscCall(VecRestoreArrayRead(x, &in));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode ScalarSliceSolver::form_jacobian(SNES, Vec x, Mat, Mat preconditioner, void* context) {
  PetscFunctionBegin;
  const auto& self = *static_cast<ScalarSliceSolver*>(context);
  const PetscScalar* in = nullptr;
  PetscScalar* block = nullptr;
  PetscCall(VecGetArrayRead(x, &in));
  PetscCall(MatDenseGetArrayWrite(preconditioner, &block));
  const Laws at = laws(*self.system_, self.slice_, in[0], in[1]);
  block[0] = block[3] = 1;
  block[1] = -at.bandage_slope;  // column by column
  block[2] = -at.strain_slope;
  PetscCall(MatDenseRestoreArrayWrite(preconditioner, &block));
  PetscCall(VecRestoreArrayRead(x, &in));
  PetscCall(MatAssemblyBegin(preconditioner, MAT_FINAL_ASSEMBLY));
  PetscCall(MatAssemblyEnd(preconditioner, MAT_FINAL_ASSEMBLY));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode ScalarSliceSolver::run(double strain, double pressure, double& solution) {
  PetscFunctionBegin;
  PetscScalar* x = nullptr;
  PetscCall(VecGetArrayWrite(solution_.get(), &x));
  x[0] = strain;
  x[1] = pressure;
  PetscCall(VecRestoreArrayWrite(solution_.get(), &x));
  PetscCall(SNESSolve(snes_.get(), nullptr, solution_.get()));
  const PetscScalar* result = nullptr;
  PetscCall(VecGetArrayRead(solution_.get(), &result));
  solution = result[1];
  PetscCall(VecRestoreArrayRead(solution_.get(), &result));
  PetscFunctionReturn(PETSC_SUCCESS);
}

double ScalarSliceSolver::solve(const SliceSystem& system, std::size_t slice, double strain,
                                double pressure) {
  system_ = &system;
  slice_ = slice;
  double solution = 0;
  petsc::check(run(strain, pressure, solution));
  return solution;
}

}  // namespace gaiter::benchmarks
