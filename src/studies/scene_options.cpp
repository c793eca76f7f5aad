// SPDX-License-Identifier: BSD-2-Clause
#include "gaiter/studies/scene_options.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <numbers>
#include <optional>

#include "gaiter/base/text.hpp"
#include "gaiter/studies/axisym_checks.hpp"
#include "gaiter/studies/option_values.hpp"

namespace gaiter::studies {

namespace {

using base::InputError;

constexpr std::string_view sweep_prefix = "sweep_";
constexpr std::string_view segment_mark = "<s>";

struct Given {
  std::string name;  // as the user wrote it
  std::string text;
};

// An option as given, read.
struct Setting {
  const Option* option;
  std::size_t segment;  // 0 where the option belongs to no segment
  std::vector<double> values;
};

std::string names_of(std::span<const model::Segment> segments) {
  std::vector<std::string_view> names;
  for (const model::Segment& segment : segments) names.push_back(segment.name);
  return fmt::format("{}", fmt::join(names, ", "));
}

class Parser {
 public:
  Parser(Command command, const std::map<std::string, std::string>& given);
  Request run();

 private:
  struct Match {
    const Option* option;
    std::size_t segment;
  };

  void read_segments();
  void read_settings();
  void read_axis(const Given& given);
  std::optional<Match> match(std::string_view lower_name, const Given& given) const;
  void check_each_module();
  void apply();
  void check_designs();
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
  apply();
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
    if (lower_name.starts_with(sweep_prefix)) {
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
    if (entry.kind != Kind::text) {
      settings_[name] = {&entry, found->segment, parse_values(entry, given.name, given.text)};
    } else if (name == "output" || name == "axisym_view") {
      std::string& path = name == "output" ? request_.output : request_.axisym_view;
      path = base::trim(given.text);
      if (path.empty()) throw value_error(entry, given.name, given.text, "a value is missing");
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
      if (nearest_option(unknown, segments).starts_with(sweep_prefix)) {
        throw unknown_option(unknown, segments);
      }
    }
    throw InputError(
        "sweep: nothing to sweep; give values for an option, e.g. -sweep_bandage_stretch 1.4,1.6");
  }
}

void Parser::read_axis(const Given& given) {
  const std::string swept_name = base::lower(given.name).substr(sweep_prefix.size());
  const auto found = match(swept_name, given);
  if (!found) {
    request_.unknown.push_back(given.name);
    return;
  }
  if (command_ != Command::sweep) {
    throw InputError(
        fmt::format("-{} '{}': belongs to the command sweep, not to solve", given.name, given.text));
  }
  const Option& entry = *found->option;
  if (!entry.sweepable) {
    std::vector<std::string_view> sweepable;
    for (const Option& other : option_table()) {
      if (other.sweepable) sweepable.push_back(other.name);
    }
    throw InputError(fmt::format("-{} '{}': {} cannot be swept; only physical options of one number can: {}",
                                 given.name, given.text, swept_name, fmt::join(sweepable, ", ")));
  }
  request_.axes.push_back({name_for(entry, request_.scene.leg.segments[found->segment].name),
                           &entry,
                           {found->segment},
                           parse_sweep_values(entry, given.name, given.text)});
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

// Every design must be sound before the first is solved, for wrong input writes nothing. What the checks
// compare grows or falls with each swept value, so a grid is sound where its corners are.
void Parser::check_designs() {
  std::vector<SweepAxis> corners;
  for (SweepAxis& axis : request_.axes) {
    if (axis.option->scope == Scope::every_segment) axis.segments = segments_left_to(*axis.option);
    if (axis.segments.empty()) {
      throw InputError(fmt::format(
          "-sweep_{}: every segment has a value of its own, nothing is left to sweep", axis.name));
    }
    const auto [least, most] = std::ranges::minmax(axis.values);
    corners.push_back(axis);
    corners.back().values = least == most ? std::vector{least} : std::vector{least, most};
  }
  const Designs designs(request_.axes), corner_designs(std::move(corners));
  for (std::int64_t i = 0; i < corner_designs.size(); ++i) {
    corner_designs.apply(i, request_.scene);
    check_scene(request_.scene);
  }
  designs.apply(0, request_.scene);
}

std::string Parser::resolved_text() const {
  std::vector<std::string_view> segments;
  for (const model::Segment& segment : request_.scene.leg.segments) segments.push_back(segment.name);
  std::map<std::string, std::string> lines;
  lines["leg_segments"] =
      segments.size() == 1 ? std::string(segments[0]) : fmt::format("[{}]", fmt::join(segments, ", "));
  for (const Option& entry : option_table()) {
    // Where the archive goes and whether to stop first are not part of what is computed.
    if (entry.kind == Kind::text || entry.name == "dry_run" || entry.default_text.empty()) continue;
    lines[std::string(entry.name)] =
        format_values(entry, parse_values(entry, entry.name, entry.default_text));
  }
  for (const auto& [name, setting] : settings_) {
    if (name != "dry_run") lines[name] = format_values(*setting.option, setting.values);
  }
  for (const SweepAxis& axis : request_.axes) {
    lines.erase(axis.name);  // the sweep's values stand in its place
    std::vector<std::string> values;
    for (const double value : axis.values) values.push_back(format_number(*axis.option, value));
    lines[fmt::format("{}{}", sweep_prefix, axis.name)] =
        values.size() == 1 ? values[0] : fmt::format("[{}]", fmt::join(values, ", "));
  }
  std::string text;
  for (const auto& [name, value] : lines) text += fmt::format("{}: {}\n", name, value);
  return text;
}

}  // namespace

Request parse_request(Command command, const std::map<std::string, std::string>& given) {
  return Parser(command, given).run();
}

void check_scene(const model::Scene& scene) {
  const model::Bandage& bandage = scene.bandage;
  for (std::size_t i = 0; i < bandage.modules.size(); ++i) {
    const model::Module& module = bandage.modules[i];
    const model::Segment& segment = scene.leg.segments[i];
    const double radius =
        module.length > 0 ? module.length / (2 * std::numbers::pi) : segment.mean_radius() / module.stretch;
    // The hole's radius: the reference radius less the part of the wall inside it.
    const double inside = bandage.length_at == model::LengthAt::outer    ? bandage.thickness
                          : bandage.length_at == model::LengthAt::middle ? 0.5 * bandage.thickness
                                                                         : 0;
    if (inside >= radius) {
      const std::string size = module.length > 0 ? fmt::format("length {} m", module.length)
                                                 : fmt::format("stretch {}", module.stretch);
      throw InputError(
          fmt::format("-bandage_thickness '{} m': the module on {} ({}) has a reference radius of {:.6g} m, "
                      "so the wall must be less than {:.6g} m",
                      bandage.thickness, segment.name, size, radius, radius * bandage.thickness / inside));
    }
    const model::Compliance& law = segment.compliance;
    if (law.a + law.c <= -1) {
      throw InputError(
          fmt::format("-leg_{}_compliance '{}, {} Pa-1, {}, {} Pa-1': a + c must be greater than -1",
                      segment.name, law.a, law.b, law.c, law.d));
    }
  }
  double twice_modulus = 0;
  for (const model::OgdenTerm& term : bandage.ogden) twice_modulus += term.mu * term.alpha;
  if (!(twice_modulus > 0)) {
    std::vector<double> mu, alpha;
    for (const model::OgdenTerm& term : bandage.ogden) {
      mu.push_back(term.mu);
      alpha.push_back(term.alpha);
    }
    throw InputError(
        fmt::format("-bandage_ogden_mu '{}' with -bandage_ogden_alpha '{}': the initial shear modulus, half "
                    "the sum of mu alpha, is {:.6g} Pa; it must be greater than 0 Pa",
                    format_values(option("bandage_ogden_mu"), mu),
                    format_values(option("bandage_ogden_alpha"), alpha), 0.5 * twice_modulus));
  }
  if (scene.fidelity == model::Fidelity::axisym) check_axisym(scene);
}

}  // namespace gaiter::studies
