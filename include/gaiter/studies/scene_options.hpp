// SPDX-License-Identifier: BSD-2-Clause
#pragma once

#include <map>
#include <string>
#include <vector>

#include "gaiter/model/scene.hpp"
#include "gaiter/studies/designs.hpp"
#include "gaiter/studies/option_names.hpp"
#include "gaiter/studies/option_table.hpp"

namespace gaiter::studies {

// What the user asks for, read from the options and checked.
struct Request {
  model::Scene scene;                         // of a sweep: its first design
  std::string output;                         // file name of the archive
  std::vector<std::string> output_variables;  // of the results as given, in the schema's order; empty: all
  std::vector<std::string> columns;  // results that the archive keeps, for archive::Layout; empty: all
  std::string axisym_view;  // file name from which those of the finite element fields are made; empty: none
  std::vector<std::string> outputs;  // as given, for -fidelity auto; empty: its default
  bool dry_run = false;
  bool plan = false;
  Comparison comparison = Comparison::none;
  Progress progress = Progress::automatic;
  std::vector<SweepAxis> axes;  // sorted by name; empty for solve
  Sampling sampling;
  std::vector<std::string> unknown;  // given, but not ours: PETSc's, or misspelt
  std::string text;  // YAML that, read as -options_file, gives this request again; without output, dry_run,
                     // plan and progress
};

// Reads the options given, name without dash -> text. Throws InputError; unknown names alone are returned,
// since some of them are PETSc's. Names do not depend on case, as PETSc's do not. The same on every rank.
Request parse_request(Command command, const std::map<std::string, std::string>& given);

}  // namespace gaiter::studies
