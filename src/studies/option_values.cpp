// SPDX-License-Identifier: BSD-2-Clause
#include "gaiter/studies/option_values.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <charconv>
#include <cmath>

#include "gaiter/base/text.hpp"
#include "gaiter/base/units.hpp"

namespace gaiter::studies {

namespace {

std::string with_unit(std::string number, std::string_view unit) {
  return unit == "1" ? number : number + " " + std::string(unit);
}

std::string allowed(const Component& component) {
  const Range& range = component.range;
  std::vector<std::string> ends;
  if (range.low > -infinity) {
    ends.push_back(with_unit(fmt::format("{} {:g}", range.low_open ? "greater than" : "at least", range.low),
                             component.unit));
  }
  if (range.high < infinity) {
    ends.push_back(with_unit(fmt::format("{} {:g}", range.high_open ? "less than" : "at most", range.high),
                             component.unit));
  }
  const std::string tail = range.high == infinity && !range.high_open ? " (inf is allowed)" : "";
  return (range.magnitude ? "of either sign, the magnitude " : "") +
         fmt::format("{}", fmt::join(ends, " and ")) + tail;
}

// The same unit for every number: only then can one unit at the end of a list hold for all of it.
bool same_unit(const Option& option) {
  return std::ranges::all_of(option.components, [&](const Component& c) { return c.unit == option.unit(); });
}

std::vector<double> quantities(const Option& option, std::string_view text) {
  if (same_unit(option)) return base::parse_quantities(text, option.unit());
  std::vector<double> values;
  for (const std::string_view item : base::split(text)) {
    values.push_back(base::parse_quantity(item, option.component(values.size()).unit));
  }
  return values;
}

std::vector<double> counts(std::string_view text) {
  std::vector<double> values;
  for (const std::string_view item : base::split(text)) {
    long long value = 0;
    const auto [end, error] = std::from_chars(item.data(), item.data() + item.size(), value);
    if (error != std::errc() || end != item.data() + item.size()) {
      throw base::QuantityError(fmt::format("'{}' is not a whole number", item));
    }
    values.push_back(static_cast<double>(value));
  }
  return values;
}

std::vector<double> parse_list(const Option& option, std::string_view name, std::string_view text,
                               ValueCount count) {
  std::vector<double> values;
  try {
    values = option.kind == Kind::count ? counts(text) : quantities(option, text);
  } catch (const base::QuantityError& error) {
    throw value_error(option, name, text, error.what());
  }
  if (values.size() < count.least || values.size() > count.most) {
    throw value_error(option, name, text,
                      values.size() == 1 ? "1 value given" : fmt::format("{} values given", values.size()));
  }
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (option.component(i).range.contains(values[i])) continue;
    throw value_error(option, name, text,
                      values.size() == 1 ? "" : fmt::format("value {} is out of range", i + 1));
  }
  return values;
}

double parse_choice(const Option& option, std::string_view name, std::string_view text) {
  const auto found = std::ranges::find(option.choices, base::trim(text));
  if (found == option.choices.end()) throw value_error(option, name, text);
  return static_cast<double>(found - option.choices.begin());
}

// An option without value is a flag set; the words are those PETSc itself takes.
double parse_flag(const Option& option, std::string_view name, std::string_view text) {
  const std::string word = base::lower(base::trim(text));
  for (const char* yes : {"", "true", "yes", "on", "1"}) {
    if (word == yes) return 1;
  }
  for (const char* no : {"false", "no", "off", "0"}) {
    if (word == no) return 0;
  }
  throw value_error(option, name, text);
}

}  // namespace

base::InputError value_error(const Option& option, std::string_view name, std::string_view text,
                             std::string_view reason) {
  std::string message = fmt::format("-{} '{}': ", name, text);
  if (!reason.empty()) message += fmt::format("{}; ", reason);
  message += "must be " + allowed(option);
  if (option.kind != Kind::choice && option.kind != Kind::flag) {
    message += fmt::format(", e.g. '{}'", option.shown_example());
  }
  return base::InputError(message);
}

std::vector<double> parse_values(const Option& option, std::string_view name, std::string_view text) {
  if (option.kind == Kind::flag) return {parse_flag(option, name, text)};
  if (base::trim(text).empty()) throw value_error(option, name, text, "a value is missing");
  if (option.kind == Kind::choice) return {parse_choice(option, name, text)};
  if (!option.word.text.empty() && base::trim(text) == option.word.text) return {option.word.value};
  return parse_list(option, name, text, option.count);
}

std::vector<double> parse_component_list(const Option& option, std::size_t component, std::string_view name,
                                         std::string_view text) {
  Option one = option;
  one.components = {option.component(component)};
  one.count = {1, 1};
  return parse_list(one, name, text, {1, std::string_view::npos});
}

std::string format_number(const Option& option, double value, std::size_t component) {
  if (option.kind == Kind::flag) return value != 0 ? "true" : "false";
  if (option.kind == Kind::choice) return std::string(option.choices[static_cast<std::size_t>(value)]);
  if (!option.word.text.empty() && value == option.word.value) return std::string(option.word.text);
  if (option.kind == Kind::count) return fmt::format("{}", static_cast<long long>(value));
  return with_unit(fmt::format("{}", value), option.component(component).unit);
}

std::string format_values(const Option& option, std::span<const double> values) {
  std::vector<std::string> items;
  for (std::size_t i = 0; i < values.size(); ++i) items.push_back(format_number(option, values[i], i));
  const std::string list = fmt::format("{}", fmt::join(items, ", "));
  return items.size() == 1 ? list : "[" + list + "]";
}

std::string allowed(const Option& option, std::size_t component) {
  return (option.kind == Kind::count ? "a whole number " : "") + allowed(option.component(component));
}

std::string allowed(const Option& option) {
  if (option.kind == Kind::text) return std::string(option.format);
  if (option.kind == Kind::flag) return "true or false";
  if (option.kind == Kind::choice) return fmt::format("{}", fmt::join(option.choices, " or "));
  std::string text;
  if (option.count.least != option.count.most) {
    text = fmt::format("{} to {} values, each ", option.count.least, option.count.most);
  } else if (option.count.most > 1) {
    text = fmt::format("{} values, {}", option.count.most, option.components.size() == 1 ? "each " : "");
  }
  if (!option.word.text.empty()) text += fmt::format("{} or ", option.word.text);
  if (option.kind == Kind::count) text += "a whole number ";
  std::vector<std::string> parts;
  for (const Component& component : option.components) {
    const std::string label = component.label.empty() ? "" : std::string(component.label) + " ";
    parts.push_back(label + allowed(component));
  }
  return text + fmt::format("{}", fmt::join(parts, ", "));
}

}  // namespace gaiter::studies
