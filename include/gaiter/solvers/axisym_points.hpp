// SPDX-License-Identifier: BSD-2-Clause
#pragma once

#include <array>
#include <vector>

#include "gaiter/solvers/axisym_mesh.hpp"

namespace gaiter::solvers {

// A cell's points of the DMPlex: itself, its corners counterclockwise from the lower inner one, and its
// sides, the first between corners 0 and 1. `reversed`: the side's own direction is against the growing local
// coordinate.
struct CellPoints {
  PetscInt cell = 0;
  int block = 0, column = 0, row = 0;
  std::array<PetscInt, 4> corner{}, side{};
  std::array<bool, 4> reversed{};
};

// The points of this rank's cells.
PetscErrorCode find_cell_points(DM dm, const AxisymMesh& mesh, std::vector<CellPoints>& points);

}  // namespace gaiter::solvers
