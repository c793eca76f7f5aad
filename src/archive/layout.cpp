// SPDX-License-Identifier: BSD-2-Clause
#include "gaiter/archive/layout.hpp"

#include <algorithm>
#include <cstring>

#include "gaiter/base/error.hpp"

namespace gaiter::archive {
namespace {

void require_count(const std::string& what, std::size_t got, std::size_t expected) {
  if (got != expected) {
    throw base::InternalError(std::to_string(got) + " " + what + " given, " + std::to_string(expected) +
                              " expected");
  }
}

}  // namespace

std::vector<FileVariable> variables_of(const Layout& layout) {
  std::vector<FileVariable> variables;
  for (const Column* column : choose_columns(layout.columns)) {
    variables.push_back({std::string(column->name), column->unit, column->long_name, stored_as(*column), true,
                         flag_words(*column), column, 0});
  }
  for (std::size_t i = 0; i < layout.swept.size(); ++i) {
    const SweptVariable& swept = layout.swept[i];
    variables.push_back({swept.name,
                         swept.unit,
                         swept.long_name,
                         swept.words.empty() ? Stored::float64 : Stored::int8,
                         false,
                         {swept.words.begin(), swept.words.end()},
                         nullptr,
                         i});
  }
  variables.push_back({"wall_time",
                       "s",
                       "wall-clock time that the case took",
                       Stored::float64,
                       false,
                       {},
                       nullptr,
                       layout.swept.size()});
  return variables;
}

void require_complete(const Layout& layout, std::size_t cases, const CaseResults& results) {
  require_count("rows", results.rows.size(), cases * layout.segments.size());
  require_count("wall times", results.wall_times.size(), cases);
  require_count("swept variables", results.swept_values.size(), layout.swept.size());
  for (std::size_t i = 0; i < layout.swept.size(); ++i) {
    require_count("values of " + layout.swept[i].name, results.swept_values[i].size(), cases);
  }
}

void gather(const FileVariable& variable, const CaseResults& results, std::byte* out) {
  if (variable.column != nullptr) {
    gather(*variable.column, results.rows, out);
    return;
  }
  const std::span<const double> values = variable.swept < results.swept_values.size()
                                             ? results.swept_values[variable.swept]
                                             : results.wall_times;
  if (variable.stored == Stored::int8) {
    std::transform(values.begin(), values.end(), out,
                   [](double value) { return static_cast<std::byte>(value); });
    return;
  }
  std::memcpy(out, values.data(), values.size_bytes());
}

}  // namespace gaiter::archive
