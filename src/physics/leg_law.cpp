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
  const auto& law = constants.value;
  return leg.material == model::LegMaterial::neo_hookean ? neo_hookean_pressure_bound(law[0], law[1], strain)
                                                         : strain_law_pressure_bound(law[0], law[2], strain);
}

}  // namespace gaiter::physics
