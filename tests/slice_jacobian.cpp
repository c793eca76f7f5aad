// SPDX-License-Identifier: BSD-2-Clause
#include <gtest/gtest.h>

#include <algorithm>
#include <functional>

#include "gaiter/physics/slice_kernel.hpp"
#include "gaiter/physics/slice_newton.hpp"
#include "random_slices.hpp"

// The same two checks of the derivative of every law and of the residual block: central differences, and
// Taylor's rate (the remainder beyond the linear term falls with the square of the step). Both fail where a
// law is exactly zero everywhere, and so tells nothing.
namespace {

using namespace gaiter;
using model::LegMaterial;
using physics::Pack;
using physics::pack_width;
using samples::Sampler;

using Law = std::function<void(const Pack& at, Pack& value, Pack& slope)>;

Pack moved(const Pack& from, const Pack& direction, double factor) {
  Pack result;
  for (int i = 0; i < pack_width; ++i) result[i] = from[i] + factor * direction[i];
  return result;
}

// `size`: the scale over which each law changes at `at`; steps are parts of it.
void check_derivative(const Law& law, const Pack& at, const Pack& size) {
  Pack value, slope, up, down, unused;
  law(at, value, slope);
  double largest = 0;
  for (int i = 0; i < pack_width; ++i) largest = std::max(largest, std::fabs(value[i]));
  ASSERT_GT(largest, 0) << "the law is zero everywhere";

  // Best step of a central difference: the cube root of rounding; its error is the square of that.
  const double step = 1e-5;
  law(moved(at, size, step), up, unused);
  law(moved(at, size, -step), down, unused);
  for (int i = 0; i < pack_width; ++i) {
    const double difference = (up[i] - down[i]) / (2 * step);
    const double rounding = 1e-15 * (std::fabs(up[i]) + std::fabs(down[i])) / step;
    EXPECT_NEAR(slope[i] * size[i], difference, 1e-7 * std::fabs(difference) + rounding) << "slice " << i;
  }

  // Remainders at falling steps; the fitted slope of their logarithms.
  const double steps[] = {2e-2, 1e-2, 5e-3, 2.5e-3};
  std::vector<double> rates;
  Pack remainder[4];
  for (int k = 0; k < 4; ++k) {
    law(moved(at, size, steps[k]), up, unused);
    for (int i = 0; i < pack_width; ++i)
      remainder[k][i] = std::fabs(up[i] - value[i] - steps[k] * size[i] * slope[i]);
  }
  for (int i = 0; i < pack_width; ++i) {
    // Where the second derivative happens to vanish, rounding hides the remainder.
    if (remainder[3][i] < 1e-13 * (std::fabs(value[i]) + std::fabs(slope[i] * size[i]))) continue;
    double sx = 0, sy = 0, sxx = 0, sxy = 0;
    for (int k = 0; k < 4; ++k) {
      const double x = std::log(steps[k]), y = std::log(remainder[k][i]);
      sx += x, sy += y, sxx += x * x, sxy += x * y;
    }
    const double rate = (4 * sxy - sx * sy) / (4 * sxx - sx * sx);
    // 1 with a wrong derivative; where second and third order nearly cancel it is a little off 2.
    EXPECT_GT(rate, 1.4) << "slice " << i;
    rates.push_back(rate);
  }
  ASSERT_GT(rates.size(), pack_width / 2u);
  std::nth_element(rates.begin(), rates.begin() + rates.size() / 2, rates.end());
  EXPECT_NEAR(rates[rates.size() / 2], 2, 0.1);
}

class Derivatives : public testing::TestWithParam<LegMaterial> {
 protected:
  static constexpr int rounds = 8;

