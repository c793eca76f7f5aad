// SPDX-License-Identifier: BSD-2-Clause
#include "gaiter/studies/option_names.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <set>

#include "gaiter/base/text.hpp"
#include "gaiter/studies/option_table.hpp"
#include "gaiter/studies/option_values.hpp"

namespace gaiter::studies {

using base::InputError;

namespace {

// The words that follow leg_ and bandage_ in the table. A segment of that name would be mistaken for an
// option.
std::set<std::string, std::less<>> reserved_words() {
  std::set<std::string, std::less<>> words;
  for (const Option& option : option_table()) {
    for (const std::string_view prefix : {"leg_", "bandage_"}) {
      if (!option.name.starts_with(prefix)) continue;
      std::string_view rest = option.name.substr(prefix.size());
      if (rest.starts_with("<s>_")) rest.remove_prefix(4);
      words.emplace(rest.substr(0, rest.find('_')));
    }
  }
  return words;
}

// PETSc's options that are given most often, to tell what a misspelt one was meant to be.
constexpr std::array<std::string_view, 41> petsc_options{
    "axisym_fieldsplit_constraint_ksp_rtol",
    "axisym_fieldsplit_constraint_ksp_type",
    "axisym_fieldsplit_constraint_pc_type",
    "axisym_fieldsplit_displacement_ksp_rtol",
    "axisym_fieldsplit_displacement_ksp_type",
    "axisym_fieldsplit_displacement_pc_type",
    "axisym_ksp_converged_reason",
    "axisym_ksp_rtol",
    "axisym_ksp_type",
    "axisym_mat_mumps_icntl_13",
    "axisym_mat_mumps_icntl_14",
    "axisym_mat_no_inode",
    "axisym_pc_factor_mat_ordering_type",
    "axisym_pc_factor_mat_solver_type",
    "axisym_pc_fieldsplit_schur_precondition",
    "axisym_pc_fieldsplit_type",
    "axisym_pc_type",
    "axisym_snes_converged_reason",
    "axisym_snes_max_it",
    "axisym_snes_monitor",
    "axisym_snes_stol",
    "log_view",
    "options_left",
    "options_view",
    "slice_ksp_converged_reason",
    "slice_ksp_monitor",
    "slice_ksp_rtol",
    "slice_ksp_type",
    "slice_ksp_view",
    "slice_mat_type",
    "slice_pc_type",
    "slice_snes_converged_reason",
    "slice_snes_linesearch_monitor",
    "slice_snes_linesearch_type",
    "slice_snes_max_it",
    "slice_snes_monitor",
    "slice_snes_rtol",
    "slice_snes_test_jacobian",
    "slice_snes_type",
    "slice_snes_view",
    "info",
};

}  // namespace

std::vector<model::Segment> parse_segments(std::string_view name, std::string_view text) {
  const Option& entry = option("leg_segments");
  const auto reserved = reserved_words();
  constexpr std::string_view letters = "abcdefghijklmnopqrstuvwxyz0123456789_";
  std::vector<model::Segment> segments;
  std::set<std::string> seen;
  for (const std::string_view item : base::split(text)) {
    const std::string word = base::lower(item);
    if (word.empty()) throw value_error(entry, name, text, "a name is missing");
    if (word.find_first_not_of(letters) != std::string::npos) {
      throw value_error(entry, name, text, fmt::format("'{}' is no name", item));
    }
    if (reserved.contains(word)) {
      throw value_error(entry, name, text, fmt::format("'{}' is a word of the option names", item));
    }
    if (!seen.insert(word).second) {
      throw value_error(entry, name, text, fmt::format("'{}' is there twice", item));
    }
    segments.emplace_back().name = item;
  }
  return segments;
}

std::string nearest_option(std::string_view name, std::span<const model::Segment> segments) {
  std::vector<std::string> candidates;
  const auto add = [&](const Option& entry, std::string_view segment) {
    const std::string name = name_for(entry, segment);
    candidates.push_back(name);
    if (!entry.sweepable) return;
    if (entry.count.most == 1) candidates.push_back("sweep_" + name);
    for (std::size_t i = 0; entry.count.most > 1 && i < entry.count.most; ++i)
      candidates.push_back(fmt::format("sweep_{}_{}", name, component_name(entry, i)));
  };
  for (const Option& entry : option_table()) {
    if (entry.name == "sweep_<option>") continue;
    if (entry.scope != Scope::one_segment) {
      add(entry, "");
      continue;
    }
    for (const model::Segment& segment : segments) add(entry, segment.name);
  }
  for (const std::string_view given : petsc_options) {
    candidates.emplace_back(given);
    if (given.starts_with("slice_")) candidates.push_back("sliding_" + std::string(given.substr(6)));
  }
  std::vector<std::string> lower;
  for (const std::string& candidate : candidates) lower.push_back(base::lower(candidate));
  const std::string best = base::nearest(base::lower(name), lower);
  if (best.empty()) return best;
  return candidates[static_cast<std::size_t>(std::ranges::find(lower, best) - lower.begin())];
}

base::InputError unknown_option(std::string_view name, std::span<const model::Segment> segments) {
  const std::string best = nearest_option(name, segments);
  if (best.empty()) return InputError(fmt::format("unknown option -{}; -help lists all", name));
  return InputError(fmt::format("unknown option -{}; did you mean -{}?", name, best));
}

}  // namespace gaiter::studies
