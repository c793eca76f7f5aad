// SPDX-License-Identifier: BSD-2-Clause
#include "gaiter/base/units.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

#include "gaiter/base/text.hpp"

namespace gaiter {
namespace {

TEST(Units, ConvertToSi) {
  using base::parse_quantity;
  EXPECT_DOUBLE_EQ(parse_quantity("28.5 mmHg", "Pa"), 28.5 * 133.322387415);
  EXPECT_EQ(parse_quantity("55.59 mm", "m"), 0.05559);  // not 0.05559000000000001
  EXPECT_EQ(parse_quantity("11.3kV", "V"), 11300);
  EXPECT_DOUBLE_EQ(parse_quantity("7 kV/mm", "V m-1"), 7e6);
  EXPECT_DOUBLE_EQ(parse_quantity("2 1/kPa", "Pa-1"), 2e-3);
  EXPECT_EQ(parse_quantity(" 1e-4 ", "m"), 1e-4);
  EXPECT_EQ(parse_quantity("+3", "m"), 3);
  EXPECT_EQ(parse_quantity("-2 kPa", "Pa"), -2000);
  EXPECT_DOUBLE_EQ(parse_quantity("40 %", "1"), 0.4);
  EXPECT_TRUE(std::isinf(parse_quantity("inf kV/mm", "V m-1")));
}

std::string quantity_error(std::string_view text, std::string_view unit) {
  try {
    base::parse_quantities(text, unit);
  } catch (const base::QuantityError& error) {
    return error.what();
  }
  return "";
}

TEST(Units, RefuseWhatIsNoQuantity) {
  const std::vector<std::tuple<std::string, std::string, std::string>> cases = {
      {"", "m", "missing"},
      {"abc", "m", "not a number"},
      {"nan", "m", "not a number"},
      {"-nan", "m", "not a number"},
      {"5 2 mm", "m", "not a number"},
      {"1 000 mm", "m", "not a number"},
      {"5 m 3", "m", "not a number"},
      {"+-5", "m", "not a number"},
      {"1e999", "m", "too large"},
      {"1e308 km", "m", "too large"},
      {"5 furlonx", "m", "unknown unit 'furlonx'"},
      {"5 Pa", "m", "cannot be converted to 'm'"},
      {"5 mm", "1", "plain number"},
      {"1,,2", "m", "missing"},
      {"1 m, 2, 3 m", "m", "some of the values"},
      {"1 m, 2", "m", "some of the values"}};
  for (const auto& [text, unit, reason] : cases) {
    EXPECT_NE(quantity_error(text, unit).find(reason), std::string::npos)
        << "'" << text << "': " << quantity_error(text, unit);
  }
}

TEST(Units, LastUnitHoldsForTheList) {
  EXPECT_EQ(base::parse_quantities("1, 2,3 kPa", "Pa"), (std::vector<double>{1000, 2000, 3000}));
  EXPECT_EQ(base::parse_quantities("1 kPa,2 Pa", "Pa"), (std::vector<double>{1000, 2}));
  EXPECT_EQ(base::parse_quantities("1,2", "Pa"), (std::vector<double>{1, 2}));
}

TEST(Text, NearestName) {
  const std::vector<std::string> names = {"bandage_stretch", "bandage_thickness", "voltage"};
  EXPECT_EQ(base::nearest("bandage_strech", names), "bandage_stretch");
  EXPECT_EQ(base::nearest("votlage", names), "voltage");
  EXPECT_EQ(base::nearest("snes_monitor", names), "");
  EXPECT_EQ(base::edit_distance("kitten", "sitting"), 3u);
  EXPECT_EQ(base::edit_distance("ab", "ba"), 1u);
  EXPECT_EQ(base::edit_distance("", "abc"), 3u);
}

}  // namespace
}  // namespace gaiter
