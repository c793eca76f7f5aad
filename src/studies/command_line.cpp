// SPDX-License-Identifier: BSD-2-Clause
#include "gaiter/studies/command_line.hpp"

#include <array>
#include <cctype>

#include "gaiter/base/error.hpp"
#include "gaiter/base/text.hpp"

namespace gaiter::studies {

namespace {

// A minus and a letter: what PETSc takes for an option. "-1 mm" is a value.
bool is_option(const std::string& word) {
  return word.size() > 1 && word[0] == '-' &&
         (std::isalpha(static_cast<unsigned char>(word[1])) || (word[1] == '-' && word.size() > 2));
}

std::string quoted(const std::string& word) {
  return word.find_first_of(" \t'\"$;&|<>()") == std::string::npos && !word.empty() ? word : "'" + word + "'";
}

}  // namespace

CommandLine split_command_line(int argc, const char* const* argv) {
  CommandLine line{.typed = "gaiter", .command = "", .help = std::nullopt, .options_files = {}, .others = {}};
  std::vector<std::string> words(argv + (argc > 0 ? 1 : 0), argv + argc);
  for (const std::string& word : words) line.typed += " " + quoted(word);
  std::size_t i = 0;
  if (!words.empty() && !is_option(words[0])) line.command = words[i++];
  for (; i < words.size(); ++i) {
    const bool has_value = i + 1 < words.size() && !is_option(words[i + 1]);
    if (words[i] == "-help" || words[i] == "--help" || words[i] == "-h") {
      line.help = has_value ? words[++i] : "";
    } else if (words[i] == "-options_file") {
      if (!has_value) throw base::InputError("-options_file: needs the name of a YAML file");
      line.options_files.push_back(words[++i]);
    } else if (is_option(words[i])) {
      line.others.push_back(words[i]);
      if (has_value) line.others.push_back(words[++i]);
    } else {
      throw base::InputError("'" + words[i] +
                             "' belongs to no option; values with blanks need quotes, as in '1 mm'");
    }
  }
  return line;
}

Command parse_command(const std::string& word) {
  if (word.empty())
    throw base::InputError(
        "a command is missing: solve, sweep, tradeoff or report; gaiter -help lists the options");
  if (word == "solve") return Command::solve;
  if (word == "sweep") return Command::sweep;
  if (word == "report") return Command::report;
  if (word == "tradeoff") return Command::tradeoff;
  const std::array<std::string, 4> commands{"solve", "sweep", "tradeoff", "report"};
  const std::string near = base::nearest(word, commands);
  throw base::InputError(
      "unknown command '" + word + "'" + (near.empty() ? "" : "; did you mean '" + near + "'?") +
      " The commands are solve, sweep, tradeoff and report; gaiter -help lists the options");
}

}  // namespace gaiter::studies
