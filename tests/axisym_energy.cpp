// SPDX-License-Identifier: BSD-2-Clause
// The potentials of the axisymmetric model: jets against differences of their own values, and against closed
// forms.
#include "gaiter/physics/axisym_energy.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "gaiter/physics/axisym_element.hpp"
#include "gaiter/physics/contact.hpp"
#include "paper_scene.hpp"

namespace {

using namespace gaiter::physics;
namespace model = gaiter::model;

// First and second derivatives of `potential(variables)` in a random direction, from the jet and from central
// differences of its values and slopes; the step suits values of order one.
template <int N, typename Potential>
void expect_consistent(const Potential& potential, const std::array<double, N>& at, std::mt19937& generator) {
  std::array<double, N> direction;
  for (double& d : direction) d = std::uniform_real_distribution(-1.0, 1.0)(generator);
  const auto slope = [&](const Jet<N>& jet) {
    double sum = 0;
    for (int i = 0; i < N; ++i) sum += jet.gradient[i] * direction[i];
    return sum;
  };
  const auto moved = [&](double step) {
    std::array<double, N> x = at;
    for (int i = 0; i < N; ++i) x[i] += step * direction[i];
    return potential(x);
  };
  const Jet<N> jet = moved(0);
  double curvature = 0;
  for (int i = 0; i < N; ++i)
    for (int j = 0; j < N; ++j) curvature += jet.second(i, j) * direction[i] * direction[j];
  ASSERT_NE(slope(jet), 0);
  ASSERT_NE(curvature, 0);
  // The differences' errors fall with the square of the step.
  double error[2], second_error[2];
  for (int k = 0; k < 2; ++k) {
    const double step = k == 0 ? 2e-3 : 1e-3;
    const Jet<N> up = moved(step), down = moved(-step);
    error[k] = std::fabs((up.value - down.value) / (2 * step) - slope(jet));
    second_error[k] = std::fabs((slope(up) - slope(down)) / (2 * step) - curvature);
  }
  const double size = std::fabs(jet.value) + std::fabs(slope(jet)), second_size = std::fabs(curvature) + size;
  EXPECT_LT(error[1], 0.3 * error[0] + 1e-9 * size);
  EXPECT_LT(second_error[1], 0.3 * second_error[0] + 1e-9 * second_size);
  EXPECT_LT(error[1], 1e-2 * size);
  EXPECT_LT(second_error[1], 1e-1 * second_size);
}

template <int N>
Deformation<N> jets_of(const std::array<double, N>& x) {
  return {Jet<N>::variable(x[0], 0), Jet<N>::variable(x[1], 1), Jet<N>::variable(x[2], 2),
          Jet<N>::variable(x[3], 3), Jet<N>::variable(x[4], 4)};
}

TEST(AxisymEnergy, TubesDerivativesAreThoseOfItsValue) {
  std::mt19937 generator(1);
  std::uniform_real_distribution small(-0.1, 0.1);
  TubeMaterial material{{{0.57, 3.507}, {0.02, 6.0}, {-0.1, -2.5}}, 0, 1.3, 0.2};
  for (double bulk : {std::numeric_limits<double>::infinity(), 50.0})
    for (int k = 0; k < 40; ++k) {
      material.bulk_modulus = bulk;
      const double hoop = 1.1 + 0.1 * k / 4;
      // Every fourth state has equal stretches in the plane.
      const double twist = k % 4 == 0 ? 0 : small(generator);
      const double across = k % 4 == 0 ? 1 / std::sqrt(hoop) : 1 / hoop;
      const double along = k % 4 == 0 ? across : 1 + small(generator);
      expect_consistent<6>(
          [&](const std::array<double, 6>& x) {
            return tube_energy(material, jets_of<6>(x), Jet<6>::variable(x[5], 5)) +
                   closed_form_electric_energy(material.permittivity, jets_of<6>(x), 0.9, 0.88, 0.93);
          },
          {across, twist, -twist, along, hoop, small(generator) + 1}, generator);
    }
}

// A wall on its way to a cone: turned, stretched along, and bulged.
std::array<double, 5> some_wall(std::mt19937& generator) {
  std::uniform_real_distribution small(-0.1, 0.1);
  const double hoop = 1.6 + 5 * small(generator), along = 1 + small(generator);
  return {1 / (hoop * along), small(generator), small(generator), along, hoop};
}

TEST(AxisymEnergy, FieldsDerivativesAreThoseOfItsValue) {
  std::mt19937 generator(4);
  std::uniform_real_distribution gradient(-30.0, 30.0);
  constexpr double permittivity = 2e-3;
  for (int k = 0; k < 40; ++k) {
    const auto f = some_wall(generator);
    expect_consistent<8>(
        [&](const std::array<double, 8>& x) {
          return electric_energy(permittivity, jets_of<8>(x), Jet<8>::variable(x[6], 6),
                                 Jet<8>::variable(x[7], 7));
        },
        {f[0], f[1], f[2], f[3], f[4], 1, gradient(generator), gradient(generator)}, generator);
    for (double R : {0.881, 0.9, 0.929})
      expect_consistent<6>(
          [&](const std::array<double, 6>& x) {
            return closed_form_electric_energy(permittivity, jets_of<6>(x), R, 0.88, 0.93);
          },
          {f[0], f[1], f[2], f[3], f[4], 1}, generator);
  }
}

TEST(AxisymEnergy, FieldsIsThatOfTheDeformedBody) {
  std::mt19937 generator(5);
  for (int k = 0; k < 20; ++k) {
    const auto [rR, rZ, zR, zZ, t] = some_wall(generator);
    const double phi_R = 3 + k, phi_Z = 7 - k, in_plane = rR * zZ - rZ * zR;
    // E = F^{-T} grad phi by Cramer's rule.
    const double r = (zZ * phi_R - zR * phi_Z) / in_plane, z = (rR * phi_Z - rZ * phi_R) / in_plane;
    const auto energy = electric_energy(0.3, jets_of<8>({rR, rZ, zR, zZ, t}), Jet<8>::variable(phi_R, 6),
                                        Jet<8>::variable(phi_Z, 7));
    EXPECT_NEAR(energy.value, -0.15 * in_plane * t * (r * r + z * z), 1e-12 * std::fabs(energy.value));
  }
}

// A cylinder that keeps its volume, stretched along as well: phi = ln(r/a) / ln(b/a).
TEST(AxisymEnergy, ClosedFormIsThatOfTheCylindersPotential) {
  constexpr double A = 0.88, B = 0.93;
  for (double l : {0.9, 1.0, 1.2})
    for (double a : {1.0, 1.5, 2.0})
      for (double R : {A, 0.9, B}) {
        const auto deformed = [&](double at) { return std::sqrt(a * a + (at * at - A * A) / l); };
        const double r = deformed(R), rR = R / (l * r);
        const std::array<double, 8> x{rR, 0, 0, l, r / R};
        const auto closed = closed_form_electric_energy(0.3, jets_of<6>({rR, 0, 0, l, r / R}), R, A, B);
        const auto exact =
            electric_energy(0.3, jets_of<8>(x), Jet<8>::variable(rR / (r * std::log(deformed(B) / a)), 6),
                            Jet<8>::variable(0, 7));
        EXPECT_NEAR(closed.value, exact.value, 1e-12 * std::fabs(exact.value));
      }
}

TEST(AxisymEnergy, LegsDerivativesAreThoseOfItsValue) {
  std::mt19937 generator(2);
  std::uniform_real_distribution small(-0.02, 0.02);
  model::Leg leg = gaiter::paper::scene(2.2).leg;
  for (auto material : {model::LegMaterial::compliance, model::LegMaterial::neo_hookean})
    for (auto variant : {model::ComplianceVariant::published, model::ComplianceVariant::anchored})
      for (int k = 0; k < 20; ++k) {
        leg.material = material;
        leg.variant = variant;
        LegMaterialLaw law = leg_material(leg, leg.segments[k % 6]);
        // Stresses over 10 kPa: values of order one.
        law.shear_modulus /= 1e4;
        law.bulk_modulus /= 1e4;
        law.b *= 1e4;
        law.d *= 1e4;
        const double s = 0.9 + 0.004 * k;
        expect_consistent<5>([&](const std::array<double, 5>& x) { return leg_energy(law, jets_of<5>(x)); },
                             {s, small(generator), small(generator), 1 + small(generator), s}, generator);
      }
}

TEST(AxisymEnergy, UniformCompressionGivesTheStrainLaw) {
  model::Leg leg = gaiter::paper::scene(2.2).leg;
  for (auto variant : {model::ComplianceVariant::published, model::ComplianceVariant::anchored})
    for (const auto& segment : leg.segments)
      for (double pressure : {1.0, 100.0, 3800.0, 9000.0, 40000.0}) {
        leg.variant = variant;
        const LegMaterialLaw law = leg_material(leg, segment);
        const double c = variant == model::ComplianceVariant::anchored ? -law.a : segment.compliance.c;
        const double strain = law.a * std::exp(law.b * pressure) + c * std::exp(law.d * pressure);
        EXPECT_NEAR(pressure_of_strain(law, strain).pressure, pressure, 1e-9 * (pressure + 100));
        const double s = 1 - strain;
        const Jet<5> energy = leg_energy(law, jets_of<5>({s, 0, 0, 1, s}));
        // Cauchy stress: (1/J) s dW/ds of either direction, J = s^2.
        EXPECT_NEAR(-energy.gradient[0] / s, pressure, 1e-9 * (pressure + leg.shear_modulus));
        EXPECT_NEAR(-energy.gradient[4] / s, pressure, 1e-9 * (pressure + leg.shear_modulus));
      }
}

TEST(AxisymContact, PotentialsDerivativesAreThoseOfItsValue) {
  std::mt19937 generator(3);
  std::uniform_real_distribution small(-0.03, 0.03);
  constexpr int P = 2, N = 14;
  const auto check = [&](const ContactSegment& segment, bool on_tube) {
    std::array<double, N> at{};
    const std::array<double, 3> tube_r{1, 1.02, 1.05}, tube_z{0, 0.5, 1}, leg_r{1, 1.01, 1.03},
        leg_z{0.3, 0.7, 1.2};
    for (int i = 0; i < 3; ++i) {
      at[i] = tube_r[i] + small(generator);
      at[3 + i] = tube_z[i] + small(generator);
      at[6 + i] = leg_r[i] + small(generator);
      at[9 + i] = leg_z[i] + small(generator);
    }
    at[12] = 1.5;
    at[13] = 0.7;
    expect_consistent<N>(
        [&](const std::array<double, N>& x) {
          ContactEdge<P> tube, leg;
          for (int i = 0; i < 3; ++i) {
            tube.r[i] = x[i];
            tube.z[i] = x[3 + i];
            leg.r[i] = x[6 + i];
            leg.z[i] = x[9 + i];
          }
          return contact_potential<P>(tube, leg, {x[12], x[13]}, on_tube, segment);
        },
        at, generator);
  };
  for (int k = 0; k < 10; ++k)
    for (bool on_tube : {true, false}) check({0, 0, SegmentEnd::leg_lower, SegmentEnd::tube_upper}, on_tube);
}

TEST(AxisymContact, GapVolumeOfTwoConesIsExact) {
  // Tube r = 2 + z/10 and leg r = 1 + z/5 on 0.25 < z < 1, multipliers 1 on the tube: - int pi (R^2 - r^2)
  // dz.
  ContactEdge<2> tube{{2, 2.05, 2.1}, {0, 0.5, 1}}, leg{{1.05, 1.15, 1.25}, {0.25, 0.75, 1.25}};
  const auto potential =
      contact_potential<2>(tube, leg, {1, 1}, true, {0, 0, SegmentEnd::leg_lower, SegmentEnd::tube_upper});
  const auto integral = [](double z) {
    return 4 * z + 0.2 * z * z + z * z * z / 300 - (z + 0.2 * z * z + z * z * z / 75);
  };
  EXPECT_NEAR(potential.value, -M_PI * (integral(1) - integral(0.25)), 1e-13);
}

TEST(AxisymContact, SurfacesArePairedWithoutGapsOrOverlaps) {
  const std::vector<double> tube{0, 0.2, 0.5, 1}, leg{0, 0.2, 0.3, 0.9, 1};
  double covered = 0;
  for (const ContactSegment& s : pair_surfaces(tube, leg)) {
    const double low = s.lower == SegmentEnd::tube_lower ? tube[s.tube_edge] : leg[s.leg_edge];
    const double high = s.upper == SegmentEnd::tube_upper ? tube[s.tube_edge + 1] : leg[s.leg_edge + 1];
    EXPECT_GT(high, low);
    EXPECT_DOUBLE_EQ(low, covered);
    covered = high;
  }
  EXPECT_DOUBLE_EQ(covered, 1);
  EXPECT_TRUE(pair_surfaces(std::vector{0.0, 0.5, 0.4}, leg).empty());
}

}  // namespace
