// SPDX-License-Identifier: BSD-2-Clause
#include "gaiter/physics/sliding_system.hpp"

#include <algorithm>
#include <cmath>

namespace gaiter::physics {

SlidingSystem::SlidingSystem(SlidingShape shape, SliceShape slice_shape, std::size_t segments)
    : shape_(shape),
      sections_(std::move(slice_shape), segments),
      rows_(sections_.packs() * row_count),
      inner_radius_(segments) {}

void SlidingSystem::set(std::size_t index, const model::Scene& scene, std::size_t segment,
                        const Quadrature& wall_rule, double overstretch, double drive) {
  const model::Segment& leg = scene.leg.segments[segment];
  const double mean = leg.mean_radius();
  model::Module module = scene.bandage.modules[segment];
  if (overstretch < 1) {
    const double stretch = module.length > 0 ? 2 * M_PI * mean / module.length : module.stretch;
    module.length = 0;
    module.stretch = 1 + overstretch * (stretch - 1);
  }
  const Wall wall = reference_wall(scene.bandage, module, mean, mean);
  sections_.set(index, scene.leg, leg, scene.bandage, wall, mean, std::sqrt(drive) * module.voltage,
                &wall_rule);
  inner_radius_[index] = wall.inner_radius;

  const double gradient = (leg.upper_radius - leg.lower_radius) / leg.height;
  double stiffness = 0;  // of the tube's pressure against the leg's strain, unstretched
  for (const model::OgdenTerm& term : scene.bandage.ogden) stiffness += term.mu * term.alpha;
  stiffness *= sections_.constant(index, SliceShape::log_wall) / pressure_scale(index);

  double values[row_count];
  values[slope] = gradient;
  values[log_slope] = 0.5 * std::log1p(gradient * gradient);
  values[element_height] = leg.height / wall.inner_radius / shape_.elements;
  values[free] = scene.contact_axial == model::ContactAxial::free ? 1 : 0;
  values[lifted_slope] = 1 / std::max(stiffness, 1e-12);
  // The pack's spare places repeat the last segment.
  const std::size_t first = index % pack_width;
  const std::size_t last = index + 1 == segments() ? pack_width - 1 : first;
  for (int row = 0; row < row_count; ++row)
    for (std::size_t place = first; place <= last; ++place)
      rows_[index / pack_width * row_count + row][static_cast<int>(place)] = values[row];
}

}  // namespace gaiter::physics
