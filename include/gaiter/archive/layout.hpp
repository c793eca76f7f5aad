// SPDX-License-Identifier: BSD-2-Clause
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "gaiter/archive/schema.hpp"
#include "gaiter/model/result.hpp"

namespace gaiter::archive {

// What differs from case to case, such as an option.
struct SweptVariable {
  std::string name;  // of an option: without the dash
  std::string unit;  // udunits spelling, SI
  std::string long_name;
  std::vector<std::string> words = {};  // of an enumeration, at most 127; word i stands for the value i
};

// What is known of an archive before anything is solved. Its size does not grow with the number of cases.
struct Layout {
  std::size_t cases = 1;
  std::vector<std::string> segments;  // names, ankle up
  std::vector<SweptVariable> swept;
  std::vector<std::string> columns;  // results to keep, as choose_columns() takes them; empty: all

  std::size_t rows() const { return cases * segments.size(); }
};

// The cases first, first + 1, ... that one file holds, and the cases in one HDF5 chunk of its variables.
struct CaseRange {
  std::size_t first = 0;
  std::size_t count = 1;
  std::size_t chunk = 1;
};

// Results of consecutive cases. Rows are case by case, swept values one vector per variable of the layout.
struct CaseResults {
  std::span<const model::SegmentResult> rows;
  std::span<const double> wall_times;  // [s]
  std::span<const std::vector<double>> swept_values;
};

// A variable of the file besides its dimensions `case` and `segment`.
struct FileVariable {
  std::string name;
  std::string_view unit;  // empty for enumerations
  std::string_view long_name;
  Stored stored = Stored::float64;
  bool per_segment = false;                  // over (case, segment), otherwise over (case)
  std::vector<std::string_view> flag_words;  // of an enumeration
  const Column* column = nullptr;            // of a result
  std::size_t swept = 0;                     // position in Layout::swept; past its end: the wall time
};

// All variables, in the order in which they are written. The layout must outlive them.
std::vector<FileVariable> variables_of(const Layout& layout);

// Throws base::InternalError unless there are as many results as the layout and the number of cases ask for.
void require_complete(const Layout& layout, std::size_t cases, const CaseResults& results);

// The variable's values of all cases, as they are stored, to `out`.
void gather(const FileVariable& variable, const CaseResults& results, std::byte* out);

}  // namespace gaiter::archive
