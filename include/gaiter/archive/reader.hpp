// SPDX-License-Identifier: BSD-2-Clause
#pragma once

#include <cstddef>
#include <map>
#include <string>
#include <vector>

namespace gaiter::archive {

// Text as it is; numbers as the shortest text that reads back to them, lists separated by blanks.
using Attributes = std::map<std::string, std::string>;

struct Variable {
  std::vector<std::string> dimensions;  // names, slowest first
  std::vector<std::size_t> shape;
  std::string type;                // float64, int64, int32, int8 or string
  std::vector<double> numbers;     // row-major; empty for strings
  std::vector<std::string> words;  // empty for numbers
  Attributes attributes;           // unit, long_name, flags
};

struct Archive {
  std::map<std::string, Variable> variables;
  Attributes attributes;
};

// Reads a whole archive into memory. Serial. Throws base::InputError when the file cannot be opened or is not
// HDF5, base::InternalError when reading fails later.
Archive read_archive(const std::string& path);

}  // namespace gaiter::archive
