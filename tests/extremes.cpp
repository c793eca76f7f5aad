// SPDX-License-Identifier: BSD-2-Clause
#include <gtest/gtest.h>

#include "extremes_systems.hpp"

// A part of the table that benchmarks/extremes prints in full: every status is the reference's, no pressure
// is further off than the program's own estimate says, and no result further than rounding and Newton's
// tolerance (1e-12 of the pressure) times its condition number.
namespace {

using namespace gaiter;

constexpr int draws = 4;
constexpr double pressures = 5e-12, others = 5e-10;  // a steep law of the leg magnifies the pressure's error

TEST(Extremes, ErrorsStayWithinConditionAndEstimate) {
  for (const auto& line : extremes::lines()) {
    samples::Sampler sampler(2);
    for (int number = 0, tries = 0; number < draws && tries < 500; ++tries) {
      const auto made = line.draw(sampler, number);
      if (!made) continue;
      SCOPED_TRACE(line.quantity + ", draw " + std::to_string(number));
      ++number;
      const auto found = extremes::compare(*made);
      EXPECT_EQ(found.status, found.expected);
      EXPECT_LE(found.pressure_error, found.estimate);
      const bool pressure = found.output <= reference::actuated_rigid;
      EXPECT_LE(found.amplification * 2.2e-16, pressure ? pressures : others)
          << reference::output_names[found.output] << " error " << found.error << " condition "
          << found.condition;
    }
  }
}

TEST(Extremes, UnitsDoNotMatter) {
  const auto found = extremes::compare_units();
  EXPECT_LE(found.ulps, 1);
  EXPECT_LE(found.amplification, 1e3);
}

TEST(Extremes, ManySlicesOfVeryDifferentScaleInOneSystem) {
  const auto found = extremes::solve_many(0, 20000, 40);
  EXPECT_EQ(found.unsolved, 0);
  EXPECT_EQ(found.other_bits, 0u);
  EXPECT_LE(found.error, 5e-9);
}

// Crushed at one end of the bracket and far from the leg's pressure at the other, where Newton's step and the
// far step used to take turns.
TEST(Extremes, StepsThatTookTurns) {
  for (const std::size_t slice : {147366, 296378, 580038, 770836, 889170}) {
    const auto found = extremes::solve_many(slice, 1, 1);
    EXPECT_EQ(found.unsolved, 0) << slice;
    EXPECT_LE(found.error, 1e-9) << slice;
  }
}

}  // namespace
