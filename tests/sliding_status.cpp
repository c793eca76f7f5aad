// SPDX-License-Identifier: BSD-2-Clause
// What becomes of sliding segments at the extremes: an equilibrium that obeys a bound known beforehand, or
// the right status.
#include <gtest/gtest.h>

#include <cmath>

#include "gaiter/petsc/session.hpp"
#include "gaiter/solvers/sliding_model.hpp"
#include "paper_scene.hpp"

namespace gaiter::solvers {
namespace {

using model::Status;

model::SegmentResult slices_of(const model::Scene& scene) {
  const SegmentTask task{&scene, 0};
  return solve_segments(PETSC_COMM_SELF, std::span(&task, 1))[0];
}

model::Scene anchored(double stretch, double voltage) {
  model::Scene scene = paper::scene(stretch, voltage);
  scene.leg.variant = model::ComplianceVariant::anchored;
  return scene;
}

TEST(SlidingStatus, SlackBandageDoesNotPress) {
  model::Scene scene = anchored(0.8, 0);
  const SlidingSolution solution = solve_sliding({&scene, 0});
  EXPECT_EQ(solution.result.status, Status::slack);
  EXPECT_EQ(solution.result.pressure_rest, 0);
  EXPECT_EQ(solution.result.volume_change, 0);
  EXPECT_NEAR(solution.result.volume_rest, solution.result.volume_initial, 1e-15);
  // Unstretched but for its slope, which draws it in by a percent or so: the same all along.
  const double inner = scene.leg.segments[0].mean_radius() / 0.8 - 1e-3;
  for (double r : solution.rest.tube_radius) {
    EXPECT_NEAR(r, inner, 0.015 * inner);
    EXPECT_NEAR(r, solution.rest.tube_radius[0], 1e-10 * inner);
  }
  EXPECT_LT(solution.result.slip_max, 1e-10);
}

TEST(SlidingStatus, SlackAtTheNarrowEndAlone) {
  model::Scene scene = anchored(1.0, 0);
  scene.discretisation.sliding_count = 48;
  const SlidingSolution solution = solve_sliding({&scene, 0});
  EXPECT_EQ(solution.result.status, Status::slack);
  EXPECT_EQ(solution.rest.pressure.front(), 0);
  EXPECT_GT(solution.rest.pressure.back(), 100);
  EXPECT_GT(solution.rest.tube_radius.front(), solution.rest.leg_radius.front());
}

// On a cylinder the slices know when the bandage lifts off and when it is pulled in.
TEST(SlidingStatus, LiftsOffAndIsPulledInAsTheSlicesSay) {
  int lifted = 0, pulled_in = 0;
  for (double voltage = 4e3; voltage < 40e3; voltage *= 1.25) {
    model::Scene scene = paper::cylinder(39.61e-3, 1.1, voltage);
    scene.leg.variant = model::ComplianceVariant::anchored;
    // Stiff along the tube whatever the voltage, so that the axis is no matter: lambda_z = 1 is stable.
    scene.contact_axial = model::ContactAxial::held;
    const Status wanted = slices_of(scene).status;
    const model::SegmentResult result = solve_sliding({&scene, 0}).result;
    EXPECT_EQ(result.status, wanted) << voltage;
    if (wanted == Status::lifted || wanted == Status::pulled_in) {
      EXPECT_EQ(result.pressure_actuated, 0);
    }
    lifted += wanted == Status::lifted;
    pulled_in += wanted == Status::pulled_in;
  }
  EXPECT_GT(lifted, 0);
  EXPECT_GT(pulled_in + lifted, 2);
}

// Free to move along the leg, an actuated cylinder of bandage thins out in one place and bunches up in
// another once d2/d(lambda_z)2 of its energy is negative: there is no stable equilibrium, and none is
// reported.
TEST(SlidingStatus, UnstableAlongTheLegIsNotAnEquilibrium) {
  model::Scene scene = paper::cylinder(39.61e-3, 2.2, 11.3e3);
  scene.leg.variant = model::ComplianceVariant::anchored;
  scene.bandage.layers = 3;
  EXPECT_EQ(slices_of(scene).status, Status::contact);
  const model::SegmentResult result = solve_sliding({&scene, 0}).result;
  EXPECT_EQ(result.status, Status::no_equilibrium);
  EXPECT_TRUE(std::isnan(result.pressure_actuated));
  scene.contact_axial = model::ContactAxial::held;
  EXPECT_EQ(solve_sliding({&scene, 0}).result.status, Status::contact);
}

// On the paper's ankle the smooth frictionless state ends near stretch 2.58, by squeezing the leg in a band
// at its narrow end, where the strain law is used at twice the pressures it was measured at. On a leg that
// does not give way it goes on.
TEST(SlidingStatus, BeyondTheLastStableStretch) {
  for (int count : {24, 96}) {
    for (double stretch : {2.4, 2.55}) {
      model::Scene scene = anchored(stretch, 0);
      scene.discretisation.sliding_count = count;
      const model::SegmentResult result = solve_sliding({&scene, 0}).result;
      EXPECT_EQ(result.status, Status::extrapolated) << stretch;
      EXPECT_LT(result.discretisation_error, 1e-3) << stretch;
    }
    for (double stretch : {2.62, 2.8, 3.5}) {
      model::Scene scene = anchored(stretch, 0);
      scene.discretisation.sliding_count = count;
      EXPECT_EQ(solve_sliding({&scene, 0}).result.status, Status::no_equilibrium) << stretch;
      scene.leg.model = model::LegModel::rigid;
      scene.discretisation.sliding_count = 96;
      const model::SegmentResult rigid = solve_sliding({&scene, 0}).result;
      EXPECT_EQ(rigid.status, Status::contact) << stretch;
      EXPECT_LT(rigid.pressure_rest, slices_of(scene).pressure_rest);
    }
  }
}

struct Extreme {
  const char* name;
  double stretch = 1.4;
  double thickness = 1e-3;
  double elastomer = 1;  // times the surrogate's moduli
  double taper = 1;      // times the ankle's
  double young = 0;      // neo-Hookean leg [Pa]
};

void PrintTo(const Extreme& extreme, std::ostream* out) {
  *out << extreme.name;
}

class SlidingExtremes : public testing::TestWithParam<Extreme> {};

TEST_P(SlidingExtremes, AreSolved) {
  const Extreme& extreme = GetParam();
  model::Scene scene = anchored(extreme.stretch, 0);
  scene.bandage.thickness = extreme.thickness;
  for (model::OgdenTerm& term : scene.bandage.ogden) term.mu *= extreme.elastomer;
  model::Segment& leg = scene.leg.segments[0];
  const double mean = leg.mean_radius(), half = 0.5 * (leg.upper_radius - leg.lower_radius) * extreme.taper;
  leg.lower_radius = mean - half;
  leg.upper_radius = mean + half;
  if (extreme.young > 0) {
    scene.leg.material = model::LegMaterial::neo_hookean;
    scene.leg.young_modulus = extreme.young;
  }
  const SlidingSolution solution = solve_sliding({&scene, 0});
  const model::SegmentResult& result = solution.result;
  ASSERT_TRUE(result.status == Status::contact || result.status == Status::extrapolated ||
              result.status == Status::slack)
      << static_cast<int>(result.status);
  EXPECT_LE(result.iterations, 15);
  EXPECT_LT(result.discretisation_error, 1e-4);
  // The leg gives way, so the pressure is below the rigid leg's; sliding towards the narrow end only.
  EXPECT_LT(result.pressure_rest, result.pressure_rest_rigid * (1 + 1e-12));
  EXPECT_GT(result.pressure_rest, 0);
  const double slope = 2 * half / leg.height;
  EXPECT_NEAR(result.pressure_rest / slices_of(scene).pressure_rest, 1, 0.1 + slope * slope);
}

INSTANTIATE_TEST_SUITE_P(
    Cases, SlidingExtremes,
    testing::Values(Extreme{"plain"}, Extreme{.name = "hardly_stretched", .stretch = 1.12},
                    Extreme{.name = "thin", .thickness = 1e-6}, Extreme{.name = "thick", .thickness = 10e-3},
                    Extreme{.name = "soft_elastomer", .elastomer = 1e-4},
                    Extreme{.name = "stiff_elastomer", .stretch = 1.15, .elastomer = 30},
                    Extreme{.name = "inverted_taper", .taper = -1},
                    Extreme{.name = "slight_taper", .taper = 1e-6},
                    Extreme{.name = "taper_of_25_degrees", .stretch = 1.8, .taper = 2.17},
                    Extreme{.name = "soft_leg", .young = 20e3}, Extreme{.name = "hard_leg", .young = 80e7}),
    [](const auto& extreme) { return std::string(extreme.param.name); });

// What is nearly rigid is nearly the rigid leg.
TEST(SlidingExtremesAgree, HardLegIsRigid) {
  model::Scene scene = anchored(1.8, 8e3);
  scene.leg.material = model::LegMaterial::neo_hookean;
  scene.leg.young_modulus = 8e11;
  const model::SegmentResult result = solve_sliding({&scene, 0}).result;
  EXPECT_NEAR(result.pressure_rest / result.pressure_rest_rigid, 1, 1e-6);
  EXPECT_NEAR(result.pressure_actuated / result.pressure_actuated_rigid, 1, 1e-6);
}

// Upside down, the segment is the same.
TEST(SlidingSymmetry, TurnedOverNothingChanges) {
  model::Scene scene = anchored(2.0, 9e3);
  const model::SegmentResult up = solve_sliding({&scene, 0}).result;
  std::swap(scene.leg.segments[0].lower_radius, scene.leg.segments[0].upper_radius);
  const model::SegmentResult down = solve_sliding({&scene, 0}).result;
  EXPECT_NEAR(up.pressure_rest, down.pressure_rest, 1e-10 * up.pressure_rest);
  EXPECT_NEAR(up.pressure_actuated, down.pressure_actuated, 1e-10 * up.pressure_actuated);
  EXPECT_NEAR(up.slip_max, down.slip_max, 1e-10 * up.slip_max);
}

}  // namespace
}  // namespace gaiter::solvers
