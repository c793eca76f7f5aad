// SPDX-License-Identifier: BSD-2-Clause
#pragma once

#include <petscdmplex.h>

#include <array>
#include <vector>

#include "gaiter/model/scene.hpp"
#include "gaiter/petsc/handle.hpp"

namespace gaiter::solvers {

using Plex = petsc::Handle<DM, DMDestroy>;

// A body as a structured block of quadrilaterals: columns along R, rows along Z. Every rank knows all blocks;
// the DMPlex made of them is what is distributed. Lengths in units of the mesh (see AxisymMesh::length).
struct AxisymBlock {
  bool tube = false;                 // bandage, else leg
  std::vector<double> height;        // of the lines between rows
  std::vector<double> inner, outer;  // radii at these lines
  std::vector<double> across;        // place of the lines between columns, from 0 (inner) to 1 (outer)
  std::vector<std::size_t> segment;  // of the scene, a row each
  int first_cell = 0, first_vertex = 0;

  int columns() const { return static_cast<int>(across.size()) - 1; }
  int rows() const { return static_cast<int>(height.size()) - 1; }
  int cell(int column, int row) const { return first_cell + column + columns() * row; }
  int vertex(int column, int row) const { return first_vertex + column + (columns() + 1) * row; }
  std::array<double, 2> position(int column, int row) const {
    return {inner[row] + across[column] * (outer[row] - inner[row]), height[row]};
  }
  std::array<std::array<double, 2>, 4> corners(int column, int row) const {
    return {position(column, row), position(column + 1, row), position(column + 1, row + 1),
            position(column, row + 1)};
  }
};

// How fine: cells before refinement; each refinement halves them all. `grading` is the ratio of the largest
// to the smallest cell, small at the ends of every tube, at both ends of the leg and at its skin.
struct AxisymResolution {
  int tube_rows = 12, tube_columns = 1;
  int leg_rows = 10, leg_columns = 5;
  double end_grading = 8, skin_grading = 6;
  int refinements = 0;
  int row_refinements = 0, column_refinements = 0;  // more, of the rows or the columns alone
};

struct AxisymMesh {
  std::vector<AxisymBlock> blocks;  // tubes, in the segments' order, then the leg
  double length = 1;                // unit of length [m]
  int cells = 0, vertices = 0;

  const AxisymBlock& leg() const { return blocks.back(); }
};

// The meshes of segments first to last (inclusive) of a scene: one leg block, one tube for each.
AxisymMesh make_axisym_mesh(const model::Scene& scene, std::size_t first, std::size_t last,
                            const AxisymResolution& resolution);

// The DMPlex of a mesh, distributed. The labels "cell" and "vertex" hold the number in the mesh of each
// point.
// @note Collective.
Plex make_plex(MPI_Comm comm, const AxisymMesh& mesh);

}  // namespace gaiter::solvers
