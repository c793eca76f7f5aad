// SPDX-License-Identifier: BSD-2-Clause
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

#include "gaiter/base/text.hpp"
#include "gaiter/studies/option_values.hpp"
#include "gaiter/studies/request_parser.hpp"
#include "gaiter/studies/scene_checks.hpp"

namespace gaiter::studies {

using base::InputError;

namespace {

constexpr std::string_view sweep_prefix = "sweep_";

}  // namespace

bool is_sampling(std::string_view lower_name) {
  return lower_name == "sweep_sampler" || lower_name == "sweep_samples" || lower_name == "sweep_seed";
}

[[noreturn]] void refuse_outside_sweep(const Given& given) {
  throw InputError(
      fmt::format("-{} '{}': belongs to the command sweep, not to solve", given.name, given.text));
}

// What a name after sweep_ means: an option, or one number of an option of several. No option: null.
Parser::Match Parser::match_swept(std::string_view lower_name, const Given& given) const {
  if (const auto found = match(lower_name, given)) return *found;
  const auto cut = lower_name.rfind('_');
  if (cut == std::string_view::npos) return {nullptr, 0};
  const auto found = match(lower_name.substr(0, cut), given);
  if (!found || found->option->count.most == 1) return {nullptr, 0};
  const Option& entry = *found->option;
  for (std::size_t i = 0; i < entry.count.most; ++i)
    if (component_name(entry, i) == lower_name.substr(cut + 1))
      return {&entry, found->segment, static_cast<int>(i)};
  return {nullptr, 0};
}

void Parser::read_axis(const Given& given) {
  const std::string swept_name = base::lower(given.name).substr(sweep_prefix.size());
  const auto [found, segment, component] = match_swept(swept_name, given);
  if (found == nullptr) {
    request_.unknown.push_back(given.name);
    return;
  }
  if (command_ != Command::sweep) refuse_outside_sweep(given);
  const Option& entry = *found;
  if (!entry.sweepable) {
    std::vector<std::string_view> sweepable;
    for (const Option& other : option_table()) {
      if (other.sweepable) sweepable.push_back(other.name);
    }
    throw InputError(fmt::format("-{} '{}': {} cannot be swept; only options that are numbers can: {}",
                                 given.name, given.text, swept_name, fmt::join(sweepable, ", ")));
  }
  std::string name = name_for(entry, request_.scene.leg.segments[segment].name);
  if (entry.count.most > 1 && component < 0) {
    std::vector<std::string> names;
    for (std::size_t i = 0; i < entry.count.most; ++i)
      names.push_back(fmt::format("-sweep_{}_{}", name, component_name(entry, i)));
    throw InputError(fmt::format("-{} '{}': {} has several numbers, sweep them one by one: {}", given.name,
                                 given.text, name, fmt::join(names, ", ")));
  }
  const std::size_t number = component < 0 ? 0 : static_cast<std::size_t>(component);
  SweepValues values = parse_sweep_values(entry, number, given.name, given.text);
  if (component >= 0) name += "_" + component_name(entry, number);
  request_.axes.push_back({name, &entry, number, {segment}, {}, std::move(values)});
}

void Parser::read_sampling() {
  if (command_ != Command::sweep) return;
  Sampling& sampling = request_.sampling;
  if (const Setting* sampler = find("sweep_sampler"))
    sampling.sampler = static_cast<Sampler>(static_cast<int>(sampler->values[0]));
  if (const Setting* seed = find("sweep_seed")) sampling.seed = static_cast<std::uint64_t>(seed->values[0]);
  const Setting* samples = find("sweep_samples");
  if (samples) sampling.samples = static_cast<std::int64_t>(samples->values[0]);
  if (samples && sampling.sampler == Sampler::grid)
    throw InputError(
        fmt::format("-sweep_samples '{}': a grid has as many designs as its values give; use it with "
                    "-sweep_sampler sobol "
                    "or random",
                    sampling.samples));
  if (!samples && sampling.sampler != Sampler::grid) missing(option("sweep_samples"), "sweep_samples");
}

// The numbers of an option that its sweep leaves as they are.
void Parser::give_bases() {
  for (SweepAxis& axis : request_.axes) {
    if (axis.option->count.most == 1) {
      axis.base = {0};
      continue;
    }
    const std::string name = name_for(*axis.option, request_.scene.leg.segments[axis.segments[0]].name);
    const Setting* setting = find(name);
    if (setting == nullptr) missing(*axis.option, name);
    if (axis.component >= setting->values.size())
      throw InputError(fmt::format("-sweep_{}: -{} '{}' has only {} values", axis.name, name,
                                   format_values(*axis.option, setting->values), setting->values.size()));
    axis.base = setting->values;
  }
}

// What the checks compare grows or falls with each swept value, so a grid is sound where its corners are, and
// its corners are designs: these are errors before the first is solved, for wrong input writes nothing.
void Parser::check_corners(const Designs& designs) {
  constexpr std::int64_t most_corners = 1 << 20;
  std::vector<SweepAxis> corners = designs.axes();
  for (SweepAxis& axis : corners) {
    const auto [least, most] = axis.values.extremes();
    axis.values = SweepValues(least == most ? std::vector{least} : std::vector{least, most});
  }
  const Designs corner_designs(std::move(corners));
  for (std::int64_t i = 0; i < std::min(corner_designs.size(), most_corners); ++i) {
    const std::string fault = put_design(corner_designs, i, request_.scene);
    if (!fault.empty()) throw InputError(fault);
  }
}

// What samplers draw is not known beforehand. A design that cannot be solved keeps its row, with the status
// `invalid`; it is an error if all of the first ones are like that.
void Parser::check_designs() {
  constexpr std::int64_t first_designs = 1000;
  for (SweepAxis& axis : request_.axes) {
    if (axis.option->scope == Scope::every_segment) axis.segments = segments_left_to(*axis.option);
    if (axis.segments.empty()) {
      throw InputError(fmt::format(
          "-sweep_{}: every segment has a value of its own, nothing is left to sweep", axis.name));
    }
  }
  const Designs designs(request_.axes, request_.sampling);
  if (request_.sampling.sampler == Sampler::grid) check_corners(designs);
  std::string first_fault;
  for (std::int64_t i = 0; i < std::min(designs.size(), first_designs); ++i) {
    const std::string fault = put_design(designs, i, request_.scene);
    if (fault.empty()) return;
    if (first_fault.empty()) first_fault = fault;
  }
  throw InputError(first_fault);
}

}  // namespace gaiter::studies
