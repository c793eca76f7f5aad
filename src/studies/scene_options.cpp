// SPDX-License-Identifier: BSD-2-Clause
#include "gaiter/studies/scene_options.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <optional>

#include "gaiter/archive/schema.hpp"
#include "gaiter/base/text.hpp"
#include "gaiter/studies/option_values.hpp"
#include "gaiter/studies/request_parser.hpp"

namespace gaiter::studies {

namespace {

using base::InputError;

constexpr std::string_view segment_mark = "<s>";

// Whether to stop first and what to tell meanwhile is not part of what is computed. Nor is where the archive
// goes, which is a text.
bool of_the_run(std::string_view name) {
  return name == "dry_run" || name == "plan" || name == "progress";
}

std::string names_of(std::span<const model::Segment> segments) {
  std::vector<std::string_view> names;
  for (const model::Segment& segment : segments) names.push_back(segment.name);
  return fmt::format("{}", fmt::join(names, ", "));
}

}  // namespace

Parser::Parser(Command command, const std::map<std::string, std::string>& given) : command_(command) {
  for (const auto& [name, text] : given) {
    if (!given_.emplace(base::lower(name), Given{name, text}).second) {
      throw InputError(fmt::format("-{} '{}': given twice; names do not depend on case", name, text));
    }
  }
}

Request Parser::run() {
  read_segments();
  read_settings();
  check_each_module();
  check_counts();
  read_sampling();
  give_bases();
  apply();
  choose_columns();
  check_designs();
  request_.text = resolved_text();
  return std::move(request_);
}

const Setting* Parser::find(std::string_view name) const {
  const auto found = settings_.find(std::string(name));
  return found == settings_.end() ? nullptr : &found->second;
}

bool Parser::swept(std::string_view name) const {
  return std::ranges::any_of(request_.axes, [&](const SweepAxis& axis) { return axis.name == name; });
}

void Parser::missing(const Option& entry, std::string_view name) const {
  // Where a misspelt option is near the missing one, that is the mistake to report.
  const auto& segments = request_.scene.leg.segments;
  for (const std::string& unknown : request_.unknown) {
    if (nearest_option(unknown, segments) == name) throw unknown_option(unknown, segments);
  }
  throw InputError(fmt::format("-{} is missing: {} It must be {}, e.g. '{}'", name, entry.doc, allowed(entry),
                               entry.shown_example()));
}

void Parser::read_segments() {
  const Option& entry = option("leg_segments");
  const auto found = given_.find("leg_segments");
  if (found == given_.end()) {
    for (const auto& [lower_name, given] : given_) request_.unknown.push_back(given.name);
    missing(entry, "leg_segments");
  }
  request_.scene.leg.segments = parse_segments(found->second.name, found->second.text);
  request_.scene.bandage.modules.resize(request_.scene.leg.segments.size());
}

std::optional<Parser::Match> Parser::match(std::string_view lower_name, const Given& given) const {
  for (const Option& entry : option_table()) {
    const bool pattern = entry.name.find('<') != std::string_view::npos;
    if (!pattern && entry.name == lower_name) return Match{&entry, 0};
  }
  const auto& segments = request_.scene.leg.segments;
  for (const Option& entry : option_table()) {
    if (entry.scope != Scope::one_segment) continue;
    const auto at = entry.name.find(segment_mark);
    const std::string_view before = entry.name.substr(0, at), after = entry.name.substr(at + 3);
    if (lower_name.size() <= before.size() + after.size() || !lower_name.starts_with(before) ||
        !lower_name.ends_with(after)) {
      continue;
    }
    const std::string_view middle =
        lower_name.substr(before.size(), lower_name.size() - before.size() - after.size());
    for (std::size_t i = 0; i < segments.size(); ++i) {
      if (base::lower(segments[i].name) == middle) return Match{&entry, i};
    }
    throw InputError(fmt::format("unknown segment '{}' in -{}; the segments are {}", middle, given.name,
                                 names_of(segments)));
  }
  return std::nullopt;
}

void Parser::read_settings() {
  for (const auto& [lower_name, given] : given_) {
    if (lower_name.starts_with("sweep_") && !is_sampling(lower_name)) {
      read_axis(given);
      continue;
    }
    const auto found = match(lower_name, given);
    if (!found) {
      request_.unknown.push_back(given.name);
      continue;
    }
    const Option& entry = *found->option;
    const std::string name = name_for(entry, request_.scene.leg.segments[found->segment].name);
    if (is_sampling(lower_name) && command_ != Command::sweep) refuse_outside_sweep(given);
    if (entry.kind != Kind::text) {
      settings_[name] = {&entry, found->segment, parse_values(entry, given.name, given.text)};
    } else if (name == "output" || name == "axisym_view") {
      std::string& path = name == "output" ? request_.output : request_.axisym_view;
      path = base::trim(given.text);
      if (path.empty()) throw value_error(entry, given.name, given.text, "a value is missing");
    } else if (name == "outputs") {
      read_outputs(given);
    } else if (name == "output_variables") {
      read_output_variables(given);
    } else if (std::ranges::find(entry.commands, Command::report) != entry.commands.end()) {
      throw InputError(fmt::format("-{} '{}': belongs to the command report", given.name, given.text));
    } else if (name == "options_file" || name == "help") {
      // Those of the command line are taken from it before PETSc sees them.
      throw InputError(fmt::format("-{} '{}': belongs on the command line, not in an options file",
                                   given.name, given.text));
    }
  }
  if (request_.output.empty()) request_.output = option("output").default_text;
  std::ranges::sort(request_.axes, {}, &SweepAxis::name);
  if (command_ == Command::sweep && request_.axes.empty()) {
    const auto& segments = request_.scene.leg.segments;
    for (const std::string& unknown : request_.unknown) {
      if (nearest_option(unknown, segments).starts_with("sweep_")) {
        throw unknown_option(unknown, segments);
      }
    }
    throw InputError(
        "sweep: nothing to sweep; give values for an option, e.g. -sweep_bandage_stretch 1.4,1.6");
  }
}

std::size_t Parser::segment_of_output(const Given& given, std::string_view name) const {
  const auto& segments = request_.scene.leg.segments;
  for (std::size_t i = 0; i < segments.size(); ++i)
    if (base::lower(segments[i].name) == base::lower(name)) return i;
  throw value_error(option("outputs"), given.name, given.text,
                    fmt::format("unknown segment '{}', the segments are {}", name, names_of(segments)));
}

// NAME is wanted of all segments, SEGMENT.NAME of one.
void Parser::read_outputs(const Given& given) {
  using model::Wanted;
  const std::vector<std::pair<std::string, bool Wanted::*>> outputs{
      {"pressure_rest", &Wanted::pressure_rest},
      {"pressure_actuated", &Wanted::pressure_actuated},
      {"actuation_drop", &Wanted::actuation_drop},
      {"volume_change", &Wanted::volume_change}};
  const auto& segments = request_.scene.leg.segments;
  model::Goal& goal = request_.scene.goal;
  static_cast<Wanted&>(goal) = {false, false, false, false};
  std::vector<Wanted> own(segments.size(), goal);
  bool differ = false;
  for (const std::string_view item : base::split(given.text)) {
    const std::string_view word = base::trim(item);
    const auto dot = word.find('.');
    const std::string_view name = dot == std::string_view::npos ? word : word.substr(dot + 1);
    const auto found = std::ranges::find(outputs, name, [](const auto& output) { return output.first; });
    if (found == outputs.end()) throw value_error(option("outputs"), given.name, given.text);
    if (dot == std::string_view::npos) {
      goal.*(found->second) = true;
      for (Wanted& wanted : own) wanted.*(found->second) = true;
      request_.outputs.push_back(found->first);
    } else {
      const std::size_t segment = segment_of_output(given, word.substr(0, dot));
      own[segment].*(found->second) = differ = true;
      request_.outputs.push_back(fmt::format("{}.{}", segments[segment].name, found->first));
    }
  }
  if (differ) goal.of_segment = std::move(own);
}

void Parser::read_output_variables(const Given& given) {
  if (base::lower(base::trim(given.text)) == "all") return;
  std::vector<std::string> names, chosen{"status"};
  for (const archive::Column& column : archive::columns()) names.emplace_back(column.name);
  for (const std::string_view item : base::split(given.text)) {
    chosen.emplace_back(base::trim(item));
    if (std::ranges::find(names, chosen.back()) != names.end()) continue;
    const std::string near = base::nearest(chosen.back(), names);
    throw InputError(fmt::format("-{} '{}': no result is named '{}'{}; must be all or some of {}", given.name,
                                 given.text, chosen.back(),
                                 near.empty() ? "" : fmt::format(", did you mean '{}'?", near),
                                 fmt::join(names, ", ")));
  }
  for (const std::string& name : names)
    if (std::ranges::find(chosen, name) != chosen.end()) request_.output_variables.push_back(name);
}

// Those given, or all that there are: without -fidelity auto nothing was planned.
void Parser::choose_columns() {
  request_.columns = request_.output_variables;
  if (request_.scene.fidelity == model::Fidelity::automatic || command_ == Command::tradeoff) return;
  const bool all = request_.columns.empty();
  for (const archive::Column& column : archive::columns()) {
    const std::string name(column.name);
    if (all && !column.of_plan) request_.columns.push_back(name);
    if (!all && column.of_plan && std::ranges::find(request_.columns, name) != request_.columns.end())
      throw InputError(fmt::format("-output_variables '{}': is known with -fidelity 'auto' alone", name));
  }
}

// Values a scene cannot do without, and those that exclude each other.
void Parser::check_each_module() {
  const auto is = [&](const char* name, double choice) {
    const Setting* setting = find(name);
    return setting != nullptr && setting->values[0] == choice;
  };
  const bool needs_compliance = !is("leg_model", static_cast<double>(model::LegModel::rigid)) &&
                                !is("fidelity", static_cast<double>(model::Fidelity::rigid)) &&
                                !is("leg_material", static_cast<double>(model::LegMaterial::neo_hookean));
  const Option& length = option("bandage_<s>_length");
  const Option& stretch = option("bandage_<s>_stretch");
  for (const model::Segment& segment : request_.scene.leg.segments) {
    for (const char* pattern : {"leg_<s>_radius", "leg_<s>_height", "leg_<s>_compliance"}) {
      const Option& entry = option(pattern);
      if (entry.name.ends_with("compliance") && !needs_compliance) continue;
      const std::string name = name_for(entry, segment.name);
      if (!has(name)) missing(entry, name);
    }
    const std::string own_length = name_for(length, segment.name),
                      own_stretch = name_for(stretch, segment.name);
    if (has(own_length) && has(own_stretch)) {
      const auto text = [&](const Option& entry, const std::string& name) {
        const Setting* setting = find(name);
        return setting ? format_values(entry, setting->values) : std::string("swept");
      };
      throw InputError(fmt::format("-{} '{}': give it or -{} '{}', not both", own_length,
                                   text(length, own_length), own_stretch, text(stretch, own_stretch)));
    }
    if (!has(own_length) && !has(own_stretch) && !has("bandage_stretch")) {
      missing(option("bandage_stretch"), "bandage_stretch");
    }
  }
  for (const char* name : {"bandage_ogden_mu", "bandage_ogden_alpha"}) {
    if (!has(name)) missing(option(name), name);
  }
}

void Parser::check_counts() const {
  const Setting& mu = *find("bandage_ogden_mu");
  const Setting& alpha = *find("bandage_ogden_alpha");
  if (mu.values.size() != alpha.values.size()) {
    throw InputError(fmt::format(
        "-bandage_ogden_mu '{}': as many values needed as in -bandage_ogden_alpha '{}', one a term",
        format_values(*mu.option, mu.values), format_values(*alpha.option, alpha.values)));
  }
}

// Segments that have no value of their own in place of this option's.
std::vector<std::size_t> Parser::segments_left_to(const Option& entry) const {
  const auto& segments = request_.scene.leg.segments;
  std::vector<std::size_t> left;
  for (std::size_t i = 0; i < segments.size(); ++i) {
    const bool own = std::ranges::any_of(entry.yields_to, [&](std::string_view pattern) {
      return has(name_for(option(pattern), segments[i].name));
    });
    if (!own) left.push_back(i);
  }
  return left;
}

void Parser::apply() {
  for (const Option& entry : option_table()) {
    if (entry.scope == Scope::one_segment || entry.kind == Kind::text) continue;
    const Setting* setting = find(entry.name);
    if (setting == nullptr && entry.default_text.empty()) continue;
    const std::vector<double> values =
        setting ? setting->values : parse_values(entry, entry.name, entry.default_text);
    if (entry.name == "dry_run") request_.dry_run = values[0] != 0;
    if (entry.name == "plan") request_.plan = values[0] != 0;
    if (entry.name == "progress") request_.progress = static_cast<Progress>(static_cast<int>(values[0]));
    if (entry.name == "comparison")
      request_.comparison = static_cast<Comparison>(static_cast<int>(values[0]));
    if (entry.set == nullptr) continue;
    const auto segments =
        entry.scope == Scope::every_segment ? segments_left_to(entry) : std::vector<std::size_t>{0};
    for (const std::size_t segment : segments) entry.set(request_.scene, segment, values);
  }
  for (const auto& [name, setting] : settings_) {
    if (setting.option->scope == Scope::one_segment) {
      setting.option->set(request_.scene, setting.segment, setting.values);
    }
  }
}

std::string Parser::resolved_text() const {
  std::vector<std::string_view> segments;
  for (const model::Segment& segment : request_.scene.leg.segments) segments.push_back(segment.name);
  std::map<std::string, std::string> lines;
  lines["leg_segments"] =
      segments.size() == 1 ? std::string(segments[0]) : fmt::format("[{}]", fmt::join(segments, ", "));
  for (const Option& entry : option_table()) {
    if (entry.kind == Kind::text || of_the_run(entry.name) || entry.default_text.empty()) continue;
    if (std::ranges::find(entry.commands, command_) == entry.commands.end()) continue;
    lines[std::string(entry.name)] =
        format_values(entry, parse_values(entry, entry.name, entry.default_text));
  }
  if (!request_.outputs.empty()) lines["outputs"] = fmt::format("[{}]", fmt::join(request_.outputs, ", "));
  if (!request_.output_variables.empty())
    lines["output_variables"] = fmt::format("[{}]", fmt::join(request_.output_variables, ", "));
  for (const auto& [name, setting] : settings_) {
    if (!of_the_run(name)) lines[name] = format_values(*setting.option, setting.values);
  }
  for (const SweepAxis& axis : request_.axes) {
    if (axis.option->count.most == 1) lines.erase(axis.name);  // the sweep's values stand in its place
    lines[fmt::format("{}{}", "sweep_", axis.name)] = axis.values.text(*axis.option, axis.component);
  }
  std::string text;
  for (const auto& [name, value] : lines) text += fmt::format("{}: {}\n", name, value);
  return text;
}

Request parse_request(Command command, const std::map<std::string, std::string>& given) {
  return Parser(command, given).run();
}

}  // namespace gaiter::studies