  std::vector<model::Scene> scenes(int round) {
    Sampler sampler(100 + round);
    std::vector<model::Scene> result;
    for (int i = 0; i < pack_width; ++i) result.push_back(sampler.scene(GetParam(), 1 + round % 3));
    return result;
  }
};

TEST_P(Derivatives, OfTheLegsStrain) {
  for (int round = 0; round < rounds; ++round) {
    const auto system = samples::system_of(scenes(round), 3);
    Sampler sampler(200 + round);
    Pack pressure;
    for (int i = 0; i < pack_width; ++i) pressure[i] = sampler.logarithmic(1e-3, 3);
    check_derivative(
        [&](const Pack& at, Pack& value, Pack& slope) {
          physics::leg_strain(system.shape(), system.pack(0), at, value, slope);
        },
        pressure, pressure);
  }
}

// Size: what is left of the leg's strain until the tube's inner face is at its reference radius, at most.
Pack strain_size(const physics::SliceSystem& system, const Pack& strain) {
  Pack size;
  for (int i = 0; i < pack_width; ++i)
    size[i] = std::clamp(
        system.constant(i, physics::SliceShape::gap) / system.constant(i, physics::SliceShape::leg_radius) -
            strain[i],
        0.01, 0.1);
  return size;
}

TEST_P(Derivatives, OfTheBandagesPressure) {
  for (int round = 0; round < rounds; ++round)
    for (const bool energised : {false, true}) {
      auto system = samples::system_of(scenes(round), 3);
      system.energise(energised);
      Sampler sampler(300 + round);
      Pack strain;
      for (int i = 0; i < pack_width; ++i) strain[i] = sampler.uniform(-0.1, 0.3);
      check_derivative(
          [&](const Pack& at, Pack& value, Pack& slope) {
            physics::bandage_pressure(system.shape(), system.pack(0), at, value, slope);
          },
          strain, strain_size(system, strain));
    }
}

TEST_P(Derivatives, OfTheActuationPressure) {
  for (int round = 0; round < rounds; ++round) {
    const auto system = samples::system_of(scenes(round), 3);
    Sampler sampler(400 + round);
    Pack strain;
    for (int i = 0; i < pack_width; ++i) strain[i] = sampler.uniform(-0.1, 0.3);
    check_derivative(
        [&](const Pack& at, Pack& value, Pack& slope) {
          physics::actuation_pressure(system.shape(), system.pack(0), at, value, slope);
        },
        strain, strain_size(system, strain));
  }
}

// The block [1, -eps_r'; -P_t', 1] along random directions of (strain, pressure), for F1 and F2 apart.
TEST_P(Derivatives, OfTheResidualBlock) {
  for (int round = 0; round < rounds; ++round) {
    const auto system = samples::system_of(scenes(round), 3);
    Sampler sampler(500 + round);
    Pack strain, pressure, strain_direction, pressure_direction;
    for (int i = 0; i < pack_width; ++i) {
      pressure[i] = sampler.logarithmic(1e-2, 3);
      strain[i] = sampler.uniform(-0.1, 0.3);
    }
    const Pack size = strain_size(system, strain);
    for (int i = 0; i < pack_width; ++i) {
      strain_direction[i] = size[i] * sampler.uniform(0.3, 1);
      pressure_direction[i] = pressure[i] * sampler.uniform(0.3, 1);
    }
    for (const bool first : {true, false}) {
      Pack origin{}, one;
      for (int i = 0; i < pack_width; ++i) one[i] = 1;
      check_derivative(
          [&](const Pack& at, Pack& value, Pack& slope) {
            physics::PackState state{};
            for (int i = 0; i < pack_width; ++i) {
              state.strain[i] = strain[i] + at[i] * strain_direction[i];
              state.pressure[i] = pressure[i] + at[i] * pressure_direction[i];
            }
            physics::evaluate_residual(system.shape(), system.pack(0), state);
            for (int i = 0; i < pack_width; ++i) {
              value[i] = first ? state.strain_residual[i] : state.pressure_residual[i];
              slope[i] = first ? strain_direction[i] - state.strain_slope[i] * pressure_direction[i]
                               : pressure_direction[i] - state.bandage_slope[i] * strain_direction[i];
            }
          },
          origin, one);
    }
  }
}

// Without contact F2 is P alone, and the block says so.
TEST_P(Derivatives, OfTheResidualWithoutContact) {
  const auto system = samples::system_of(scenes(0), 3);
  physics::PackState state{};
  for (int i = 0; i < pack_width; ++i) {
    state.pressure[i] = -1e-3;
    state.strain[i] = 0.9;  // shrunk far below the bandage
  }
  physics::evaluate_residual(system.shape(), system.pack(0), state);
  for (int i = 0; i < pack_width; ++i) {
    EXPECT_EQ(state.pressure_residual[i], -1e-3);
    EXPECT_EQ(state.bandage_slope[i], 0);
  }
}

TEST_P(Derivatives, BlocksAreInvertedAsTheyAre) {
  Sampler sampler(600);
  Pack strain_slope, bandage_slope, first, second, strain, pressure;
  for (int i = 0; i < pack_width; ++i) {
    strain_slope[i] = sampler.logarithmic(1e-3, 10);
    bandage_slope[i] = -sampler.logarithmic(1e-3, 10);
    first[i] = sampler.uniform(-1, 1);
    second[i] = sampler.uniform(-1, 1);
  }
  physics::solve_blocks(strain_slope, bandage_slope, first, second, strain, pressure);
  for (int i = 0; i < pack_width; ++i) {
    EXPECT_NEAR(strain[i] - strain_slope[i] * pressure[i], first[i], 1e-14 * (1 + std::fabs(strain[i])));
    EXPECT_NEAR(pressure[i] - bandage_slope[i] * strain[i], second[i], 1e-13 * (1 + std::fabs(pressure[i])));
  }
}

INSTANTIATE_TEST_SUITE_P(Legs, Derivatives,
                         testing::Values(LegMaterial::compliance, LegMaterial::neo_hookean),
                         [](const auto& info) {
                           return info.param == LegMaterial::compliance ? "compliance" : "neo_hookean";
                         });

}  // namespace
