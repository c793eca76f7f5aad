// SPDX-License-Identifier: BSD-2-Clause
#pragma once

#include <petscsnes.h>

#include "gaiter/petsc/handle.hpp"

namespace gaiter::solvers {

// How the linear systems of an axisymmetric problem are solved: the KSP of its SNES, set up for a saddle
// point. By default MUMPS' symmetric factorisation; for others the solver gets told what is what:
//   -axisym_pc_type lu -axisym_pc_factor_mat_ordering_type saddle_point: every pressure and multiplier after
//     the displacements it couples to, so that PETSc's LU, which does not pivot, meets no zero pivot;
//   -axisym_pc_type fieldsplit: fields `displacement` and `constraint` (all others) for
//     -axisym_pc_fieldsplit_type schur, else `displacement`, `pressure`, `multiplier` and, if there is one,
//     `potential`.
class AxisymLinear {
 public:
  // `plex` and `tangent` live as long as this. Options are not read yet. @note Collective.
  PetscErrorCode create(DM plex, Mat tangent, KSP ksp);

  // After the KSP has read its options. @note Collective.
  PetscErrorCode prepare();

  // Throws base::InputError if the factorisation asked for does not run on as many ranks. @note Collective.
  void require_available() const;

  // The tangent's pattern has changed: everything made for the old one is dropped. PETSc 3.18 does not notice
  // by itself when MatSetPreallocationCOO is called again on several ranks. @note Collective.
  PetscErrorCode renew();

  // Negative eigenvalues of the tangent, exact: from the factor of the last solve where it tells, else the
  // tangent is factorised for it. @note Collective.
  PetscErrorCode count_negative(PetscInt* negative) const;

 private:
  PetscErrorCode set_defaults();
  PetscErrorCode name_fields(PC pc);
  PetscErrorCode counts_pivots(PC pc, bool* yes) const;

  DM plex_ = nullptr;
  Mat tangent_ = nullptr;
  KSP ksp_ = nullptr;
};

}  // namespace gaiter::solvers
