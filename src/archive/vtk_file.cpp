// SPDX-License-Identifier: BSD-2-Clause
#include "gaiter/archive/vtk_file.hpp"

#include <hdf5_hl.h>

#include <numeric>

#include "gaiter/archive/durable_file.hpp"
#include "gaiter/archive/hdf5.hpp"
#include "gaiter/archive/memory_file.hpp"
#include "gaiter/base/error.hpp"

namespace gaiter::archive {
namespace {

constexpr std::uint8_t lagrange_quadrilateral = 70;
constexpr hsize_t scalar = 1;

// The places in a cell's points, along the first direction first, in VTK's order: corners counterclockwise,
// then inside the sides from the first on, each in the direction of the coordinate, then inside the cell.
std::vector<int> vtk_order(int order) {
  std::vector<std::pair<int, int>> places{{0, 0}, {order, 0}, {order, order}, {0, order}};
  for (int i = 1; i < order; ++i) places.emplace_back(i, 0);
  for (int j = 1; j < order; ++j) places.emplace_back(order, j);
  for (int i = 1; i < order; ++i) places.emplace_back(i, order);
  for (int j = 1; j < order; ++j) places.emplace_back(0, j);
  for (int j = 1; j < order; ++j)
    for (int i = 1; i < order; ++i) places.emplace_back(i, j);
  std::vector<int> result;
  for (const auto& [i, j] : places) result.push_back(i + (order + 1) * j);
  return result;
}

hid_t memory_type(double) {
  return H5T_NATIVE_DOUBLE;
}
hid_t memory_type(std::int64_t) {
  return H5T_NATIVE_INT64;
}
hid_t memory_type(std::int32_t) {
  return H5T_NATIVE_INT32;
}
hid_t memory_type(std::uint8_t) {
  return H5T_NATIVE_UINT8;
}

// A vector, or a table of so many columns.
template <class Number>
void put(hid_t group, const std::string& name, const std::vector<Number>& values, hsize_t columns = scalar) {
  const hsize_t size[] = {values.size() / columns, columns};
  check(H5LTmake_dataset(group, name.c_str(), columns == scalar ? 1 : 2, size, memory_type(Number{}),
                         values.data()),
        "write " + name);
}

void put_text(hid_t group, const std::string& object, const char* attribute, const std::string& text) {
  check(H5LTset_attribute_string(group, object.c_str(), attribute, text.c_str()), "describe " + object);
}

template <class Number>
void put_arrays(hid_t root, const char* name, const std::vector<VtkArray<Number>>& arrays,
                std::size_t tuples) {
  const Id group =
      own(H5Gcreate2(root, name, H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT), "write " + std::string(name));
  for (const auto& array : arrays) {
    if (array.values.size() != tuples * array.components)
      throw base::InternalError(array.name + " has " + std::to_string(array.values.size()) + " values for " +
                                std::to_string(tuples) + " points or cells");
    put(group.get(), array.name, array.values, array.components);
    put_text(group.get(), array.name, "units", array.unit);
    put_text(group.get(), array.name, "long_name", array.long_name);
  }
}

void put_grid(hid_t root, const VtkGrid& grid) {
  const std::vector<int> order = vtk_order(grid.order);
  const std::size_t points = grid.points.size() / 2, cells = grid.cells.size() / order.size();
  std::vector<double> positions;
  for (std::size_t p = 0; p < points; ++p)
    positions.insert(positions.end(), {grid.points[2 * p], grid.points[2 * p + 1], 0.0});
  std::vector<std::int64_t> connectivity, offsets{0};
  for (std::size_t c = 0; c < cells; ++c) {
    for (int place : order) connectivity.push_back(grid.cells[c * order.size() + place]);
    offsets.push_back(static_cast<std::int64_t>(connectivity.size()));
  }
  const auto count = [](std::size_t number) { return std::vector{static_cast<std::int64_t>(number)}; };
  put(root, "NumberOfPoints", count(points));
  put(root, "NumberOfCells", count(cells));
  put(root, "NumberOfConnectivityIds", count(connectivity.size()));
  put(root, "Points", positions, 3);
  put(root, "Connectivity", connectivity);
  put(root, "Offsets", offsets);
  put(root, "Types", std::vector(cells, lagrange_quadrilateral));
  put_arrays(root, "PointData", grid.point_arrays, points);
  put_arrays(root, "CellData", grid.cell_arrays, cells);
}

}  // namespace

void write_vtk(const std::string& path, const VtkGrid& grid) {
  const QuietErrors quiet;
  MemoryFile file(false);
  {
    const Id root =
        own(H5Gcreate2(file.get(), "VTKHDF", H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT), "write a group");
    const long long version[] = {1, 0};
    check(H5LTset_attribute_long_long(file.get(), "VTKHDF", "Version", version, 2), "write the version");
    put_text(file.get(), "VTKHDF", "Type", "UnstructuredGrid");
    put_grid(root.get(), grid);
  }
  write_durably(path, temporary_name(path), {file.close()});
}

}  // namespace gaiter::archive
