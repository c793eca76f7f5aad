// SPDX-License-Identifier: BSD-2-Clause
#include "gaiter/studies/axisym_checks.hpp"

#include <fmt/format.h>

#include <cmath>

#include "gaiter/base/error.hpp"

namespace gaiter::studies {

namespace {

using base::InputError;

constexpr double widest_step = 0.01;  // between the radii of neighbouring segments, over the radius

}  // namespace

void check_axisym(const model::Scene& scene) {
  if (scene.leg.model == model::LegModel::rigid)
    throw InputError(
        "-leg_model 'rigid': -fidelity axisym needs a leg that gives way, e.g. a stiff neo_hookean one");
  double twice_modulus = 0;
  for (const model::OgdenTerm& term : scene.bandage.ogden) twice_modulus += term.mu * term.alpha;
  if (scene.bandage.bulk_modulus <= twice_modulus)
    throw InputError(
        fmt::format("-bandage_bulk_modulus '{} Pa': must be greater than {:.6g} Pa, twice the shear modulus",
                    scene.bandage.bulk_modulus, twice_modulus));
  if (scene.axisym.scope != model::AxisymScope::leg) return;
  const auto& segments = scene.leg.segments;
  for (std::size_t i = 0; i + 1 < segments.size(); ++i) {
    const double below = segments[i].upper_radius, above = segments[i + 1].lower_radius;
    if (std::fabs(above - below) > widest_step * std::fmin(below, above))
      throw InputError(
          fmt::format("-leg_{}_radius '{} m, {} m': with -axisym_scope leg it must begin within {:.0f} % of "
                      "{} m, where {} "
                      "ends; smaller steps are smoothed",
                      segments[i + 1].name, above, segments[i + 1].upper_radius, 100 * widest_step, below,
                      segments[i].name));
  }
}

}  // namespace gaiter::studies
