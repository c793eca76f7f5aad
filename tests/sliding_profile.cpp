// SPDX-License-Identifier: BSD-2-Clause
// Equilibria of sliding slices against the tube's energy computed here, from the profiles alone: the pressure
// at each slice is that of the tube's radius, dw/dr = P r dz/dZ; the leg's radius is that of its law; and,
// because the energy does not depend on Z itself, w - (dz/dZ) dw/d(dz/dZ) is the same all along the segment,
// whatever the leg.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "gaiter/petsc/session.hpp"
#include "gaiter/physics/quadrature.hpp"
#include "gaiter/solvers/sliding_model.hpp"
#include "paper_scene.hpp"

namespace gaiter::solvers {
namespace {

// w(r, zeta) over 2 pi [N], from the definition.
double tube_energy(const model::Scene& scene, double voltage, double r, double zeta) {
  const model::Segment& leg = scene.leg.segments[0];
  const double outer = leg.mean_radius() / scene.bandage.modules[0].stretch;
  const double inner = outer - scene.bandage.thickness;
  const double slope = (leg.upper_radius - leg.lower_radius) / leg.height;
  const double meridian = zeta * std::hypot(1, slope), narrow = zeta / (meridian * meridian);
  static const physics::Quadrature rule = physics::gauss_legendre(24);
  double energy = 0;
  for (std::size_t k = 0; k < rule.nodes.size(); ++k) {
    const double s = inner * inner + rule.nodes[k] * (outer * outer - inner * inner);
    const double hoop = std::sqrt((r * r + narrow * (s - inner * inner)) / s), radial = 1 / (hoop * meridian);
    for (const model::OgdenTerm& term : scene.bandage.ogden)
      energy +=
          0.5 * rule.weights[k] * (outer * outer - inner * inner) * term.mu / term.alpha *
          (std::pow(hoop, term.alpha) + std::pow(meridian, term.alpha) + std::pow(radial, term.alpha) - 3);
  }
  const int layers = scene.bandage.layers;
  for (int k = 0; voltage != 0 && k < layers; ++k) {
    const auto face = [&](int number) {
      const double radius = inner + number * scene.bandage.thickness / layers;
      return std::sqrt(r * r + narrow * (radius * radius - inner * inner));
    };
    const double capacity =
        8.8541878128e-12 * scene.bandage.permittivity * zeta / std::log(face(k + 1) / face(k));
    energy -= 0.5 * capacity * voltage * voltage;
  }
  return energy;
}

void check(const model::Scene& scene, const SlidingProfile& profile, double voltage) {
  // Where the bandage lifts off, the profile has a kink inside an element.
  const double accuracy = profile.pressure.front() == 0 ? 1e-3 : 2e-5;
  const double height = scene.leg.segments[0].height;
  const auto energy = [&](double r, double zeta) { return tube_energy(scene, voltage, r, zeta); };
  double least = 1e300, most = -1e300;
  for (std::size_t k = 0; k < profile.height.size(); ++k) {
    const double r = profile.tube_radius[k], zeta = profile.axial_stretch[k], h = 1e-4;
    const double by_r = (energy(r * (1 + h), zeta) - energy(r * (1 - h), zeta)) / (2 * h * r);
    const double by_zeta = (energy(r, zeta * (1 + h)) - energy(r, zeta * (1 - h))) / (2 * h);
    EXPECT_NEAR(by_r / (r * zeta), profile.pressure[k], 1e-6 * profile.pressure[k] + 1e-3) << "slice " << k;
    least = std::min(least, energy(r, zeta) - by_zeta);
    most = std::max(most, energy(r, zeta) - by_zeta);
    EXPECT_GT(profile.height[k], 0);
    EXPECT_LT(profile.height[k], height);
    EXPECT_GT(profile.height[k], k > 0 ? profile.height[k - 1] : 0);
  }
  // Not slid, this quantity would differ by the tube's energies at the two radii.
  const double lower = scene.leg.segments[0].lower_radius, upper = scene.leg.segments[0].upper_radius;
  EXPECT_LT(most - least, accuracy * std::fabs(energy(upper, 1) - energy(lower, 1)));
}

struct Case {
  const char* name;
  double stretch, voltage;
  model::LegMaterial material = model::LegMaterial::compliance;
  model::ComplianceVariant variant = model::ComplianceVariant::anchored;
  model::LegModel leg = model::LegModel::compliant;
  int layers = 1;
  std::vector<model::OgdenTerm> ogden = {{21.193e3, 3.507}, {10.514, 12.147}};
};

void PrintTo(const Case& c, std::ostream* out) {
  *out << c.name;
}

class SlidingProfiles : public testing::TestWithParam<Case> {};

TEST_P(SlidingProfiles, AreInEquilibrium) {
  model::Scene scene = paper::scene(GetParam().stretch, GetParam().voltage);
  scene.leg.material = GetParam().material;
  scene.leg.variant = GetParam().variant;
  scene.leg.model = GetParam().leg;
  scene.bandage.layers = GetParam().layers;
  scene.bandage.ogden = GetParam().ogden;
  scene.discretisation.sliding_count = 96;
  const SlidingSolution solution = solve_sliding({&scene, 0});
  ASSERT_TRUE(model::trustworthy(solution.result.status));
  EXPECT_GT(solution.result.slip_max, 1e-5);
  check(scene, solution.rest, 0);
  check(scene, solution.actuated, GetParam().voltage);

  const model::Segment& leg = scene.leg.segments[0];
  for (const SlidingProfile* profile : {&solution.rest, &solution.actuated})
    for (std::size_t k = 0; k < profile->height.size(); ++k) {
      const double before =
          leg.lower_radius + profile->height[k] / leg.height * (leg.upper_radius - leg.lower_radius);
      const double p = profile->pressure[k], ratio = profile->leg_radius[k] / before;
      if (p > 0) {
        EXPECT_NEAR(profile->leg_radius[k], profile->tube_radius[k], 1e-12);
      } else {
        EXPECT_GT(profile->tube_radius[k], profile->leg_radius[k]);
      }
      if (scene.leg.model == model::LegModel::rigid) {
        EXPECT_NEAR(ratio, 1, 1e-13);
      } else if (scene.leg.material == model::LegMaterial::neo_hookean) {
        const double y = ratio * ratio, shear = 80e3 / 2.8, bulk = 80e3 / 0.6;
        EXPECT_NEAR(p, (1 - y) * (bulk + shear / 3 * std::pow(y, -5.0 / 3)), 1e-8 * p);
      } else {
        const model::Compliance& law = leg.compliance;
        const double c = scene.leg.variant == model::ComplianceVariant::anchored ? -law.a : law.c;
        EXPECT_NEAR(1 - ratio, law.a * std::exp(law.b * p) + c * std::exp(law.d * p), 1e-12);
      }
    }
}

INSTANTIATE_TEST_SUITE_P(
    Cases, SlidingProfiles,
    testing::Values(
        Case{"stretch_1_4", 1.4, 11.3e3}, Case{"stretch_1_8", 1.8, 11.3e3}, Case{"stretch_2_2", 2.2, 11.3e3},
        Case{.name = "published",
             .stretch = 2.0,
             .voltage = 8e3,
             .variant = model::ComplianceVariant::published},
        Case{.name = "neo_hookean_leg",
             .stretch = 1.6,
             .voltage = 5e3,
             .material = model::LegMaterial::neo_hookean,
             .layers = 2},
        Case{.name = "rigid_leg", .stretch = 2.0, .voltage = 9e3, .leg = model::LegModel::rigid},
        Case{.name = "lifted_in_part", .stretch = 1.05, .voltage = 11.3e3},
        Case{.name = "stiff", .stretch = 1.1, .voltage = 0, .ogden = {{1e6, 2}, {-1e5, -2.5}, {1e4, 5}}}),
    [](const auto& c) { return std::string(c.param.name); });

// Held, nothing slides, and on a leg that does not give way the pressure follows from the radius alone.
TEST(SlidingHeld, PressesAsTheTubeOnItsSlope) {
  model::Scene scene = paper::scene(1.6, 9e3);
  scene.contact_axial = model::ContactAxial::held;
  scene.leg.model = model::LegModel::rigid;
  const SlidingSolution solution = solve_sliding({&scene, 0});
  EXPECT_EQ(solution.result.status, model::Status::contact);
  EXPECT_EQ(solution.result.slip_max, 0);
  for (std::size_t k = 0; k < solution.rest.height.size(); ++k) {
    const double r = solution.rest.tube_radius[k], h = 1e-4 * r;
    EXPECT_NEAR(solution.rest.height[k], solution.rest.reference_height[k], 1e-15);
    for (double voltage : {0.0, 9e3}) {
      const double slope =
          (tube_energy(scene, voltage, r + h, 1) - tube_energy(scene, voltage, r - h, 1)) / (2 * h);
      EXPECT_NEAR((voltage > 0 ? solution.actuated : solution.rest).pressure[k], slope / r, 1e-6 * slope / r);
    }
  }
  // The slope is the only difference to the slices.
  const SegmentTask task{&scene, 0};
  const auto slices = solve_segments(PETSC_COMM_SELF, std::span(&task, 1));
  EXPECT_NEAR(solution.result.pressure_rest / slices[0].pressure_rest, 1, 0.02);
  EXPECT_GT(solution.result.pressure_rest, slices[0].pressure_rest);
}

}  // namespace
}  // namespace gaiter::solvers
