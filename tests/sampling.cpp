// SPDX-License-Identifier: BSD-2-Clause
#include <gtest/gtest.h>

#include <boost/math/distributions/normal.hpp>
#include <boost/random/sobol.hpp>
#include <cmath>

#include "gaiter/studies/designs.hpp"
#include "gaiter/studies/scene_checks.hpp"
#include "gaiter/studies/scene_options.hpp"
#include "option_samples.hpp"

namespace {

using namespace gaiter;
using namespace gaiter::studies;
using tests::Given;
using tests::two_segments_with;

Request sweep_with(Given more) {
  return parse_request(Command::sweep, two_segments_with(more));
}

Designs designs_of(const Given& more) {
  const Request request = sweep_with(more);
  return Designs(request.axes, request.sampling);
}

std::vector<double> at(const Designs& designs, std::int64_t design) {
  std::vector<double> values(designs.axes().size());
  designs.values(design, values);
  return values;
}

const Given three_axes = {{"sweep_bandage_stretch", "uniform(1.2,2)"},
                          {"sweep_bandage_thickness", "normal(1 mm,0.05 mm)"},
                          {"sweep_voltage", "uniform(0,10 kV)"},
                          {"sweep_samples", "4000"}};

Given with(Given given, const std::string& name, const std::string& text) {
  given[name] = text;
  return given;
}

TEST(SweepValues, PointsOfLinesAndScales) {
  const Designs line = designs_of({{"sweep_bandage_thickness", "linspace(0.5 mm, 2 mm, 4)"}});
  ASSERT_EQ(line.size(), 4);
  for (int i = 0; i < 4; ++i) EXPECT_DOUBLE_EQ(at(line, i)[0], 0.5e-3 * (i + 1));
  EXPECT_EQ(at(line, 3)[0], 2e-3);  // the ends as they are written
  const Designs scale = designs_of({{"sweep_leg_young", "logspace(1,100 kPa,3)"}});
  ASSERT_EQ(scale.size(), 3);
  EXPECT_EQ(at(scale, 0)[0], 1e3);
  EXPECT_NEAR(at(scale, 1)[0], 1e4, 1e-9);
  EXPECT_EQ(at(scale, 2)[0], 1e5);
  const Designs layers = designs_of({{"sweep_bandage_layers", "linspace(1,9,5)"}});
  EXPECT_EQ(at(layers, 1)[0], 3);
  EXPECT_EQ(designs_of({{"sweep_voltage", "linspace(0,1 kV,1000000)"},
                        {"sweep_leg_young", "logspace(1e4,1e5,1000000)"}})
                .size(),
            1'000'000'000'000);
}

TEST(SweepValues, OneNumberOfSeveral) {
  const Request request = sweep_with({{"sweep_leg_low_radius_upper", "46,48 mm"},
                                      {"sweep_leg_low_radius_lower", "34,36 mm"},
                                      {"sweep_bandage_ogden_mu_2", "5,20"}});
  const Designs designs(request.axes);
  ASSERT_EQ(designs.size(), 8);
  EXPECT_EQ(designs.axes()[0].name, "bandage_ogden_mu_2");
  model::Scene scene = request.scene;
  EXPECT_EQ(put_design(designs, 6, scene), "");
  EXPECT_EQ(scene.bandage.ogden[0].mu, 20e3);
  EXPECT_EQ(scene.bandage.ogden[0].alpha, 3.5);
  EXPECT_EQ(scene.bandage.ogden[1].mu, 20);
  EXPECT_EQ(scene.leg.segments[0].lower_radius, 0.036);
  EXPECT_EQ(scene.leg.segments[0].upper_radius, 0.046);
  EXPECT_EQ(scene.leg.segments[1].lower_radius, 0.045);
}

TEST(SweepValues, ScalesOfTheWholeLeg) {
  const Request request = sweep_with({{"sweep_leg_radius_scale", "0.5,2"},
                                      {"sweep_leg_compliance_scale", "3,1"},
                                      {"sweep_leg_high_radius_lower", "44,45 mm"}});
  const Designs designs(request.axes);
  model::Scene scene = request.scene;
  for (const int design : {7, 0, 3, 0}) {  // a scale is never applied twice
    EXPECT_EQ(put_design(designs, design, scene), "");
    const auto values = at(designs, design);
    EXPECT_DOUBLE_EQ(scene.leg.segments[0].upper_radius, 0.045 * values[2]);
    EXPECT_DOUBLE_EQ(scene.leg.segments[1].lower_radius, values[1] * values[2]);
    EXPECT_DOUBLE_EQ(scene.leg.segments[1].compliance.a, 0.010 * values[0]);
    EXPECT_DOUBLE_EQ(scene.leg.segments[1].compliance.c, -0.014 * values[0]);
    EXPECT_EQ(scene.leg.segments[1].compliance.b, 5e-5);
  }
}

TEST(Sampling, SobolIsBoosts) {
  const Designs designs = designs_of(with(three_axes, "sweep_sampler", "sobol"));
  ASSERT_EQ(designs.size(), 4000);
  boost::random::sobol engine(3);
  const boost::math::normal thickness(1e-3, 0.05e-3);
  for (int design = 0; design < 4000; ++design) {
    double place[3];
    for (double& p : place) p = (std::floor(static_cast<double>(engine()) * 0x1p-11) + 0.5) * 0x1p-53;
    const auto values = at(designs, design);
    ASSERT_NEAR(values[0], 1.2 + 0.8 * place[0], 1e-14);
    ASSERT_NEAR(values[1], boost::math::quantile(thickness, place[1]), 1e-17);
    ASSERT_NEAR(values[2], 1e4 * place[2], 1e-10);
  }
}

TEST(Sampling, ADesignDependsOnItsNumberAlone) {
  for (const char* sampler : {"sobol", "random"}) {
    for (const char* seed : {"0", "17"}) {
      const Given given = with(with(three_axes, "sweep_sampler", sampler), "sweep_seed", seed);
      const Designs forwards = designs_of(given),
                    jumping = designs_of(with(given, "sweep_samples", "9999999"));
      for (int i = 0; i < 500; ++i) {
        const std::int64_t design = i * 7919 % 4000;
        EXPECT_EQ(at(forwards, i), at(jumping, i));
        EXPECT_EQ(at(forwards, design), at(jumping, design));
      }
      EXPECT_NO_THROW(at(jumping, 9999998));
    }
  }
}

TEST(Sampling, AnotherSeedGivesOthers) {
  for (const char* sampler : {"sobol", "random"}) {
    const Given given = with(three_axes, "sweep_sampler", sampler);
    EXPECT_NE(at(designs_of(given), 5), at(designs_of(with(given, "sweep_seed", "1")), 5));
  }
}

// Mean and variance of what is drawn, and that axes do not go together.
TEST(Sampling, DistributionsAreThoseAsked) {
  for (const char* sampler : {"sobol", "random"})
    for (const char* seed : {"0", "3"}) {
      SCOPED_TRACE(fmt::format("{} {}", sampler, seed));
      const Designs designs =
          designs_of(with(with(three_axes, "sweep_sampler", sampler), "sweep_seed", seed));
      const int count = 4000;
      double sum[3] = {}, squares[3] = {}, mixed = 0;
      for (int i = 0; i < count; ++i) {
        const auto v = at(designs, i);
        const double unit[3] = {(v[0] - 1.6) / 0.8, (v[1] - 1e-3) / 0.05e-3, v[2] / 1e4 - 0.5};
        for (int k = 0; k < 3; ++k) sum[k] += unit[k], squares[k] += unit[k] * unit[k];
        mixed += unit[0] * unit[2];
      }
      // Five standard errors of random numbers; Sobol's are far better.
      const double slack = 5 / std::sqrt(count);
      EXPECT_NEAR(sum[0] / count, 0, slack * 0.29);
      EXPECT_NEAR(sum[1] / count, 0, slack);
      EXPECT_NEAR(squares[0] / count, 1 / 12.0, slack * 0.08);
      EXPECT_NEAR(squares[1] / count, 1, slack * 1.5);
      EXPECT_NEAR(mixed / count, 0, slack / 12);
    }
}

TEST(Sampling, ListsAndWholeNumbersAreDrawnEvenly) {
  const Designs designs = designs_of({{"sweep_bandage_layers", "uniform(1,4)"},
                                      {"sweep_bandage_stretch", "1.4,1.8"},
                                      {"sweep_sampler", "sobol"},
                                      {"sweep_samples", "1023"}});
  std::map<double, int> layers, stretches;
  for (int i = 0; i < 1023; ++i) ++layers[at(designs, i)[0]], ++stretches[at(designs, i)[1]];
  EXPECT_EQ(layers.size(), 4u);
  EXPECT_EQ(stretches.size(), 2u);
  for (const auto& [value, count] : layers) EXPECT_NEAR(count, 256, 2) << value;
}

// A distribution may draw what the option does not allow: such a design is no error of the whole sweep.
TEST(Sampling, WhatIsDrawnOutOfRangeIsTold) {
  const Request request = sweep_with({{"sweep_bandage_thickness", "normal(1 mm,1 mm)"},
                                      {"sweep_sampler", "random"},
                                      {"sweep_samples", "1000"}});
  const Designs designs(request.axes, request.sampling);
  model::Scene scene = request.scene;
  int refused = 0;
  for (int i = 0; i < 1000; ++i) {
    const std::string fault = put_design(designs, i, scene);
    const bool sound = at(designs, i)[0] >= 1e-10;
    EXPECT_EQ(fault.empty(), sound);
    refused += !sound;
    if (!sound) {
      EXPECT_NE(fault.find("-bandage_thickness '-"), std::string::npos) << fault;
    }
  }
  EXPECT_NEAR(refused, 159, 50);
}

TEST(Sampling, ResolvedTextGivesTheSameSweepAgain) {
  const Request first = sweep_with(with(with(three_axes, "sweep_sampler", "random"), "sweep_seed", "5"));
  const Request again = parse_request(Command::sweep, tests::flat_yaml(first.text));
  EXPECT_EQ(again.text, first.text);
  EXPECT_NE(first.text.find("sweep_bandage_thickness: normal(0.001 m, 5e-05 m)\n"), std::string::npos)
      << first.text;
  EXPECT_EQ(at(Designs(again.axes, again.sampling), 77), at(Designs(first.axes, first.sampling), 77));
}

TEST(Sampling, ErrorsNameOptionValueAndWhatIsAllowed) {
  const std::vector<std::pair<Given, std::vector<std::string>>> cases = {
      {{{"sweep_bandage_stretch", "linspace(1,2)"}},
       {"-sweep_bandage_stretch 'linspace(1,2)'", "3 arguments"}},
      {{{"sweep_bandage_stretch", "linspace(0,2,5)"}}, {"first end is out of range", "at least 0.001"}},
      {{{"sweep_bandage_stretch", "linspace(1,2,0)"}}, {"'0' is no whole number of at least 1"}},
      {{{"sweep_bandage_stretch", "linspaced(1,2,5)"}}, {"neither a list nor a law", "logspace(lo,hi,n)"}},
      {{{"sweep_voltage", "logspace(0,1,5)"}}, {"both ends must be greater than 0"}},
      {{{"sweep_bandage_thickness", "uniform(1 mm,1 kPa)"},
        {"sweep_sampler", "random"},
        {"sweep_samples", "9"}},
       {"'kPa' is wrong here"}},
      {{{"sweep_bandage_stretch", "uniform(2,1)"}}, {"lo must be less than hi"}},
      {{{"sweep_bandage_stretch", "normal(-1,1)"}}, {"its mean is out of range"}},
      {{{"sweep_bandage_stretch", "normal(1,0)"}}, {"standard deviation must be greater than 0"}},
      {{{"sweep_bandage_layers", "linspace(1,2,3)"}}, {"whole numbers"}},
      {{{"sweep_bandage_stretch", "uniform(1,2)"}},
       {"-sweep_bandage_stretch 'uniform(1, 2)'", "-sweep_sampler sobol"}},
      {{{"sweep_bandage_stretch", "1,2"}, {"sweep_samples", "5"}}, {"-sweep_samples '5'", "-sweep_sampler"}},
      {{{"sweep_bandage_stretch", "1,2"}, {"sweep_sampler", "sobol"}}, {"-sweep_samples is missing"}},
      {{{"sweep_bandage_stretch", "1,2"}, {"sweep_sampler", "halton"}}, {"grid or sobol or random"}},
      {{{"sweep_bandage_ogden_mu", "1,2"}}, {"one by one", "-sweep_bandage_ogden_mu_1"}},
      {{{"sweep_bandage_ogden_mu_3", "1,2"}}, {"has only 2 values"}},
      {{{"sweep_bandage_ogden_mu_9", "1,2"}}, {"unknown option", "did you mean -sweep_bandage_ogden_mu_"}}};
  for (const auto& [given, pieces] : cases) {
    const std::string message = tests::error_of(two_segments_with(given), Command::sweep);
    for (const std::string& piece : pieces)
      EXPECT_NE(message.find(piece), std::string::npos) << piece << "\n" << message;
    EXPECT_EQ(message.find('\n'), std::string::npos) << message;
  }
}

}  // namespace
