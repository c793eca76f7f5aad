// SPDX-License-Identifier: BSD-2-Clause
#include "gaiter/studies/sweep_values.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <boost/math/distributions/normal.hpp>
#include <charconv>
#include <cmath>
#include <optional>

#include "gaiter/base/text.hpp"
#include "gaiter/base/units.hpp"
#include "gaiter/studies/option_values.hpp"

namespace gaiter::studies {

namespace {

using Law = SweepValues::Law;

constexpr std::array<std::string_view, 5> law_names{"list", "linspace", "logspace", "uniform", "normal"};
constexpr std::string_view grammar =
    "a list such as '1.4,1.6', linspace(lo,hi,n), logspace(lo,hi,n), uniform(lo,hi) or normal(mean,sd)";

std::string_view name_of(Law law) {
  return law_names[static_cast<std::size_t>(law)];
}

// The complaint about a SPEC: what the option itself allows, and what a sweep may say.
base::InputError spec_error(const Option& option, std::size_t component, std::string_view name,
                            std::string_view text, std::string_view reason) {
  return base::InputError(fmt::format("-{} '{}': {}; each value must be {}; write {}", name, text, reason,
                                      allowed(option, component), grammar));
}

struct Call {
  Law law;
  std::string_view arguments;
};

// The law that a text like `linspace(...)` calls; none: a list.
std::optional<Call> called(std::string_view text) {
  text = base::trim(text);
  const auto open = text.find('(');
  if (open == std::string_view::npos || !text.ends_with(')')) return std::nullopt;
  const std::string word = base::lower(base::trim(text.substr(0, open)));
  const auto found = std::find(law_names.begin() + 1, law_names.end(), word);
  if (found == law_names.end()) return std::nullopt;
  return Call{static_cast<Law>(found - law_names.begin()), text.substr(open + 1, text.size() - open - 2)};
}

std::int64_t parse_count(std::string_view text) {
  text = base::trim(text);
  std::int64_t count = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), count);
  if (error != std::errc() || end != text.data() + text.size() || count < 1)
    throw base::QuantityError(fmt::format("'{}' is no whole number of at least 1", text));
  return count;
}

// Whole numbers at equal distances, as an option that counts needs them.
bool steps_are_whole(double first, double second, std::int64_t count) {
  const double step = count > 1 ? (second - first) / static_cast<double>(count - 1) : 0;
  return step == std::round(step);
}

SweepValues parse_call(const Option& option, std::size_t component, const Call& call, std::string_view name,
                       std::string_view text) {
  const auto refuse = [&](std::string_view reason) {
    return spec_error(option, component, name, text, reason);
  };
  const bool counted = call.law == Law::linspace || call.law == Law::logspace;
  const auto pieces = base::split(call.arguments);
  const std::size_t wanted = counted ? 3 : 2;
  if (pieces.size() != wanted) throw refuse(fmt::format("{} takes {} arguments", name_of(call.law), wanted));
  std::vector<double> ends;
  std::int64_t count = 0;
  try {
    const auto length = static_cast<std::size_t>(pieces[1].data() + pieces[1].size() - pieces[0].data());
    ends = base::parse_quantities({pieces[0].data(), length}, option.component(component).unit);
    if (counted) count = parse_count(pieces[2]);
  } catch (const base::QuantityError& error) {
    throw refuse(error.what());
  }
  const auto [first, second] = std::pair(ends[0], ends[1]);
  if (!std::isfinite(first) || !std::isfinite(second)) throw refuse("its arguments must be finite");
  const Range& range = option.component(component).range;
  const bool normal = call.law == Law::normal;
  if (!range.contains(first))
    throw refuse(fmt::format("its {} is out of range", normal ? "mean" : "first end"));
  if (normal ? second <= 0 : !range.contains(second))
    throw refuse(normal ? "the standard deviation must be greater than 0" : "its second end is out of range");
  // Of an option that takes both signs, numbers around 0 are no values.
  if (!normal && range.magnitude && (first < 0) != (second < 0))
    throw refuse("its ends must have the same sign");
  if (call.law == Law::uniform && !(first < second)) throw refuse("lo must be less than hi");
  if (call.law == Law::logspace && !(first * second > 0)) throw refuse("both ends must be greater than 0");
  const bool whole = option.kind == Kind::count;
  if (whole) {
    if (normal || call.law == Law::logspace) throw refuse("it needs whole numbers");
    if (first != std::round(first) || second != std::round(second) ||
        (call.law == Law::linspace && !steps_are_whole(first, second, count)))
      throw refuse("its values must be whole numbers");
  }
  return {call.law, first, second, count, whole};
}

}  // namespace

std::int64_t SweepValues::size() const {
  return law_ == Law::list ? static_cast<std::int64_t>(list_.size()) : count_;
}

double SweepValues::at(std::int64_t index) const {
  if (law_ == Law::list) return list_[static_cast<std::size_t>(index)];
  if (index == 0) return first_;
  if (index == count_ - 1) return second_;
  const double place = static_cast<double>(index) / static_cast<double>(count_ - 1);
  return law_ == Law::linspace ? first_ + place * (second_ - first_)
                               : first_ * std::pow(second_ / first_, place);
}

double SweepValues::quantile(double place) const {
  if (law_ == Law::normal) return boost::math::quantile(boost::math::normal(first_, second_), place);
  if (law_ == Law::uniform && whole_) return first_ + std::floor(place * (second_ - first_ + 1));
  if (law_ == Law::uniform) return first_ + place * (second_ - first_);
  return at(std::min(static_cast<std::int64_t>(place * static_cast<double>(size())), size() - 1));
}

std::pair<double, double> SweepValues::extremes() const {
  if (law_ == Law::normal) return {first_, first_};
  if (law_ != Law::list) return std::minmax(first_, count_ == 1 ? first_ : second_);
  const auto [least, most] = std::ranges::minmax(list_);
  return {least, most};
}

std::string SweepValues::text(const Option& option, std::size_t component) const {
  const auto number = [&](double value) { return format_number(option, value, component); };
  if (law_ != Law::list) {
    const std::string count = count_ > 0 ? fmt::format(", {}", count_) : "";
    return fmt::format("{}({}, {}{})", name_of(law_), number(first_), number(second_), count);
  }
  std::vector<std::string> values;
  for (const double value : list_) values.push_back(number(value));
  return values.size() == 1 ? values[0] : fmt::format("[{}]", fmt::join(values, ", "));
}

SweepValues parse_sweep_values(const Option& option, std::size_t component, std::string_view name,
                               std::string_view text) {
  if (base::trim(text).empty()) throw value_error(option, name, text, "a value is missing");
  if (const auto call = called(text)) return parse_call(option, component, *call, name, text);
  if (text.find('(') != std::string_view::npos)
    throw spec_error(option, component, name, text, "this is neither a list nor a law");
  return SweepValues(parse_component_list(option, component, name, text));
}

}  // namespace gaiter::studies
