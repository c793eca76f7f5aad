// SPDX-License-Identifier: BSD-2-Clause
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "gaiter/archive/provenance.hpp"

namespace gaiter::archive {

// An option that differs from case to case.
struct SweptVariable {
  std::string name;  // of the option, without the dash
  std::string unit;  // udunits spelling, SI
  std::string long_name;
  std::vector<double> values;  // one a case; those of rank 0 are written
};

// What is known of an archive before anything is solved.
struct Layout {
  std::size_t cases = 1;
  std::vector<std::string> segments;  // names, ankle up
  std::vector<SweptVariable> swept;
  std::vector<std::string> columns;  // names of the results to keep, in the order of schema.hpp; empty: all

  std::size_t rows() const { return cases * segments.size(); }
};

// Creates the file with all variables, dimension scales and attributes: swept values and names are written,
// results hold the fill value (NaN, or -1 for integers). Serial; throws base::InternalError.
void create_archive(const std::string& path, const Layout& layout, const Provenance& provenance);

}  // namespace gaiter::archive
