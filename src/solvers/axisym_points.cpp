// SPDX-License-Identifier: BSD-2-Clause
#include "gaiter/solvers/axisym_points.hpp"

#include "gaiter/petsc/check.hpp"

namespace gaiter::solvers {

namespace {

PetscErrorCode number_in_mesh(DM dm, const char* label, PetscInt first, PetscInt point, PetscInt* number) {
  PetscFunctionBegin;
  DMLabel numbers = nullptr;
  PetscCall(DMGetLabel(dm, label, &numbers));
  if (numbers)
    PetscCall(DMLabelGetValue(numbers, point, number));
  else
    *number = point - first;
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode find_points(DM dm, const AxisymMesh& mesh, PetscInt cell, PetscInt first_cell,
                           PetscInt first_vertex, PetscInt last_vertex, CellPoints& points) {
  PetscFunctionBegin;
  PetscInt number = 0;
  PetscCall(number_in_mesh(dm, "cell", first_cell, cell, &number));
  points.cell = cell;
  while (points.block + 1 < static_cast<int>(mesh.blocks.size()) &&
         mesh.blocks[points.block + 1].first_cell <= number)
    ++points.block;
  const AxisymBlock& block = mesh.blocks[points.block];
  points.column = (number - block.first_cell) % block.columns();
  points.row = (number - block.first_cell) / block.columns();
  const std::array<int, 4> corners{
      block.vertex(points.column, points.row), block.vertex(points.column + 1, points.row),
      block.vertex(points.column + 1, points.row + 1), block.vertex(points.column, points.row + 1)};

  PetscInt size = 0, *closure = nullptr;
  std::array<PetscInt, 4> sides{};
  int side_count = 0;
  PetscCall(DMPlexGetTransitiveClosure(dm, cell, PETSC_TRUE, &size, &closure));
  for (PetscInt k = 1; k < size; ++k) {
    const PetscInt point = closure[2 * k];
    if (point >= first_vertex && point < last_vertex) {
      PetscCall(number_in_mesh(dm, "vertex", first_vertex, point, &number));
      for (int c = 0; c < 4; ++c)
        if (corners[c] == number) points.corner[c] = point;
    } else if (side_count < 4) {
      sides[side_count++] = point;
    }
  }
  PetscCall(DMPlexRestoreTransitiveClosure(dm, cell, PETSC_TRUE, &size, &closure));
  // Sides 0 and 2 run along the columns, 1 and 3 along the rows; from and to in the sense of the local
  // coordinates.
  constexpr std::array<std::array<int, 2>, 4> ends{{{0, 1}, {1, 2}, {3, 2}, {0, 3}}};
  for (PetscInt side : sides) {
    const PetscInt* cone = nullptr;
    PetscCall(DMPlexGetCone(dm, side, &cone));
    for (int k = 0; k < 4; ++k) {
      const PetscInt from = points.corner[ends[k][0]], to = points.corner[ends[k][1]];
      if ((cone[0] == from && cone[1] == to) || (cone[0] == to && cone[1] == from)) {
        points.side[k] = side;
        points.reversed[k] = cone[0] == to;
      }
    }
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

}  // namespace

PetscErrorCode find_cell_points(DM dm, const AxisymMesh& mesh, std::vector<CellPoints>& points) {
  PetscFunctionBegin;
  PetscInt first = 0, last = 0, first_vertex = 0, last_vertex = 0;
  PetscCall(DMPlexGetHeightStratum(dm, 0, &first, &last));
  PetscCall(DMPlexGetDepthStratum(dm, 0, &first_vertex, &last_vertex));
  points.resize(last - first);
  for (PetscInt cell = first; cell < last; ++cell)
    PetscCall(find_points(dm, mesh, cell, first, first_vertex, last_vertex, points[cell - first]));
  PetscFunctionReturn(PETSC_SUCCESS);
}

}  // namespace gaiter::solvers
