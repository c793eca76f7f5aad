// SPDX-License-Identifier: BSD-2-Clause
#include "gaiter/physics/leg_law.hpp"

#include <cmath>

namespace gaiter::physics {

LegConstants leg_constants(const model::Leg& leg, const model::Segment& segment) {
  if (leg.material == model::LegMaterial::neo_hookean) {
    const double shear = leg.young_modulus / (2 * (1 + leg.poisson_ratio));
    const double bulk = leg.young_modulus / (3 * (1 - 2 * leg.poisson_ratio));
    const double scale = bulk + shear / 3;
    return {scale, {bulk / scale, shear / (3 * scale), 0, 0}};
  }
  const auto& law = segment.compliance;
  const double c = leg.variant == model::ComplianceVariant::anchored ? -law.a : law.c;
  return {1 / law.b, {law.a, c, law.a + c, law.d / law.b}};
}

double pressure_bound(const model::Leg& leg, const LegConstants& constants, double strain) {
  constexpr double rounding = 1 + 1e-9;
  if (leg.material == model::LegMaterial::neo_hookean) {
    const double reached = strain < 0.99 ? strain : 0.99;
    const double bulk = constants.value[0], shear = constants.value[1];
    return reached * (2 - reached) * (bulk + shear * std::pow(1 - reached, -10.0 / 3)) * rounding;
  }
  // a exp(bP) = strain - c exp(dP), where c <= 0 and the second exponential is between 0 and 1.
  const double a = constants.value[0], strain_of_none = constants.value[2];  // a + c
  const double reached = strain < 1 ? strain : 1;
  return reached <= strain_of_none ? 0 : std::log1p((reached - strain_of_none) / a) * rounding;
}

}  // namespace gaiter::physics
