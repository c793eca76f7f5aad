// SPDX-License-Identifier: BSD-2-Clause
#pragma once

#include <cmath>
#include <cstdio>
#include <map>
#include <random>
#include <string>
#include <vector>

#include "gaiter/studies/option_table.hpp"

// Command lines drawn at random: mostly a scene that could be meant, with options left out, repeated,
// misspelt, or given values that are extreme or nonsense. The same seed and number give the same words.
namespace gaiter::fuzz {

class Draw {
 public:
  Draw(unsigned seed, unsigned number) : generator_(seed * 2654435761u + number) {}

  int below(int end) { return static_cast<int>(generator_() % static_cast<unsigned>(end)); }
  bool chance(double part) { return generator_() < part * 4294967296.0; }
  double uniform(double low, double high) { return low + (high - low) * (generator_() / 4294967296.0); }
  double logarithmic(double low, double high) { return std::exp(uniform(std::log(low), std::log(high))); }
  template <typename T>
  const T& of(const std::vector<T>& all) {
    return all[static_cast<std::size_t>(below(static_cast<int>(all.size())))];
  }

 private:
  std::mt19937 generator_;
};

inline std::string text(double value) {
  char buffer[40];
  std::snprintf(buffer, sizeof buffer, "%.17g", value);
  return buffer;
}

// Values that no option may choke on.
inline std::string nonsense(Draw& draw) {
  static const std::vector<std::string> all = {"",
                                               " ",
                                               "nan",
                                               "-nan",
                                               "inf",
                                               "-inf",
                                               "1e999",
                                               "-1e999",
                                               "1e-999",
                                               "0",
                                               "-0",
                                               "-1",
                                               "1,,2",
                                               ",",
                                               "1 2",
                                               "0x1p3",
                                               "1e",
                                               "e5",
                                               "1 furlong",
                                               "1 m/s",
                                               "5 kg",
                                               "3 Pa m",
                                               "1 mmm",
                                               "mm",
                                               "1e400 mm",
                                               "--5",
                                               "+5",
                                               "1;2",
                                               "[1,2]",
                                               "{a: 1}",
                                               "\xC3\xA4\xC3\xB6",
                                               "\xE2\x82\xAC",
                                               "\xFF\xFE",
                                               "\xF0\x9F\xA6\xB5",
                                               "%s%n",
                                               "$(reboot)",
                                               "true",
                                               "none",
                                               "auto",
                                               "1e308",
                                               "4.9e-324",
                                               "1 mmHg",
                                               "1 V/m",
                                               "100 %",
                                               "2147483648",
                                               "99999999999999999999",
                                               "1.5",
                                               "1e-300",
                                               "../../x",
                                               "a\nb",
                                               "a\tb",
                                               "'",
                                               "\"",
                                               "\\",
                                               "#",
                                               ":"};
  if (draw.chance(0.03))
    return std::string(static_cast<std::size_t>(draw.below(20000)), "19ax,"[draw.below(5)]);
  return draw.of(all);
}

// A value that the option may well take, most often within its range and often at the end of it.
inline std::string component_value(Draw& draw, const studies::Option& option, std::size_t k) {
  const auto& part = option.component(k);
  const studies::Range& range = part.range;
  const double low = std::max(range.low, -1e30), high = std::min(range.high, 1e30);
  if (draw.chance(0.1)) return text(range.low);
  if (draw.chance(0.1)) return text(range.high);
  const double least = low > 0 ? low : low < 0 ? 1e-6 : std::min(1e-12, high * 1e-6);
  double value = high > 0 ? draw.logarithmic(least, high) : -draw.logarithmic(1e-6, -std::max(low, -10.0));
  if (range.magnitude && draw.chance(0.3)) value = -value;
  if (option.kind == studies::Kind::count)
    value = std::floor(draw.chance(0.9) ? std::min(value, 40.0) : value);
  return text(value);
}

inline std::string value_of(Draw& draw, const studies::Option& option) {
  if (option.kind == studies::Kind::choice) return std::string(draw.of(option.choices));
  if (option.kind == studies::Kind::flag) return draw.chance(0.5) ? "true" : "false";
  if (option.kind == studies::Kind::text) return std::string(option.shown_example());
  std::string all;
  std::size_t count = std::min<std::size_t>(option.count.most, option.count.least + draw.below(2));
  for (std::size_t k = 0; k < count; ++k) all += (k ? "," : "") + component_value(draw, option, k);
  return all;
}

// A scene as users write them, jittered.
inline std::map<std::string, std::string> plain_scene(Draw& draw) {
  static const std::vector<std::vector<std::string>> names = {{"ankle"}, {"a", "b"}, {"r6", "R5", "r_4"},
                                                              {"s"},     {"x1"},     {"leg"}};
  const auto& segments = draw.of(names);
  const bool cylinder = draw.chance(0.4);
  std::map<std::string, std::string> given;
  for (const auto& name : segments) {
    given["leg_segments"] += (given["leg_segments"].empty() ? "" : ",") + name;
    const double radius = draw.chance(0.8) ? draw.uniform(0.03, 0.07) : draw.logarithmic(1e-4, 10);
    given["leg_" + name + "_radius"] =
        text(radius) + "," + text(cylinder ? radius : radius * draw.uniform(0.8, 1.25));
    given["leg_" + name + "_height"] = draw.chance(0.8) ? "35 mm" : text(draw.logarithmic(1e-4, 10));
    const double wild = draw.chance(0.8) ? 1.5 : 1000;
    const auto about = [&](double value) { return text(value * draw.logarithmic(1 / wild, wild)); };
    given["leg_" + name + "_compliance"] =
        about(0.0134) + "," + about(7.9e-5) + "," + about(-0.016) + "," + about(-0.00114);
  }
  given["bandage_stretch"] = text(draw.chance(0.7) ? draw.uniform(0.9, 2.6) : draw.logarithmic(0.01, 20));
  given["bandage_thickness"] =
      text(draw.chance(0.7) ? draw.logarithmic(1e-4, 3e-3) : draw.logarithmic(1e-10, 0.1));
  const int terms = draw.below(3) + 1;
  for (int i = 0; i < terms; ++i) {
    const bool softer = draw.chance(0.1);
    const double sign = draw.chance(0.8) ? 1 : -1;
    const double alpha = draw.chance(0.7) ? draw.uniform(1.5, 12) : draw.logarithmic(0.01, 50);
    const double mu = draw.chance(0.7) ? draw.logarithmic(1e2, 1e6) : draw.logarithmic(1e-2, 1e12);
    given["bandage_ogden_mu"] += (i ? "," : "") + text(sign * mu * (softer ? -1 : 1));
    given["bandage_ogden_alpha"] += (i ? "," : "") + text(sign * alpha);
  }
  if (draw.chance(0.6))
    given["voltage"] = text(draw.chance(0.8) ? draw.uniform(0, 15e3) : draw.logarithmic(1e-9, 1e9));
  if (draw.chance(0.6)) given["bandage_permittivity"] = "7.41";
  return given;
}

// Option, value, option, value; without the command.
inline std::vector<std::string> command_line(Draw& draw, bool with_axisym) {
  auto given = plain_scene(draw);
  const double kind = draw.uniform(0, 1);
  given["fidelity"] = kind < 0.12                  ? "rigid"
                      : kind < 0.2                 ? "first_order"
                      : kind < 0.3                 ? "sliding"
                      : kind < 0.45                ? "auto"
                      : kind < 0.8 || !with_axisym ? "slice"
                                                   : "axisym";
  if (given["fidelity"] == "auto") {
    given["accuracy"] = text(draw.logarithmic(1e-7, 1));
    given["auto_up_to"] =
        draw.chance(with_axisym ? 0.5 : 1) ? draw.chance(0.7) ? "slice" : "sliding" : "axisym";
    static const std::vector<std::string> outputs = {"pressure_rest", "pressure_actuated",
                                                     "pressure_rest,actuation_drop", "volume_change"};
    if (draw.chance(0.5)) given["outputs"] = draw.of(outputs);
  }
  // Other options of the table.
  const auto table = studies::option_table();
  for (int extra = draw.below(4); extra > 0; --extra) {
    const studies::Option& option =
        table[static_cast<std::size_t>(draw.below(static_cast<int>(table.size())))];
    if (option.kind == studies::Kind::text || option.name == "fidelity" ||
        option.name.starts_with("axisym") || option.name.starts_with("sweep") ||
        option.name == "comparison" || option.name == "dry_run" || option.name == "plan")
      continue;
    given[studies::name_for(option, given["leg_segments"].substr(0, given["leg_segments"].find(',')))] =
        value_of(draw, option);
  }
  if (!given.contains("slice_count") || given["slice_count"].size() > 3) given["slice_count"] = "6";
  // Allowed, but minutes long.
  if (given.contains("sliding_count") && given["sliding_count"].size() > 3) given["sliding_count"] = "24";
  std::vector<std::pair<std::string, std::string>> all(given.begin(), given.end());
  // Something wrong in every third.
  while (draw.chance(0.3)) {
    auto& [name, value] = all[static_cast<std::size_t>(draw.below(static_cast<int>(all.size())))];
    switch (draw.below(6)) {
      case 0:
      case 1:
        value = nonsense(draw);
        break;
      case 2:
        name.erase(static_cast<std::size_t>(draw.below(static_cast<int>(name.size()))), 1);
        break;
      case 3:
        name +=
            draw.of(std::vector<std::string>{"s", "_", "\xC3\xA4", ".", "-", "_x", std::string(300, 'y')});
        break;
      case 4:
        if (name == "leg_segments")
          value = draw.of(std::vector<std::string>{"a,a", "", ",", "a b", "1", "leg,leg", "\xC3\xA4", "a,A",
                                                   std::string(5000, 'q'), "s-1", "a,,b"});
        else
          value += draw.of(std::vector<std::string>{" kPa", " mm", " V", ",1", ", ", "%", " m m"});
        break;
      default:
        std::swap(all[0], all.back());
        if (all.size() > 1) all.pop_back();
    }
  }
  std::vector<std::string> words;
  for (const auto& [name, value] : all) {
    words.push_back("-" + name);
    if (!value.empty()) words.push_back(value);
  }
  return words;
}

}  // namespace gaiter::fuzz
