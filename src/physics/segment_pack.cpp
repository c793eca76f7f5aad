// SPDX-License-Identifier: BSD-2-Clause
#include "gaiter/physics/segment_pack.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "gaiter/physics/leg_law.hpp"
#include "gaiter/physics/slice_system.hpp"

namespace gaiter::physics {

namespace {

constexpr std::size_t rows = sizeof(SegmentNumbers) / sizeof(double);
static_assert(sizeof(SegmentConstants<Pack>) == rows * sizeof(Pack));

// A passive bandage of these terms presses harder the further it is stretched, so that there is one
// equilibrium.
bool has_only_stiffening_terms(const model::Bandage& bandage) {
  return std::all_of(bandage.ogden.begin(), bandage.ogden.end(), [](const model::OgdenTerm& term) {
    return term.mu * term.alpha >= 0 && std::fabs(term.alpha) >= 2;
  });
}

}  // namespace

SegmentNumbers segment_numbers(const model::Scene& scene, std::size_t segment) {
  const model::Segment& leg = scene.leg.segments[segment];
  const model::Bandage& bandage = scene.bandage;
  const model::Module& module = bandage.modules[segment];
  const double mean_radius = leg.mean_radius();
  const LegConstants law = leg_constants(scene.leg, leg);
  const Wall wall = reference_wall(bandage, module, mean_radius, mean_radius);

  SegmentNumbers numbers;
  numbers.height = leg.height;
  numbers.lower_radius = leg.lower_radius;
  numbers.upper_radius = leg.upper_radius;
  numbers.data_limit = scene.leg.material == model::LegMaterial::compliance
                           ? scene.leg.data_limit
                           : std::numeric_limits<double>::infinity();
  numbers.pressure_scale = law.pressure_scale;
  std::copy(law.value.begin(), law.value.end(), numbers.leg_law);
  numbers.gives_way = scene.leg.model == model::LegModel::rigid ? 0 : 1;
  numbers.shear_modulus = scene.leg.material == model::LegMaterial::compliance
                              ? scene.leg.shear_modulus
                              : 3 * law.value[1] * law.pressure_scale;
  numbers.slides = scene.contact_axial == model::ContactAxial::free ? 1 : 0;
  numbers.reference_radius = module.length > 0 ? module.length / (2 * M_PI) : mean_radius / module.stretch;
  numbers.inner_radius = wall.inner_radius;
  numbers.thickness = wall.thickness;
  numbers.gap = wall.gap;
  numbers.steepest = 0;
  for (const auto& term : bandage.ogden) numbers.steepest = std::max(numbers.steepest, std::fabs(term.alpha));
  numbers.voltage = module.voltage;
  numbers.permittivity = bandage.permittivity;
  numbers.layers = bandage.layers;
  numbers.stiffens = has_only_stiffening_terms(bandage) ? 1 : 0;
  numbers.wall_points = scene.discretisation.wall_points;
  numbers.wall_error = numbers.passive_wall_error = 0;
  return numbers;
}

void SegmentPack::set(int place, const SegmentNumbers& numbers, const model::Bandage& bandage,
                      const Quadrature& wall_rule) {
  const double* from = reinterpret_cast<const double*>(&numbers);
  Pack* to = reinterpret_cast<Pack*>(&constants);
  for (std::size_t row = 0; row < rows; ++row) to[row][place] = from[row];
  bandages[place] = &bandage;
  wall_rules[place] = &wall_rule;
}

void SegmentPack::close(int used) {
  count = used;
  Pack* row = reinterpret_cast<Pack*>(&constants);
  for (int i = used; i < pack_width; ++i) {
    for (std::size_t k = 0; k < rows; ++k) row[k][i] = row[k][used - 1];
    bandages[i] = bandages[used - 1];
    wall_rules[i] = wall_rules[used - 1];
  }
}

}  // namespace gaiter::physics
