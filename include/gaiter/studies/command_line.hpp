// SPDX-License-Identifier: BSD-2-Clause
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "gaiter/studies/option_table.hpp"

namespace gaiter::studies {

// The words of a command line, sorted out before PETSc sees them.
struct CommandLine {
  std::string typed;                // as typed, for the archive
  std::string command;              // first word; empty: none
  std::optional<std::string> help;  // word after -help, or empty text
  std::vector<std::string> options_files;
  std::vector<std::string> others;  // the rest, for PETSc
};

CommandLine split_command_line(int argc, const char* const* argv);

// Throws InputError for a word that is no command, naming the nearest one.
Command parse_command(const std::string& word);

}  // namespace gaiter::studies
