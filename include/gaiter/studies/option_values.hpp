// SPDX-License-Identifier: BSD-2-Clause
#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "gaiter/base/error.hpp"
#include "gaiter/studies/option_table.hpp"

namespace gaiter::studies {

// "-name 'text': reason; must be ..., e.g. '...'": the one form of every complaint about a value.
base::InputError value_error(const Option& option, std::string_view name, std::string_view text,
                             std::string_view reason = "");

// The numbers of an option's text, each within its range. `name` is the option as the user wrote it.
// Throws InputError. Not for options of kind text.
std::vector<double> parse_values(const Option& option, std::string_view name, std::string_view text);

// Values for one component of an option: a list of any length, each within the component's range.
std::vector<double> parse_component_list(const Option& option, std::size_t component, std::string_view name,
                                         std::string_view text);

// Text that parse_values reads as exactly these numbers, in SI with units. A list has YAML's brackets.
std::string format_values(const Option& option, std::span<const double> values);

// One number of an option with its unit, as parse_values reads it.
std::string format_number(const Option& option, double value, std::size_t component = 0);

// What may follow "must be": "at least 1e-10 m and at most 1 m".
std::string allowed(const Option& option);

// Of one of its numbers.
std::string allowed(const Option& option, std::size_t component);

}  // namespace gaiter::studies
