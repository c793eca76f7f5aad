// SPDX-License-Identifier: BSD-2-Clause
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace gaiter::archive {

// An array of a grid: `components` numbers of each point or cell in turn.
template <class Number>
struct VtkArray {
  std::string name, unit, long_name;
  int components = 1;
  std::vector<Number> values;
};

// Quadrilaterals of one order in the plane: (order + 1)^2 points each, equispaced on the reference cell.
struct VtkGrid {
  int order = 2;
  std::vector<double> points;       // x, y of each
  std::vector<std::int64_t> cells;  // points of each, along the first direction first
  std::vector<VtkArray<double>> point_arrays;
  std::vector<VtkArray<std::int32_t>> cell_arrays;
};

// Writes a grid as VTKHDF 1.0, which ParaView from 5.10 on and VTK from 9.1 on (vtkHDFReader) open: an
// UnstructuredGrid of one piece, of Lagrange quadrilaterals (VTK's cell type 70). Units and names are
// attributes of the arrays as in an archive. The final name appears, or is replaced, when the file is
// complete. Throws base::InternalError. Not collective.
// Source: https://docs.vtk.org/en/latest/vtk_file_formats/vtkhdf_file_format/vtkhdf_specifications.html
void write_vtk(const std::string& path, const VtkGrid& grid);

}  // namespace gaiter::archive
