// SPDX-License-Identifier: BSD-2-Clause
#include <gtest/gtest.h>

#include <cmath>
#include <set>
#include <tuple>

#include "gaiter/base/text.hpp"
#include "gaiter/base/units.hpp"
#include "gaiter/studies/help.hpp"
#include "gaiter/studies/option_table.hpp"
#include "gaiter/studies/option_values.hpp"
#include "gaiter/studies/scene_options.hpp"
#include "option_samples.hpp"

namespace {

using namespace gaiter;
using namespace gaiter::studies;
using tests::error_of;
using tests::Given;
using tests::two_segments;
using tests::two_segments_with;

Request solve_with(const Given& more) {
  return parse_request(Command::solve, two_segments_with(more));
}

// The message must hold every one of these pieces.
void expect_error(const Given& given, const std::vector<std::string>& pieces,
                  Command command = Command::solve) {
  const std::string message = error_of(given, command);
  ASSERT_NE(message, "") << "no error";
  for (const std::string& piece : pieces) EXPECT_NE(message.find(piece), std::string::npos) << message;
  EXPECT_EQ(message.find('\n'), std::string::npos) << message;
}

TEST(OptionTable, SortedAndComplete) {
  const auto table = option_table();
  for (std::size_t i = 1; i < table.size(); ++i) EXPECT_LT(table[i - 1].name, table[i].name);
  for (const Option& entry : table) {
    EXPECT_FALSE(entry.doc.empty()) << entry.name;
    EXPECT_FALSE(allowed(entry).empty()) << entry.name;
    EXPECT_FALSE(entry.shown_example().empty()) << entry.name;
    EXPECT_EQ(entry.set == nullptr, entry.scope == Scope::program) << entry.name;
    EXPECT_EQ(entry.name.find("<s>") != std::string_view::npos, entry.scope == Scope::one_segment)
        << entry.name;
    EXPECT_TRUE(!entry.sweepable || entry.kind == Kind::quantity || entry.kind == Kind::count) << entry.name;
    for (const auto pattern : entry.yields_to) EXPECT_EQ(option(pattern).scope, Scope::one_segment);
    if (entry.kind == Kind::text) continue;
    EXPECT_NO_THROW(parse_values(entry, entry.name, entry.shown_example())) << entry.name;
  }
}

TEST(OptionTable, DefaultsAreThoseOfTheModel) {
  const model::Scene untouched;
  model::Scene scene = solve_with({}).scene;
  EXPECT_EQ(scene.bandage.modules[0].voltage, model::Module{}.voltage);
  scene.leg.segments.clear();
  scene.bandage.modules.clear();
  scene.bandage.ogden.clear();
  EXPECT_EQ(tests::describe(scene), tests::describe(untouched));
}

TEST(Scene, EveryOptionSetsItsOwnValue) {
  using model::Scene;
  struct Case {
    const char* name;
    const char* text;
    double expected;
    double (*get)(const Scene&);
  };
  const std::vector<Case> cases = {
      {"accuracy", "1e-4", 1e-4, [](const Scene& s) { return s.goal.accuracy; }},
      {"auto_up_to", "sliding", 2, [](const Scene& s) { return double(s.goal.up_to); }},
      {"bandage_high_length", "15 cm", 0.15, [](const Scene& s) { return s.bandage.modules[1].length; }},
      {"bandage_high_stretch", "1.7", 1.7, [](const Scene& s) { return s.bandage.modules[1].stretch; }},
      {"bandage_high_voltage", "3 kV", 3000, [](const Scene& s) { return s.bandage.modules[1].voltage; }},
      {"bandage_breakdown_field", "80 kV/mm", 8e7, [](const Scene& s) { return s.bandage.breakdown_field; }},
      {"bandage_layers", "7", 7, [](const Scene& s) { return double(s.bandage.layers); }},
      {"bandage_length_at", "inner", 2, [](const Scene& s) { return double(s.bandage.length_at); }},
      {"bandage_ogden_alpha", "3, -4", -4, [](const Scene& s) { return s.bandage.ogden[1].alpha; }},
      {"bandage_ogden_mu", "3 kPa, 4 kPa", 4000, [](const Scene& s) { return s.bandage.ogden[1].mu; }},
      {"bandage_permittivity", "7.41", 7.41, [](const Scene& s) { return s.bandage.permittivity; }},
      {"bandage_stretch", "150 %", 1.5, [](const Scene& s) { return s.bandage.modules[1].stretch; }},
      {"bandage_thickness", "0.5 mm", 5e-4, [](const Scene& s) { return s.bandage.thickness; }},
      {"axisym_electrostatics", "off", 2, [](const Scene& s) { return double(s.axisym.electrostatics); }},
      {"axisym_multipliers", "leg", 1, [](const Scene& s) { return double(s.axisym.multipliers); }},
      {"axisym_scope", "leg", 1, [](const Scene& s) { return double(s.axisym.scope); }},
      {"axisym_order", "3", 3, [](const Scene& s) { return double(s.axisym.order); }},
      {"axisym_ranks_per_case", "2", 2, [](const Scene& s) { return double(s.axisym.ranks_per_case); }},
      {"axisym_refine", "3", 3, [](const Scene& s) { return double(s.axisym.refine); }},
      {"bandage_bulk_modulus", "37 MPa", 37e6, [](const Scene& s) { return s.bandage.bulk_modulus; }},
      {"leg_shear_modulus", "5 kPa", 5000, [](const Scene& s) { return s.leg.shear_modulus; }},
      {"contact_axial", "held", 1, [](const Scene& s) { return double(s.contact_axial); }},
      {"sliding_count", "30", 30, [](const Scene& s) { return double(s.discretisation.sliding_count); }},
      {"fidelity", "rigid", 0, [](const Scene& s) { return double(s.fidelity); }},
      {"leg_high_compliance", ".1, 2 1/kPa, -.2, -3e-3", 2e-3,
       [](const Scene& s) { return s.leg.segments[1].compliance.b; }},
      {"leg_high_compliance", ".1, 2, -.2, -3e-3", -3e-3,
       [](const Scene& s) { return s.leg.segments[1].compliance.d; }},
      {"leg_high_height", "3 cm", 0.03, [](const Scene& s) { return s.leg.segments[1].height; }},
      {"leg_high_radius", "51,52 mm", 0.051, [](const Scene& s) { return s.leg.segments[1].lower_radius; }},
      {"leg_high_radius", "51,52 mm", 0.052, [](const Scene& s) { return s.leg.segments[1].upper_radius; }},
      {"leg_compliance_data_limit", "60 mmHg", 60 * 133.322387415,
       [](const Scene& s) { return s.leg.data_limit; }},
      {"leg_compliance_variant", "anchored", 1, [](const Scene& s) { return double(s.leg.variant); }},
      {"leg_material", "neo_hookean", 1, [](const Scene& s) { return double(s.leg.material); }},
      {"leg_compliance_scale", "1.5", 0.015, [](const Scene& s) { return s.leg.segments[1].compliance.a; }},
      {"leg_radius_scale", "90 %", 0.0495, [](const Scene& s) { return s.leg.segments[1].upper_radius; }},
      {"leg_model", "rigid", 1, [](const Scene& s) { return double(s.leg.model); }},
      {"leg_poisson", "0.45", 0.45, [](const Scene& s) { return s.leg.poisson_ratio; }},
      {"leg_young", "0.1 MPa", 1e5, [](const Scene& s) { return s.leg.young_modulus; }},
      {"slice_count", "64", 64, [](const Scene& s) { return double(s.discretisation.slice_count); }},
      {"slice_fixed_point_tolerance", "0.01 %", 1e-4,
       [](const Scene& s) { return s.discretisation.fixed_point_tolerance; }},
      {"slice_precision", "single", 1,
       [](const Scene& s) { return double(s.discretisation.slice_precision); }},
      {"slice_rule", "midpoint", 1, [](const Scene& s) { return double(s.discretisation.slice_rule); }},
      {"slice_solver", "fixed_point", 1,
       [](const Scene& s) { return double(s.discretisation.slice_solver); }},
      {"voltage", "11.3 kV", 11300, [](const Scene& s) { return s.bandage.modules[1].voltage; }},
      {"wall_points", "3", 3, [](const Scene& s) { return double(s.discretisation.wall_points); }}};
  std::set<std::string_view> tried;
  for (const Case& c : cases) {
    EXPECT_DOUBLE_EQ(c.get(solve_with({{c.name, c.text}}).scene), c.expected) << c.name;
    tried.insert(c.name);
  }
  for (const Option& entry : option_table()) {
    EXPECT_TRUE(entry.set == nullptr || tried.contains(name_for(entry, "high")))
        << entry.name << " is not tried";
  }
}

TEST(Scene, SegmentValueWinsOverGeneralValue) {
  const auto& modules =
      solve_with({{"bandage_high_stretch", "1.5"}, {"bandage_low_voltage", "0"}, {"voltage", "5 kV"}})
          .scene.bandage.modules;
  EXPECT_EQ(modules[0].stretch, 2);
  EXPECT_EQ(modules[1].stretch, 1.5);
  EXPECT_EQ(modules[0].voltage, 0);
  EXPECT_EQ(modules[1].voltage, 5000);
}

// A name alone is wanted of all segments; what only one carries leaves the others unsolved.
TEST(Scene, OutputsOfOneSegment) {
  model::Scene scene =
      solve_with({{"fidelity", "auto"}, {"outputs", "pressure_rest, HIGH.volume_change"}}).scene;
  EXPECT_TRUE(scene.goal.of(0).pressure_rest && scene.goal.of(1).pressure_rest);
  EXPECT_FALSE(scene.goal.of(0).actuated());
  EXPECT_TRUE(scene.goal.of(1).volume_change);
  scene = solve_with({{"fidelity", "auto"}, {"outputs", "low.actuation_drop"}, {"accuracy", "1e-4"}}).scene;
  EXPECT_TRUE(scene.wants(0) && scene.goal.of(0).actuation_drop && !scene.goal.of(0).pressure_rest);
  EXPECT_FALSE(scene.wants(1));
  EXPECT_EQ(scene.goal.accuracy, 1e-4);
  scene.fidelity = model::Fidelity::slice;  // which solves all
  EXPECT_TRUE(scene.wants(1));
  scene = solve_with({{"fidelity", "auto"}, {"outputs", "volume_change"}}).scene;
  EXPECT_TRUE(scene.goal.of_segment.empty() && scene.goal.of(1).volume_change &&
              !scene.goal.of(1).pressure_rest);
}

TEST(Scene, SegmentsStandAnkleUpAndNamesIgnoreCase) {
  Given given = two_segments_with({{"Bandage_HIGH_Voltage", "1 kV"}});
  given["leg_segments"] = "Low, high";
  const Request request = parse_request(Command::solve, given);
  EXPECT_EQ(request.scene.leg.segments[0].name, "Low");
  EXPECT_EQ(request.scene.leg.segments[0].lower_radius, 0.035);
  EXPECT_EQ(request.scene.bandage.modules[1].voltage, 1000);
}

TEST(Scene, ProgramOptions) {
  const Request plain = solve_with({});
  EXPECT_EQ(plain.output, "gaiter.h5");
  EXPECT_FALSE(plain.dry_run);
  EXPECT_EQ(plain.comparison, Comparison::none);
  const Request request = solve_with({{"output", "a.h5"}, {"dry_run", ""}, {"comparison", "paper"}});
  EXPECT_EQ(request.output, "a.h5");
  EXPECT_TRUE(request.dry_run);
  EXPECT_EQ(request.comparison, Comparison::paper);
  EXPECT_TRUE(request.unknown.empty());
  EXPECT_FALSE(solve_with({{"dry_run", "false"}}).dry_run);
}

TEST(Scene, ExtremesAreAdmitted) {
  for (const Given& given :
       std::vector<Given>{{{"bandage_thickness", "1e-9 m"}},
                          {{"bandage_thickness", "18 mm"}},  // 0.9 of the reference radius
                          {{"bandage_stretch", "1.000000000001"}},
                          {{"bandage_stretch", "0.5"}},  // slack
                          {{"bandage_stretch", "6"}},
                          {{"bandage_ogden_mu", "1 Pa,1 GPa"}},
                          {{"bandage_ogden_alpha", "30,-30"}, {"bandage_ogden_mu", "1,-1"}},
                          {{"voltage", "1 MV"}},
                          {{"leg_compliance_data_limit", "inf"}}}) {
    EXPECT_EQ(error_of(two_segments_with(given)), "") << given.begin()->first;
  }
}

TEST(Errors, NameOptionValueAndWhatIsAllowed) {
  using Pieces = std::vector<std::string>;
  const std::vector<std::tuple<std::string, std::string, Pieces>> cases = {
      {"bandage_thickness", "-1 mm", {"-bandage_thickness '-1 mm': must be at least 1e-10 m", "e.g. '1 mm'"}},
      {"bandage_thickness", "1 mn", {"-bandage_thickness '1 mn'", "unknown unit 'mn'", "at most 1 m"}},
      {"bandage_thickness", "1 kPa", {"'1 kPa'", "cannot be converted to 'm'"}},
      {"bandage_thickness", "", {"-bandage_thickness ''", "a value is missing"}},
      {"bandage_stretch", "0", {"-bandage_stretch '0'", "at least 0.001 and at most 20"}},
      {"bandage_stretch", "20.1", {"at least 0.001 and at most 20"}},
      {"bandage_stretch", "1e-300", {"-bandage_stretch '1e-300'", "at least 0.001"}},
      {"bandage_stretch", "nan", {"'nan' is not a number"}},
      {"bandage_stretch", "inf", {"-bandage_stretch 'inf'", "at most 20"}},
      {"bandage_stretch", "1,2", {"2 values given"}},
      {"bandage_low_stretch", "0", {"-bandage_low_stretch '0'"}},
      {"bandage_layers", "0", {"a whole number at least 1 and at most 1000"}},
      {"bandage_layers", "2.5", {"'2.5' is not a whole number"}},
      {"bandage_permittivity", "0.9", {"at least 1"}},
      {"bandage_length_at", "outr", {"-bandage_length_at 'outr': must be outer or middle or inner"}},
      {"bandage_breakdown_field", "0", {"greater than 0 V m-1 (inf is allowed)"}},
      {"bandage_ogden_mu", "1 kPa", {"-bandage_ogden_mu '1000 Pa'", "-bandage_ogden_alpha '[3.5, 12]'"}},
      {"bandage_ogden_mu", "1,2,3,4,5,6,7,8,9", {"9 values given", "1 to 8 values"}},
      {"bandage_ogden_mu", "-1 kPa, 1 Pa", {"-bandage_ogden_mu '[-1000 Pa, 1 Pa]'", "[3.5, 12]", "-1744 Pa"}},
      {"bandage_ogden_alpha", "3,0", {"value 2 is out of range", "magnitude greater than 0 and at most 50"}},
      {"bandage_ogden_alpha", "3,-51", {"value 2 is out of range"}},
      {"leg_low_radius", "35 mm", {"-leg_low_radius '35 mm'", "1 value given", "2 values"}},
      {"leg_low_compliance", "1,2,-1,-1", {"value 1 is out of range", "a greater than 0 and less than 1"}},
      {"leg_low_compliance", ".1,0,-.1,-1", {"value 2 is out of range"}},
      {"leg_low_compliance", ".1,1,.1,-1", {"value 3 is out of range"}},
      {"leg_low_compliance", ".1,1,-.1,0", {"value 4 is out of range"}},
      {"leg_low_compliance", ".1,1,-1.2,-1", {"-leg_low_compliance '0.1, 1 Pa-1, -1.2, -1 Pa-1'", "a + c"}},
      {"leg_poisson", "0.5", {"at least 0 and less than 0.5"}},
      {"leg_young", "-1 kPa", {"-leg_young '-1 kPa'"}},
      {"leg_model", "stiff", {"compliant or rigid"}},
      {"voltage", "-1", {"-voltage '-1'", "at least 0 V"}},
      {"slice_count", "0", {"at least 1 and at most 100000"}},
      {"wall_points",
       "129",
       {"-wall_points '129': must be auto or a whole number at least 1 and at most 128"}},
      {"dry_run", "maybe", {"-dry_run 'maybe': must be true or false"}},
      {"output", "", {"-output ''", "a file name"}},
      {"leg_mid_radius", "1,2", {"unknown segment 'mid' in -leg_mid_radius; the segments are low, high"}},
      {"leg_<s>_height", "1", {"unknown segment '<s>' in -leg_<s>_height"}},
      {"bandage_mid_stretch", "1", {"unknown segment 'mid' in -bandage_mid_stretch"}},
      {"leg_segments", "low,high,low", {"'low' is there twice"}},
      {"leg_segments", "low,High,high", {"'high' is there twice"}},
      {"leg_segments", "low,hi gh", {"'hi gh' is no name"}},
      {"leg_segments", "low,", {"a name is missing"}},
      {"sweep_bandage_stretch", "1,2", {"belongs to the command sweep"}}};
  for (const auto& [name, text, pieces] : cases) {
    SCOPED_TRACE(name + " = " + text);
    expect_error(two_segments_with({{name, text}}), pieces);
  }
}

TEST(Errors, SegmentNamesThatAreWordsOfOptions) {
  for (const char* word : {"segments", "model", "material", "young", "poisson", "compliance", "stretch",
                           "Ogden", "thickness", "layers", "radius", "height", "voltage", "length"}) {
    expect_error({{"leg_segments", word}}, {"-leg_segments", word, "a word of the option names"});
  }
}

TEST(Errors, WallLeavesNoHole) {
  // Reference radius of the lower module: 40 mm / 2.
  expect_error(two_segments_with({{"bandage_thickness", "20 mm"}}),
               {"-bandage_thickness '0.02 m'", "low", "stretch 2", "less than 0.02 m"});
  EXPECT_EQ(error_of(two_segments_with({{"bandage_thickness", "19.99 mm"}})), "");
  const Given middle = {{"bandage_length_at", "middle"}, {"bandage_thickness", "39.99 mm"}};
  EXPECT_EQ(error_of(two_segments_with(middle)), "");
  expect_error(two_segments_with({{"bandage_length_at", "middle"}, {"bandage_thickness", "40 mm"}}),
               {"less than 0.04 m"});
  EXPECT_EQ(error_of(two_segments_with({{"bandage_length_at", "inner"}, {"bandage_thickness", "40 mm"}})),
            "");
  expect_error(two_segments_with({{"bandage_high_length", "2 cm"}, {"bandage_thickness", "4 mm"}}),
               {"high", "length 0.02 m", "less than 0.0031831 m"});
}

TEST(Errors, LengthOutOfStretch) {
  expect_error(two_segments_with({{"bandage_high_length", "10 mm"}}),
               {"-bandage_high_length '0.01 m'", "stretches the module by", "at least 0.001 and at most 20"});
  expect_error(two_segments_with({{"bandage_high_length", "900 m"}}), {"-bandage_high_length '900 m'"});
}

TEST(Errors, MissingAndExclusiveOptions) {
  for (const char* name : {"leg_segments", "leg_low_radius", "leg_high_height", "leg_low_compliance",
                           "bandage_ogden_mu", "bandage_ogden_alpha", "bandage_stretch"}) {
    Given given = two_segments();
    given.erase(name);
    expect_error(given, {"-" + std::string(name) + " is missing", "e.g. '"});
  }
  for (const Given& without : std::vector<Given>{
           {{"leg_model", "rigid"}}, {{"fidelity", "rigid"}}, {{"leg_material", "neo_hookean"}}}) {
    Given given = two_segments_with(without);
    given.erase("leg_low_compliance");
    EXPECT_EQ(error_of(given), "");
  }
  Given own = two_segments_with({{"bandage_low_length", "12 cm"}, {"bandage_high_stretch", "1.5"}});
  own.erase("bandage_stretch");
  EXPECT_EQ(error_of(own), "");
  expect_error(two_segments_with({{"bandage_low_length", "12 cm"}, {"bandage_low_stretch", "1.5"}}),
               {"-bandage_low_length '0.12 m'", "-bandage_low_stretch '1.5'", "not both"});
}

TEST(Errors, UnknownOptions) {
  const Request request = solve_with({{"slice_snes_monitor", ""}, {"bandage_permitivity", "3"}});
  EXPECT_EQ(request.unknown, (std::vector<std::string>{"bandage_permitivity", "slice_snes_monitor"}));
  const auto complaint = [&](const char* name) {
    return std::string(unknown_option(name, request.scene.leg.segments).what());
  };
  EXPECT_EQ(complaint("bandage_strech"), "unknown option -bandage_strech; did you mean -bandage_stretch?");
  EXPECT_EQ(complaint("leg_low_radus"), "unknown option -leg_low_radus; did you mean -leg_low_radius?");
  EXPECT_EQ(complaint("swep_bandage_high_stretch"),
            "unknown option -swep_bandage_high_stretch; did you mean -sweep_bandage_high_stretch?");
  EXPECT_EQ(complaint("zzz"), "unknown option -zzz; -help lists all");
  // A misspelt option that is thereby missing: the spelling is the message.
  Given given = two_segments_with({{"bandage_strech", "2"}});
  given.erase("bandage_stretch");
  expect_error(given, {"did you mean -bandage_stretch?"});
  given = two_segments_with({{"leg_segmnts", "low,high"}});
  given.erase("leg_segments");
  expect_error(given, {"did you mean -leg_segments?"});
}

TEST(ResolvedText, GivesTheSameRequestAgain) {
  const Given given = two_segments_with({{"bandage_high_length", "15.1 cm"},
                                         {"bandage_low_voltage", "11.3 kV"},
                                         {"leg_low_radius", "35.85 mm, 43.37 mm"},
                                         {"leg_compliance_data_limit", "50 mmHg"},
                                         {"comparison", "paper"},
                                         {"wall_points", "5"},
                                         {"slice_rule", "midpoint"},
                                         {"outputs", "pressure_rest,HIGH.actuation_drop"},
                                         {"dry_run", ""},
                                         {"output", "elsewhere.h5"}});
  const Request first = parse_request(Command::solve, given);
  const Request again = parse_request(Command::solve, tests::flat_yaml(first.text));
  EXPECT_EQ(tests::describe(again.scene), tests::describe(first.scene));
  EXPECT_EQ(again.text, first.text);
  EXPECT_EQ(again.comparison, Comparison::paper);
  EXPECT_EQ(first.text.find("elsewhere"), std::string::npos);
  EXPECT_EQ(first.text.find("dry_run"), std::string::npos);
  // Defaults are spelt out, in SI.
  for (const char* line : {"bandage_thickness: 0.001 m\n", "bandage_breakdown_field: inf V m-1\n",
                           "voltage: 0 V\n", "leg_low_radius: [0.03585 m, 0.04337 m]\n",
                           "leg_segments: [low, high]\n", "slice_count: 6\n", "fidelity: slice\n"}) {
    EXPECT_NE(first.text.find(line), std::string::npos) << line << first.text;
  }
}

TEST(ResolvedText, HoldsEveryOptionOfTheScene) {
  Given given = tests::flat_yaml(solve_with({}).text);
  for (const Option& entry : option_table()) {
    if (entry.set == nullptr || entry.scope == Scope::one_segment) continue;
    EXPECT_TRUE(given.contains(std::string(entry.name))) << entry.name;
  }
}

TEST(Help, ListsEveryOptionWithUnitDefaultAndRange) {
  const std::string text = help_text(), markdown = help_markdown();
  for (const Option& entry : option_table()) {
    const std::string dashed = "-" + std::string(entry.name);
    const auto at = text.find("\n  " + dashed + " ");
    ASSERT_NE(at, std::string::npos) << dashed;
    const std::string line = text.substr(at + 1, text.find('\n', at + 1) - at - 1);
    EXPECT_NE(line.find(allowed(entry)), std::string::npos) << line;
    EXPECT_NE(line.find(entry.default_text), std::string::npos) << line;
    EXPECT_NE(text.find(entry.doc), std::string::npos) << dashed;
    EXPECT_NE(markdown.find("| `" + dashed + "` |"), std::string::npos) << dashed;
  }
  // A line of the Markdown table has six columns, so no text in it may hold a bar.
  std::istringstream lines(markdown);
  for (std::string line; std::getline(lines, line);) {
    EXPECT_EQ(std::count(line.begin(), line.end(), '|'), 7) << line;
  }
}

}  // namespace
