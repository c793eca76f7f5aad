// SPDX-License-Identifier: BSD-2-Clause
#include "gaiter/base/units.hpp"

#include <udunits2.h>

#include <charconv>
#include <cmath>
#include <memory>
#include <string>

#include "gaiter/base/error.hpp"
#include "gaiter/base/text.hpp"

namespace gaiter::base {

namespace {

struct FreeSystem {
  void operator()(ut_system* system) const { ut_free_system(system); }
};
struct FreeUnit {
  void operator()(ut_unit* unit) const { ut_free(unit); }
};
struct FreeConverter {
  void operator()(cv_converter* converter) const { cv_free(converter); }
};
using System = std::unique_ptr<ut_system, FreeSystem>;
using Unit = std::unique_ptr<ut_unit, FreeUnit>;
using Converter = std::unique_ptr<cv_converter, FreeConverter>;

ut_system* unit_system() {
  static const System system = [] {
    ut_set_error_message_handler(ut_ignore);  // we report errors ourselves, in one line
    return System(ut_read_xml(nullptr));
  }();
  if (!system) throw InternalError("the unit database of udunits cannot be read");
  return system.get();
}

bool is_digit(char c) {
  return c >= '0' && c <= '9';
}

// udunits would take the factor in "5 2 mm" or "1 000 mm" for a part of the unit; such a text is a mistake.
// "1/Pa" is the one unit that starts with a digit.
bool holds_number(std::string_view unit) {
  if (unit.starts_with("1/")) unit.remove_prefix(2);
  char before = ' ';
  for (const char c : unit) {
    if (before == ' ' && (is_digit(c) || c == '.' || c == '+' || c == '-')) return true;
    before = c;
  }
  return false;
}

struct Number {
  double value;
  std::string unit;  // empty: bare number
};

Number split_number(std::string_view text) {
  std::string_view digits = trim(text);
  if (digits.empty()) throw QuantityError("a number is missing");
  if (digits.front() == '+' && digits.size() > 1 && digits[1] != '-') digits.remove_prefix(1);
  Number number{};
  const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), number.value);
  if (error == std::errc::result_out_of_range) {
    throw QuantityError("'" + std::string(trim(text)) + "' is too large or too small for a number");
  }
  number.unit = trim(digits.substr(static_cast<std::size_t>(end - digits.data())));
  if (error != std::errc() || std::isnan(number.value) || holds_number(number.unit)) {
    throw QuantityError("'" + std::string(trim(text)) + "' is not a number");
  }
  return number;
}

// "55.59 mm" is to become the double nearest to 0.05559: where the SI unit is a whole number of the given
// ones, dividing by that number rounds once, multiplying by its reciprocal twice.
double convert_value(ut_unit* from, ut_unit* to, double value) {
  const Converter forward(ut_get_converter(from, to));
  const Converter backward(ut_get_converter(to, from));
  const double parts = cv_convert_double(backward.get(), 1);
  const bool whole = cv_convert_double(backward.get(), 0) == 0 && parts > 1 && parts == std::round(parts);
  return whole ? value / parts : cv_convert_double(forward.get(), value);
}

double convert(const Number& number, std::string_view si_unit) {
  if (number.unit.empty()) return number.value;
  ut_system* system = unit_system();
  const Unit to(ut_parse(system, std::string(si_unit).c_str(), UT_UTF8));
  if (!to) throw InternalError("udunits does not know '" + std::string(si_unit) + "'");
  const Unit from(ut_parse(system, number.unit.c_str(), UT_UTF8));
  if (!from) throw QuantityError("unknown unit '" + number.unit + "'");
  if (!ut_are_convertible(from.get(), to.get())) {
    throw QuantityError("the unit '" + number.unit + "' is wrong here" +
                        (si_unit == "1" ? ", a plain number is wanted"
                                        : ", it cannot be converted to '" + std::string(si_unit) + "'"));
  }
  const double value = convert_value(from.get(), to.get(), number.value);
  if (std::isnan(value) || (std::isinf(value) && !std::isinf(number.value))) {
    throw QuantityError("the value is too large for a number");
  }
  return value;
}

}  // namespace

double parse_quantity(std::string_view text, std::string_view si_unit) {
  return convert(split_number(text), si_unit);
}

std::vector<double> parse_quantities(std::string_view text, std::string_view si_unit) {
  std::vector<Number> numbers;
  std::size_t with_unit = 0;
  for (const std::string_view item : split(text)) {
    numbers.push_back(split_number(item));
    with_unit += !numbers.back().unit.empty();
  }
  const std::string last_unit = numbers.back().unit;
  const bool shared = with_unit == 1 && !last_unit.empty();
  if (with_unit != 0 && with_unit != numbers.size() && !shared) {
    throw QuantityError("some of the values have a unit and some have none");
  }
  std::vector<double> values;
  for (Number& number : numbers) {
    if (shared) number.unit = last_unit;
    values.push_back(convert(number, si_unit));
  }
  return values;
}

}  // namespace gaiter::base
