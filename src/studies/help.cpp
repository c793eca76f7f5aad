// SPDX-License-Identifier: BSD-2-Clause
#include "gaiter/studies/help.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "gaiter/studies/option_table.hpp"
#include "gaiter/studies/option_values.hpp"

namespace gaiter::studies {

namespace {

std::string_view unit_column(const Option& option) {
  if (option.kind != Kind::quantity) return "";
  const bool same =
      std::ranges::all_of(option.components, [&](const Component& c) { return c.unit == option.unit(); });
  return same ? option.unit() : "1, Pa-1, 1, Pa-1";
}

std::string default_column(const Option& option) {
  return option.default_text.empty() ? "-" : std::string(option.default_text);
}

}  // namespace

std::string help_text() {
  std::string text =
      "gaiter COMMAND [-options_file FILE.yaml] [-option value ...]\n"
      "\n"
      "Commands\n"
      "  solve   one scene: prints a table, writes an archive\n"
      "  sweep   many designs: -sweep_<option> SPEC for each option that varies, SPEC being a list 1.4,1.6,\n"
      "          linspace(lo,hi,n), logspace(lo,hi,n), uniform(lo,hi) or normal(mean,sd); run again, the "
      "same\n"
      "          command goes on where it was stopped\n"
      "  tradeoff  every model of one scene, coarse to fine, against the finest: error and cost\n"
      "  report  an archive as an HTML page with figures: -archive FILE.h5\n"
      "\n"
      "Values carry units (\"1 mm\", \"11.3 kV\", \"28.5 mmHg\"); a bare number is SI. A list is separated "
      "by\n"
      "commas; a unit after its last number holds for all. <s> is the name of a segment of the leg.\n"
      "Options marked * can be swept, one number at a time. PETSc's options tune the solver: "
      "-slice_snes_..., -slice_ksp_...\n"
      "\n"
      "Options\n";
  std::size_t name = 0, unit = 0, default_text = 0;
  for (const Option& option : option_table()) {
    name = std::max(name, option.name.size());
    unit = std::max(unit, unit_column(option).size());
    default_text = std::max(default_text, default_column(option).size());
  }
  for (const Option& option : option_table()) {
    text += fmt::format("  -{:<{}} {} {:<{}}  {:<{}}  {}\n", option.name, name, option.sweepable ? '*' : ' ',
                        unit_column(option), unit, default_column(option), default_text, allowed(option));
    text += fmt::format("      {}", option.doc);
    if (!option.example.empty()) text += fmt::format(" E.g. {}", option.example);
    text += "\n";
  }
  return text;
}

std::string help_markdown() {
  std::string text =
      "| option | unit | default | allowed | meaning | can be swept |\n"
      "|---|---|---|---|---|---|\n";
  for (const Option& option : option_table()) {
    text += fmt::format("| `-{}` | {} | {} | {} | {} | {} |\n", option.name, unit_column(option),
                        option.default_text.empty() ? "" : fmt::format("`{}`", option.default_text),
                        allowed(option), option.doc, option.sweepable ? "yes" : "");
  }
  return text;
}

}  // namespace gaiter::studies
