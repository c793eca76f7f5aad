// SPDX-License-Identifier: BSD-2-Clause
#pragma once

#include <stdexcept>
#include <string_view>
#include <vector>

namespace gaiter::base {

// Why a text is not the quantity asked for; the caller knows the option and makes it an InputError.
class QuantityError : public std::runtime_error {
  using std::runtime_error::runtime_error;
};

// The value of `text` in `si_unit`: a number, then a unit that udunits knows ("28.5 mmHg", "7 kV/mm", "inf").
// A bare number is in `si_unit` already. "1" is the unit of a plain number, which may also be given in "%".
// Infinite values pass, for some options admit them; NaN and what a double cannot hold are errors.
double parse_quantity(std::string_view text, std::string_view si_unit);

// The values of a comma separated list, each item with its unit. A unit on the last item alone holds for all.
// Units on some of the items only are refused: a bare number among them would silently be SI.
std::vector<double> parse_quantities(std::string_view text, std::string_view si_unit);

}  // namespace gaiter::base
