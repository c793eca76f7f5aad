// SPDX-License-Identifier: BSD-2-Clause
#pragma once

#include <cstddef>
#include <limits>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "gaiter/model/scene.hpp"

namespace gaiter::studies {

enum class Command { solve, sweep, tradeoff, report };
enum class Comparison { none, paper };  // paper: the paper's printed results beside the computed ones

enum class Progress { automatic, line, log, off };  // how a sweep tells how far it is

// How an option's text is read. Every kind but text becomes numbers: a choice its position in the list, a
// flag 0 or 1.
enum class Kind { quantity, count, choice, flag, text };

// What an option belongs to. An option of every_segment sets all segments but those with a value of their
// own; one_segment is a pattern with <s> for the segment's name; program options leave the scene alone.
enum class Scope { scene, every_segment, one_segment, program };

constexpr double infinity = std::numeric_limits<double>::infinity();

// What one number may be. A closed infinite end admits infinity itself. With `magnitude`, the range is that
// of the absolute value and both signs are allowed.
struct Range {
  double low = -infinity;
  double high = infinity;
  bool low_open = false;
  bool high_open = false;
  bool magnitude = false;

  bool contains(double value) const;
};

// One of the numbers of a list; the last of an option holds for all that follow.
struct Component {
  std::string_view label = "";
  std::string_view unit = "1";  // SI, as udunits writes it
  Range range = {};
};

struct ValueCount {
  std::size_t least = 1;
  std::size_t most = 1;
};

// A word that stands for a number, such as `auto`.
struct Word {
  std::string_view text = "";
  double value = 0;
};

// Puts an option's numbers into the scene; `segment` is ignored by options that belong to none.
using Setter = void (*)(model::Scene& scene, std::size_t segment, std::span<const double> values);

// All there is to know of one option: reading, range check, help and README come from here.
struct Option {
  std::string_view name;  // without the dash; <s> stands for the name of a segment
  Kind kind = Kind::quantity;
  Scope scope = Scope::scene;
  ValueCount count = {};
  std::vector<Component> components = {};      // kinds quantity and count
  std::vector<std::string_view> choices = {};  // kind choice, in the order of the model's enumeration
  Word word = {};
  std::string_view format = "";        // kind text: what it may be
  std::string_view default_text = "";  // empty: none
  std::string_view example = "";       // where there is no default
  std::string_view doc = "";
  bool sweepable = false;
  std::vector<Command> commands = {Command::solve, Command::sweep, Command::tradeoff};
  std::vector<std::string_view> yields_to = {};  // patterns by which a segment takes a value of its own
  Setter set = nullptr;                          // null: a program option

  std::string_view shown_example() const { return example.empty() ? default_text : example; }
  std::string_view unit() const { return components.empty() ? "1" : components.front().unit; }
  const Component& component(std::size_t i) const {
    return i < components.size() ? components[i] : components.back();
  }
};

// Those that belong to the program and not to a scene, in any order.
std::vector<Option> program_options();

// Those of the slices and the points through the wall, in any order.
std::vector<Option> slice_options();

// All options, sorted by name. PETSc's own options (slice_snes_..., slice_ksp_...) are not in it.
std::span<const Option> option_table();

// The option of exactly this name or pattern; it must exist.
const Option& option(std::string_view name);

// The name of an option for one segment: leg_<s>_radius, r6 -> leg_r6_radius. Other names stay as they are.
std::string name_for(const Option& option, std::string_view segment);

// What follows the name of an option of several numbers where one of them is swept: the number's label, or
// its place, counted from 1. leg_r6_radius -> leg_r6_radius_lower; bandage_ogden_mu -> bandage_ogden_mu_2.
std::string component_name(const Option& option, std::size_t component);

}  // namespace gaiter::studies
