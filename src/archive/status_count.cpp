// SPDX-License-Identifier: BSD-2-Clause
#include "gaiter/archive/status_count.hpp"

#include <hdf5.h>

#include <algorithm>
#include <vector>

#include "gaiter/archive/hdf5.hpp"

namespace gaiter::archive {

StatusCount count_status(const std::string& path) {
  constexpr hsize_t most_rows = 1 << 20;  // of the archive in memory at a time
  const QuietErrors quiet;
  const Id file = own(H5Fopen(path.c_str(), H5F_ACC_RDONLY, H5P_DEFAULT), "open " + path);
  const Id variable = own(H5Dopen2(file.get(), "status", H5P_DEFAULT), "open variable status");
  const Id space = own(H5Dget_space(variable.get()), "read variable status");
  hsize_t shape[2] = {0, 0};
  check(H5Sget_simple_extent_dims(space.get(), shape, nullptr), "read variable status");
  const hsize_t step = std::max<hsize_t>(1, most_rows / std::max<hsize_t>(1, shape[1]));
  std::vector<signed char> values(step * shape[1]);
  StatusCount count;
  bool invalid_found = false;
  for (hsize_t first = 0; first < shape[0]; first += step) {
    const hsize_t start[2] = {first, 0}, size[2] = {std::min(step, shape[0] - first), shape[1]};
    check(H5Sselect_hyperslab(space.get(), H5S_SELECT_SET, start, nullptr, size, nullptr), "select rows");
    const Id memory = own(H5Screate_simple(2, size, nullptr), "select rows");
    check(H5Dread(variable.get(), H5T_NATIVE_SCHAR, memory.get(), space.get(), H5P_DEFAULT, values.data()),
          "read variable status");
    for (hsize_t i = 0; i < size[0] * size[1]; ++i) {
      const signed char value = values[i];
      if (value < 0 || static_cast<std::size_t>(value) >= count.rows.size()) continue;
      ++count.rows[static_cast<std::size_t>(value)];
      if (invalid_found || value != static_cast<signed char>(model::Status::invalid)) continue;
      invalid_found = true;
      count.first_invalid_case = first + i / shape[1];
    }
  }
  return count;
}

}  // namespace gaiter::archive
