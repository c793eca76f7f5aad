// SPDX-License-Identifier: BSD-2-Clause
#include "gaiter/studies/designs.hpp"

#include <gtest/gtest.h>

#include <set>

#include "gaiter/studies/option_values.hpp"
#include "gaiter/studies/scene_checks.hpp"
#include "gaiter/studies/scene_options.hpp"
#include "option_samples.hpp"

namespace {

using namespace gaiter;
using namespace gaiter::studies;
using tests::Given;
using tests::two_segments;
using tests::two_segments_with;

Request sweep_with(const Given& more) {
  return parse_request(Command::sweep, two_segments_with(more));
}
std::string sweep_error(const Given& more) {
  return tests::error_of(two_segments_with(more), Command::sweep);
}

double value(const Designs& designs, std::size_t axis, std::int64_t design) {
  std::vector<double> values(designs.axes().size());
  designs.values(design, values);
  return values[axis];
}

void apply(const Designs& designs, std::int64_t design, model::Scene& scene) {
  EXPECT_EQ(put_design(designs, design, scene), "");
}

TEST(Designs, LastNamedAxisRunsFastest) {
  const Request request =
      sweep_with({{"sweep_voltage", "0, 5 kV"}, {"sweep_bandage_stretch", "1.4,1.6,1.8"}});
  const Designs designs(request.axes);
  ASSERT_EQ(designs.size(), 6);
  EXPECT_EQ(designs.axes()[0].name, "bandage_stretch");
  EXPECT_EQ(designs.axes()[1].name, "voltage");
  EXPECT_EQ(designs.axes()[1].unit(), "V");
  model::Scene scene = request.scene;
  const double stretches[] = {1.4, 1.4, 1.6, 1.6, 1.8, 1.8}, voltages[] = {0, 5000, 0, 5000, 0, 5000};
  for (const int i : {5, 0, 3, 1, 4, 2}) {  // in any order, on one scene
    apply(designs, i, scene);
    for (const model::Module& module : scene.bandage.modules) {
      EXPECT_EQ(module.stretch, stretches[i]);
      EXPECT_EQ(module.voltage, voltages[i]);
    }
    EXPECT_EQ(value(designs, 0, i), stretches[i]);
    EXPECT_EQ(value(designs, 1, i), voltages[i]);
  }
}

TEST(Designs, WithoutAxisThereIsOneDesign) {
  const Request request = parse_request(Command::solve, two_segments());
  const Designs designs(request.axes);
  model::Scene scene = request.scene;
  apply(designs, 0, scene);
  EXPECT_EQ(designs.size(), 1);
  EXPECT_EQ(tests::describe(scene), tests::describe(request.scene));
}

TEST(Designs, MillionsTakeNoMemory) {
  std::string values = "1";
  for (int i = 1; i < 1000; ++i) values += fmt::format(",{}", 1 + i);
  const Request request = sweep_with({{"sweep_voltage", values},
                                      {"sweep_leg_low_height", "0.01, 0.02"},
                                      {"sweep_leg_young", values},
                                      {"sweep_bandage_permittivity", values}});
  const Designs designs(request.axes);
  EXPECT_EQ(designs.size(), 2'000'000'000);
  const std::int64_t design = ((417LL * 2 + 1) * 1000 + 22) * 1000 + 999;
  EXPECT_EQ(value(designs, 0, design), 418);
  EXPECT_EQ(value(designs, 1, design), 0.02);
  EXPECT_EQ(value(designs, 2, design), 23);
  EXPECT_EQ(value(designs, 3, design), 1000);
}

TEST(Designs, TooManyToCount) {
  const Option& voltage = option("voltage");
  const SweepAxis axis{"voltage", &voltage, 0, {0}, {0}, SweepValues(std::vector<double>(1000, 1.0))};
  EXPECT_EQ(Designs(std::vector<SweepAxis>(6, axis)).size(), 1'000'000'000'000'000'000);
  EXPECT_THROW(Designs(std::vector<SweepAxis>(7, axis)), base::InputError);
  EXPECT_THROW(Designs({{"voltage", &voltage, 0, {0}, {0}, SweepValues({})}}), base::InputError);
}

// The value of an option with one of its numbers put in the place of the one it has.
std::string with_number(const SweepAxis& axis, double number) {
  std::vector<double> numbers = axis.base;
  numbers[axis.component] = number;
  return format_values(*axis.option, numbers);
}

TEST(Designs, EverySweepableNumberSetsWhatTheOptionItselfSets) {
  // Two values that each option admits; 3 and 4 will do for the others.
  const std::map<std::string_view, std::pair<std::string, std::string>> pairs = {
      {"accuracy", {"1e-2", "1e-3"}},          {"bandage_<s>_length", {"13 cm", "14 cm"}},
      {"bandage_<s>_stretch", {"1.3", "1.7"}}, {"bandage_thickness", {"2 mm", "3 mm"}},
      {"leg_<s>_height", {"2 cm", "3 cm"}},    {"leg_<s>_radius", {"46 mm", "47 mm"}},
      {"leg_poisson", {"0.1", "0.2"}},         {"leg_radius_scale", {"1.1", "1.2"}},
      {"slice_fixed_point_tolerance", {"1e-3", "2e-3"}}};
  const std::map<std::string, std::pair<std::string, std::string>> compliance = {
      {"a", {"0.02", "0.03"}}, {"c", {"-0.02", "-0.03"}}, {"d", {"-1e-3", "-2e-3"}}};
  std::set<std::string> outcomes;
  std::size_t swept = 0;
  for (const Option& entry : option_table()) {
    if (!entry.sweepable) continue;
    const bool several = entry.count.most > 1;
    const std::size_t numbers = entry.count.least == entry.count.most ? entry.count.most : 2;
    for (std::size_t number = 0; number < numbers; ++number) {
      const std::string name = name_for(entry, "high");
      const std::string axis_name = several ? name + "_" + component_name(entry, number) : name;
      SCOPED_TRACE(axis_name);
      std::pair<std::string, std::string> texts{"3", "4"};
      if (const auto found = pairs.find(entry.name); found != pairs.end()) texts = found->second;
      if (const auto found = compliance.find(component_name(entry, number));
          several && found != compliance.end())
        texts = found->second;
      const Request request =
          sweep_with({{"sweep_" + axis_name, fmt::format("{},{}", texts.first, texts.second)}});
      ASSERT_EQ(request.axes.size(), 1u);
      EXPECT_EQ(request.axes[0].name, axis_name);
      model::Scene scene = request.scene;
      const Designs designs(request.axes);
      apply(designs, 1, scene);
      EXPECT_NE(tests::describe(scene), tests::describe(request.scene));
      const std::string text = several ? with_number(request.axes[0], value(designs, 0, 1)) : texts.second;
      const std::string plain = text.front() == '[' ? text.substr(1, text.size() - 2) : text;
      const Request direct = parse_request(Command::solve, two_segments_with({{name, plain}}));
      EXPECT_EQ(tests::describe(scene), tests::describe(direct.scene));
      outcomes.insert(tests::describe(scene));
      ++swept;
    }
  }
  EXPECT_GT(swept, 25u);
  EXPECT_EQ(outcomes.size(), swept);  // no two of them set the same
}

TEST(Sweep, SegmentsWithAValueOfTheirOwnKeepIt) {
  const Request request = sweep_with({{"sweep_bandage_stretch", "1.4,1.6"},
                                      {"bandage_high_length", "16 cm"},
                                      {"bandage_low_voltage", "7"},
                                      {"sweep_voltage", "1,2 kV"}});
  model::Scene scene = request.scene;
  apply(Designs(request.axes), 3, scene);
  EXPECT_EQ(scene.bandage.modules[0].stretch, 1.6);
  EXPECT_EQ(scene.bandage.modules[1].length, 0.16);
  EXPECT_EQ(scene.bandage.modules[0].voltage, 7);
  EXPECT_EQ(scene.bandage.modules[1].voltage, 2000);
}

TEST(Sweep, SweptOptionIsNotMissingAndFirstDesignIsTheScene) {
  Given given = two_segments_with({{"sweep_bandage_stretch", "1.4,1.6"}});
  given.erase("bandage_stretch");
  const Request request = parse_request(Command::sweep, given);
  EXPECT_EQ(request.scene.bandage.modules[0].stretch, 1.4);
  EXPECT_EQ(request.scene.bandage.modules[1].stretch, 1.4);
}

TEST(Sweep, ResolvedTextGivesTheSameSweepAgain) {
  const Request first =
      sweep_with({{"sweep_bandage_low_stretch", "1.4,1.6"}, {"sweep_bandage_thickness", "1,2 mm"}});
  const Request again = parse_request(Command::sweep, tests::flat_yaml(first.text));
  EXPECT_EQ(again.text, first.text);
  ASSERT_EQ(again.axes.size(), 2u);
  for (std::size_t i = 0; i < 2; ++i) {
    EXPECT_EQ(again.axes[i].name, first.axes[i].name);
    EXPECT_EQ(again.axes[i].values, first.axes[i].values);
    EXPECT_EQ(again.axes[i].segments, first.axes[i].segments);
  }
  EXPECT_NE(first.text.find("sweep_bandage_thickness: [0.001 m, 0.002 m]\n"), std::string::npos)
      << first.text;
  EXPECT_EQ(first.text.find("\nbandage_thickness"), std::string::npos)
      << "the default does not count, it is swept";
  EXPECT_EQ(tests::describe(again.scene), tests::describe(first.scene));
}

TEST(Sweep, ErrorsNameOptionAndValue) {
  const std::vector<std::tuple<Given, std::vector<std::string>>> cases = {
      {{{"sweep_bandage_stretch", "1.4,0"}}, {"-sweep_bandage_stretch '1.4,0'", "value 2", "greater than 0"}},
      {{{"sweep_bandage_stretch", ""}}, {"-sweep_bandage_stretch ''", "a value is missing"}},
      {{{"sweep_bandage_stretch", "1.4 Pa"}}, {"'Pa'", "plain number"}},
      {{{"sweep_leg_low_radius", "1,2"}},
       {"-sweep_leg_low_radius '1,2'", "one by one", "-sweep_leg_low_radius_lower"}},
      {{{"sweep_slice_rule", "gauss"}}, {"cannot be swept"}},
      {{{"sweep_bandage_mid_stretch", "1"}}, {"unknown segment 'mid' in -sweep_bandage_mid_stretch"}},
      {{{"sweep_bandage_low_stretch", "1,2"}, {"bandage_low_length", "12 cm"}},
       {"-bandage_low_length '0.12 m'", "-bandage_low_stretch 'swept'", "not both"}},
      {{{"sweep_voltage", "1"}, {"bandage_low_voltage", "1"}, {"bandage_high_voltage", "1"}},
       {"-sweep_voltage", "nothing is left to sweep"}},
      {{}, {"nothing to sweep"}},
      {{{"sweep_bandage_strech", "1,2"}}, {"did you mean -sweep_bandage_stretch?"}},
      {{{"swep_voltage", "1,2"}}, {"did you mean -sweep_voltage?"}}};
  for (const auto& [given, pieces] : cases) {
    const std::string message = sweep_error(given);
    for (const std::string& piece : pieces)
      EXPECT_NE(message.find(piece), std::string::npos) << piece << "\n" << message;
  }
}

// Each value is allowed by itself; only their combination leaves no hole in the tube, and not in the first
// design.
TEST(Sweep, CombinationsAreChecked) {
  const std::string message =
      sweep_error({{"sweep_bandage_stretch", "1.4,10,2"}, {"sweep_bandage_thickness", "1,3.9,4 mm"}});
  for (const char* piece : {"-bandage_thickness '0.004 m'", "low", "stretch 10", "less than 0.004 m"}) {
    EXPECT_NE(message.find(piece), std::string::npos) << message;
  }
  EXPECT_EQ(sweep_error({{"sweep_bandage_stretch", "1.4,10,2"}, {"sweep_bandage_thickness", "1,3.9 mm"}}),
            "");
}

}  // namespace
