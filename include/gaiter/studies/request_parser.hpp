// SPDX-License-Identifier: BSD-2-Clause
#pragma once

#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "gaiter/studies/scene_options.hpp"

namespace gaiter::studies {

// An option as the user wrote it.
struct Given {
  std::string name;
  std::string text;
};

// An option as given, read.
struct Setting {
  const Option* option;
  std::size_t segment;  // 0 where the option belongs to no segment
  std::vector<double> values;
};

// The options that say how a sweep's designs are chosen, and not what is swept.
bool is_sampling(std::string_view lower_name);

// Throws InputError: this belongs to the command sweep.
[[noreturn]] void refuse_outside_sweep(const Given& given);

// Reads the options of one command; parse_request is what others call. What belongs to sweeps alone is in
// sweep_options.cpp.
class Parser {
 public:
  Parser(Command command, const std::map<std::string, std::string>& given);
  Request run();

 private:
  struct Match {
    const Option* option;
    std::size_t segment;
    int component = -1;  // of a swept option of several numbers
  };

  void read_segments();
  void read_settings();
  void read_outputs(const Given& given);
  std::size_t segment_of_output(const Given& given, std::string_view name) const;
  void read_output_variables(const Given& given);
  void choose_columns();
  void read_axis(const Given& given);
  std::optional<Match> match(std::string_view lower_name, const Given& given) const;
  Match match_swept(std::string_view lower_name, const Given& given) const;
  void read_sampling();
  void give_bases();
  void check_each_module();
  void apply();
  void check_designs();
  void check_corners(const Designs& designs);
  std::vector<std::size_t> segments_left_to(const Option& entry) const;
  void check_counts() const;
  std::string resolved_text() const;

  const Setting* find(std::string_view name) const;
  bool swept(std::string_view name) const;
  bool has(std::string_view name) const { return find(name) != nullptr || swept(name); }
  [[noreturn]] void missing(const Option& entry, std::string_view name) const;

  Command command_;
  std::map<std::string, Given> given_;       // by name in lower case
  std::map<std::string, Setting> settings_;  // by name, with the segment's name in it
  Request request_;
};

}  // namespace gaiter::studies
