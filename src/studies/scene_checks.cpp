// SPDX-License-Identifier: BSD-2-Clause
#include "gaiter/studies/scene_checks.hpp"

#include <fmt/format.h>

#include <numbers>

#include "gaiter/base/error.hpp"
#include "gaiter/studies/axisym_checks.hpp"
#include "gaiter/studies/option_values.hpp"
#include "gaiter/studies/solve.hpp"

namespace gaiter::studies {

using base::InputError;

std::string put_design(const Designs& designs, std::int64_t design, model::Scene& scene) {
  std::vector<double> values(designs.axes().size());
  designs.values(design, values);
  return put_design(designs, values, scene);
}

std::string put_design(const Designs& designs, std::span<const double> values, model::Scene& scene) {
  const int refused = designs.apply(values, scene);
  if (refused >= 0) {
    const auto place = static_cast<std::size_t>(refused);
    const SweepAxis& axis = designs.axes()[place];
    return fmt::format("-{} '{}': must be {}", axis.name,
                       format_number(*axis.option, values[place], axis.component),
                       allowed(*axis.option, axis.component));
  }
  try {
    check_scene(scene);
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

namespace {

void check_stretch(const model::Segment& segment, const model::Module& module) {
  if (!(module.length > 0)) return;  // an option of its own
  static const Option &stretch = option("bandage_stretch"), &length = option("bandage_<s>_length");
  const double found = 2 * std::numbers::pi * segment.mean_radius() / module.length;
  const Range& range = stretch.component(0).range;
  if (found < range.low || found > range.high)
    throw InputError(fmt::format("-{} '{} m': stretches the module by {:.6g}, which must be {}",
                                 name_for(length, segment.name), module.length, found, allowed(stretch, 0)));
}

}  // namespace

void check_scene(const model::Scene& scene) {
  const model::Bandage& bandage = scene.bandage;
  for (std::size_t i = 0; i < bandage.modules.size(); ++i) {
    const model::Module& module = bandage.modules[i];
    const model::Segment& segment = scene.leg.segments[i];
    const double radius =
        module.length > 0 ? module.length / (2 * std::numbers::pi) : segment.mean_radius() / module.stretch;
    check_stretch(segment, module);
    // The hole's radius: the reference radius less the part of the wall inside it.
    const double inside = bandage.length_at == model::LengthAt::outer    ? bandage.thickness
                          : bandage.length_at == model::LengthAt::middle ? 0.5 * bandage.thickness
                                                                         : 0;
    if (inside >= radius) {
      const std::string size = module.length > 0 ? fmt::format("length {} m", module.length)
                                                 : fmt::format("stretch {}", module.stretch);
      throw InputError(
          fmt::format("-bandage_thickness '{} m': the module on {} ({}) has a reference radius of {:.6g} m, "
                      "so the wall must be less than {:.6g} m",
                      bandage.thickness, segment.name, size, radius, radius * bandage.thickness / inside));
    }
    const model::Compliance& law = segment.compliance;
    const bool swells = scene.leg.variant == model::ComplianceVariant::published;
    if (swells && law.a + law.c >= 1) {
      throw InputError(
          fmt::format("-leg_{}_compliance '{}, {} Pa-1, {}, {} Pa-1' (after -leg_compliance_scale '{}'): a + "
                      "c, the strain "
                      "at no pressure, must be less than 1",
                      segment.name, law.a, law.b, law.c, law.d, scene.leg.compliance_scale));
    }
    if (law.a + law.c <= -1) {
      throw InputError(
          fmt::format("-leg_{}_compliance '{}, {} Pa-1, {}, {} Pa-1': a + c must be greater than -1",
                      segment.name, law.a, law.b, law.c, law.d));
    }
  }
  double twice_modulus = 0;
  for (const model::OgdenTerm& term : bandage.ogden) twice_modulus += term.mu * term.alpha;
  if (!(twice_modulus > 0)) {
    std::vector<double> mu, alpha;
    for (const model::OgdenTerm& term : bandage.ogden) {
      mu.push_back(term.mu);
      alpha.push_back(term.alpha);
    }
    throw InputError(
        fmt::format("-bandage_ogden_mu '{}' with -bandage_ogden_alpha '{}': the initial shear modulus, half "
                    "the sum of mu alpha, is {:.6g} Pa; it must be greater than 0 Pa",
                    format_values(option("bandage_ogden_mu"), mu),
                    format_values(option("bandage_ogden_alpha"), alpha), 0.5 * twice_modulus));
  }
  if (may_take_axisym(scene)) check_axisym(scene);
}

}  // namespace gaiter::studies
