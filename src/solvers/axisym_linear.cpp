// SPDX-License-Identifier: BSD-2-Clause
#include "gaiter/solvers/axisym_linear.hpp"

#include <petscdm.h>

#include <array>
#include <cstring>

#include "gaiter/base/error.hpp"
#include "gaiter/petsc/check.hpp"
#include "gaiter/petsc/session.hpp"
#include "gaiter/solvers/axisym_ordering.hpp"

namespace gaiter::solvers {

namespace {

using IndexSet = petsc::Handle<IS, ISDestroy>;

constexpr int sequential_root = 13, workspace_increase = 14;  // of MUMPS' ICNTL
constexpr int negative_pivots = 12;                           // of MUMPS' INFOG

// MUMPS does not count the negative pivots of a root that it factorises in parallel, and its guess of the
// workspace is too small where many pivots have to be delayed.
PetscErrorCode set_mumps(Mat factor) {
  PetscFunctionBegin;
  PetscCall(MatMumpsSetIcntl(factor, sequential_root, 1));
  PetscCall(MatMumpsSetIcntl(factor, workspace_increase, 200));
  PetscFunctionReturn(PETSC_SUCCESS);
}

constexpr std::array field_names{"displacement", "pressure", "multiplier", "potential"};
using Fields = std::array<IndexSet, field_names.size()>;

// Global numbers of this rank's unknowns of the fields.
PetscErrorCode get_fields(DM plex, Fields& fields) {
  PetscFunctionBegin;
  PetscInt count = 0;
  IS* sets = nullptr;
  PetscCall(DMCreateFieldIS(plex, &count, nullptr, &sets));
  for (PetscInt k = 0; k < count; ++k) {
    IndexSet owned(sets[k]);
    if (k < static_cast<PetscInt>(fields.size())) fields[k] = std::move(owned);
  }
  PetscCall(PetscFree(sets));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode get_constraints(DM plex, IndexSet& displacement, IndexSet& constraint) {
  PetscFunctionBegin;
  Fields fields;
  PetscCall(get_fields(plex, fields));
  const std::array<IS, 3> all{fields[1].get(), fields[2].get(), fields[3].get()};
  PetscCall(ISConcatenate(PetscObjectComm((PetscObject)plex), 3, all.data(), constraint.out()));
  PetscCall(ISSort(constraint.get()));
  displacement = std::move(fields[0]);
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode factors(PC pc, MatFactorType* type) {
  PetscFunctionBegin;
  PetscBool lu = PETSC_FALSE, cholesky = PETSC_FALSE;
  PetscCall(PetscObjectTypeCompare((PetscObject)pc, PCLU, &lu));
  PetscCall(PetscObjectTypeCompare((PetscObject)pc, PCCHOLESKY, &cholesky));
  *type = lu ? MAT_FACTOR_LU : cholesky ? MAT_FACTOR_CHOLESKY : MAT_FACTOR_NONE;
  PetscFunctionReturn(PETSC_SUCCESS);
}

// Null where a package is not chosen, or nothing is factorised.
PetscErrorCode package_of(PC pc, MatSolverType* package) {
  PetscFunctionBegin;
  MatFactorType type = MAT_FACTOR_NONE;
  *package = nullptr;
  PetscCall(factors(pc, &type));
  if (type != MAT_FACTOR_NONE) PetscCall(PCFactorGetMatSolverType(pc, package));
  PetscFunctionReturn(PETSC_SUCCESS);
}

bool is_mumps(MatSolverType package) {
  return package && std::strcmp(package, MATSOLVERMUMPS) == 0;
}

PetscErrorCode available(Mat tangent, MatSolverType package, MatFactorType type, PetscBool* yes) {
  PetscFunctionBegin;
  *yes = PETSC_TRUE;
  if (type != MAT_FACTOR_NONE) PetscCall(MatGetFactorAvailable(tangent, package, type, yes));
  PetscFunctionReturn(PETSC_SUCCESS);
}

}  // namespace

PetscErrorCode AxisymLinear::create(DM plex, Mat tangent, KSP ksp) {
  PetscFunctionBegin;
  plex_ = plex;
  tangent_ = tangent;
  ksp_ = ksp;
  PetscCall(register_saddle_point_ordering());
  PetscCall(KSPSetType(ksp_, KSPPREONLY));
  PetscCall(set_defaults());
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode AxisymLinear::set_defaults() {
  PetscFunctionBegin;
  PC pc = nullptr;
  PetscCall(KSPGetPC(ksp_, &pc));
  PetscCall(PCSetType(pc, PCCHOLESKY));
  PetscCall(PCFactorSetMatSolverType(pc, MATSOLVERMUMPS));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode AxisymLinear::prepare() {
  PetscFunctionBegin;
  PC pc = nullptr;
  PetscBool split = PETSC_FALSE;
  MatSolverType package = nullptr;
  PetscCall(KSPGetPC(ksp_, &pc));
  PetscCall(PetscObjectTypeCompare((PetscObject)pc, PCFIELDSPLIT, &split));
  IndexSet displacement, constraint;
  PetscCall(get_constraints(plex_, displacement, constraint));
  PetscCall(set_constraints(tangent_, constraint.get()));
  if (split) PetscCall(name_fields(pc));
  PetscCall(package_of(pc, &package));
  if (is_mumps(package)) {
    Mat factor = nullptr;
    PetscCall(KSPSetOperators(ksp_, tangent_, tangent_));
    PetscCall(PCFactorSetUpMatSolverType(pc));
    PetscCall(PCFactorGetMatrix(pc, &factor));
    PetscCall(set_mumps(factor));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode AxisymLinear::name_fields(PC pc) {
  PetscFunctionBegin;
  PCCompositeType type = PC_COMPOSITE_ADDITIVE;
  PetscCall(PCFieldSplitGetType(pc, &type));
  if (type == PC_COMPOSITE_SCHUR) {
    IndexSet displacement, constraint;
    PetscCall(get_constraints(plex_, displacement, constraint));
    PetscCall(PCFieldSplitSetIS(pc, "displacement", displacement.get()));
    PetscCall(PCFieldSplitSetIS(pc, "constraint", constraint.get()));
  } else {
    Fields fields;
    PetscCall(get_fields(plex_, fields));
    for (std::size_t k = 0; k < fields.size(); ++k) {
      PetscInt size = 0;
      PetscCall(ISGetSize(fields[k].get(), &size));
      if (size > 0) PetscCall(PCFieldSplitSetIS(pc, field_names[k], fields[k].get()));
    }
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

void AxisymLinear::require_available() const {
  PC pc = nullptr;
  MatFactorType type = MAT_FACTOR_NONE;
  MatSolverType package = nullptr;
  PetscBool yes = PETSC_TRUE;
  petsc::check(KSPGetPC(ksp_, &pc));
  petsc::check(factors(pc, &type));
  petsc::check(package_of(pc, &package));
  petsc::check(available(tangent_, package, type, &yes));
  if (yes) return;
  const int ranks = petsc::size(PetscObjectComm((PetscObject)ksp_));
  throw base::InputError("-axisym_pc_factor_mat_solver_type '" + std::string(package ? package : "petsc") +
                         "': does not factorise a matrix shared by " + std::to_string(ranks) +
                         (ranks == 1 ? " rank" : " ranks") + " with -axisym_pc_type '" +
                         (type == MAT_FACTOR_LU ? PCLU : PCCHOLESKY) + "': 'mumps' does");
}

PetscErrorCode AxisymLinear::renew() {
  PetscFunctionBegin;
  PC pc = nullptr;
  PetscCall(KSPGetPC(ksp_, &pc));
  PetscCall(KSPReset(ksp_));
  // A fieldsplit keeps its fields, and a factor its package, until the type changes.
  PetscCall(PCSetType(pc, PCNONE));
  PetscCall(set_defaults());
  PetscCall(PCSetFromOptions(pc));
  PetscCall(prepare());
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode AxisymLinear::counts_pivots(PC pc, bool* yes) const {
  PetscFunctionBegin;
  MatFactorType type = MAT_FACTOR_NONE;
  MatSolverType package = nullptr;
  *yes = false;
  PetscCall(factors(pc, &type));
  PetscCall(package_of(pc, &package));
  if (type != MAT_FACTOR_CHOLESKY || !is_mumps(package)) PetscFunctionReturn(PETSC_SUCCESS);
  Mat factor = nullptr;
  PetscInt root = 0;
  PetscCall(PCFactorGetMatrix(pc, &factor));
  PetscCall(MatMumpsGetIcntl(factor, sequential_root, &root));  // options can undo what set_mumps did
  *yes = root > 0 || petsc::size(PetscObjectComm((PetscObject)ksp_)) == 1;
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode AxisymLinear::count_negative(PetscInt* negative) const {
  PetscFunctionBegin;
  PC pc = nullptr;
  bool counted = false;
  PetscCall(KSPGetPC(ksp_, &pc));
  PetscCall(counts_pivots(pc, &counted));
  if (counted) {
    Mat factor = nullptr;
    PetscCall(PCFactorGetMatrix(pc, &factor));
    PetscCall(MatMumpsGetInfog(factor, negative_pivots, negative));
    PetscFunctionReturn(PETSC_SUCCESS);
  }
  petsc::Matrix factor;
  MatFactorInfo info;
  PetscCall(MatFactorInfoInitialize(&info));
  PetscCall(MatGetFactor(tangent_, MATSOLVERMUMPS, MAT_FACTOR_CHOLESKY, factor.out()));
  PetscCall(set_mumps(factor.get()));
  PetscCall(MatCholeskyFactorSymbolic(factor.get(), tangent_, nullptr, &info));
  PetscCall(MatCholeskyFactorNumeric(factor.get(), tangent_, &info));
  PetscCall(MatMumpsGetInfog(factor.get(), negative_pivots, negative));
  PetscFunctionReturn(PETSC_SUCCESS);
}

}  // namespace gaiter::solvers
