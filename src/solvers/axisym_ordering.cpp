// SPDX-License-Identifier: BSD-2-Clause
#include "gaiter/solvers/axisym_ordering.hpp"

#include <algorithm>
#include <vector>

#include "gaiter/petsc/check.hpp"
#include "gaiter/petsc/handle.hpp"

namespace gaiter::solvers {

namespace {

constexpr const char* ordering_name = "saddle_point";
constexpr const char* constraints_name = "axisym_constraints";

using IndexSet = petsc::Handle<IS, ISDestroy>;

// Place of each free row in the order of elimination: -1 for constraints.
PetscErrorCode order_free_rows(Mat matrix, IS constraints, std::vector<PetscInt>& place) {
  PetscFunctionBegin;
  IndexSet free, rows, columns;
  petsc::Matrix block;
  PetscInt size = 0, first = 0, last = 0;
  PetscCall(MatGetOwnershipRange(matrix, &first, &last));
  PetscCall(ISComplement(constraints, first, last, free.out()));
  PetscCall(MatCreateSubMatrix(matrix, free.get(), free.get(), MAT_INITIAL_MATRIX, block.out()));
  PetscCall(MatGetOrdering(block.get(), MATORDERINGND, rows.out(), columns.out()));
  PetscCall(ISGetLocalSize(rows.get(), &size));
  const PetscInt *order = nullptr, *number = nullptr;
  PetscCall(ISGetIndices(rows.get(), &order));
  PetscCall(ISGetIndices(free.get(), &number));
  place.assign(last - first, -1);
  for (PetscInt k = 0; k < size; ++k) place[number[order[k]]] = k;
  PetscCall(ISRestoreIndices(free.get(), &number));
  PetscCall(ISRestoreIndices(rows.get(), &order));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode order_saddle_point(Mat matrix, MatOrderingType, IS* rows, IS* columns) {
  PetscFunctionBegin;
  IS constraints = nullptr;
  PetscCall(PetscObjectQuery((PetscObject)matrix, constraints_name, (PetscObject*)&constraints));
  PetscCheck(constraints, PETSC_COMM_SELF, PETSC_ERR_ARG_WRONGSTATE,
             "the ordering saddle_point is for the whole matrix of the axisymmetric model");
  std::vector<PetscInt> place;
  PetscCall(order_free_rows(matrix, constraints, place));
  const auto size = static_cast<PetscInt>(place.size());
  std::vector<PetscInt> key(place);
  PetscInt constrained = 0;
  const PetscInt* constraint = nullptr;
  PetscCall(ISGetLocalSize(constraints, &constrained));
  PetscCall(ISGetIndices(constraints, &constraint));
  for (PetscInt k = 0; k < constrained; ++k) {
    PetscInt count = 0;
    const PetscInt* neighbours = nullptr;
    PetscCall(MatGetRow(matrix, constraint[k], &count, &neighbours, nullptr));
    for (PetscInt i = 0; i < count; ++i)
      key[constraint[k]] = std::max(key[constraint[k]], place[neighbours[i]]);
    PetscCall(MatRestoreRow(matrix, constraint[k], &count, &neighbours, nullptr));
  }
  PetscCall(ISRestoreIndices(constraints, &constraint));
  std::vector<PetscInt> order(size);
  for (PetscInt i = 0; i < size; ++i) order[i] = i;
  std::stable_sort(order.begin(), order.end(), [&](PetscInt a, PetscInt b) {
    return key[a] != key[b] ? key[a] < key[b] : place[a] > place[b];
  });
  PetscCall(ISCreateGeneral(PETSC_COMM_SELF, size, order.data(), PETSC_COPY_VALUES, rows));
  PetscCall(ISDuplicate(*rows, columns));
  PetscFunctionReturn(PETSC_SUCCESS);
}

}  // namespace

PetscErrorCode register_saddle_point_ordering() {
  PetscFunctionBegin;
  PetscCall(MatOrderingRegister(ordering_name, order_saddle_point));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode set_constraints(Mat matrix, IS constraints) {
  PetscFunctionBegin;
  PetscCall(PetscObjectCompose((PetscObject)matrix, constraints_name, (PetscObject)constraints));
  PetscFunctionReturn(PETSC_SUCCESS);
}

}  // namespace gaiter::solvers
