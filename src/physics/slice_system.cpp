// SPDX-License-Identifier: BSD-2-Clause
#include "gaiter/physics/slice_system.hpp"

#include <cmath>
#include <utility>

#include "gaiter/physics/leg_law.hpp"

namespace gaiter::physics {

namespace {

constexpr double vacuum_permittivity = 8.8541878128e-12;  // [F/m]

}  // namespace

Wall reference_wall(const model::Bandage& bandage, const model::Module& module, double mean_radius,
                    double leg_radius) {
  // The reference radius R lies `inward` outside of the inner face A. The gap must keep its digits where the
  // stretch is close to 1, so mean_radius - R is formed from stretch - 1.
  const double inward = bandage.length_at == model::LengthAt::outer    ? bandage.thickness
                        : bandage.length_at == model::LengthAt::middle ? 0.5 * bandage.thickness
                                                                       : 0.0;
  double reference = 0, overstretch = 0;
  if (module.length > 0) {
    reference = module.length / (2 * M_PI);
    overstretch = mean_radius - reference;
  } else {
    reference = mean_radius / module.stretch;
    overstretch = mean_radius * (module.stretch - 1) / module.stretch;
  }
  return {reference - inward, bandage.thickness, (leg_radius - mean_radius) + overstretch + inward};
}

SliceSystem::SliceSystem(SliceShape shape, std::size_t slices) {
  reset(std::move(shape), slices);
}

void SliceSystem::reset(SliceShape shape, std::size_t slices) {
  shape_ = std::move(shape);
  layers_ = shape_.layers;
  slices_ = slices;
  packs_ = (slices + pack_width - 1) / pack_width;
  rows_per_pack_ = static_cast<std::size_t>(shape_.layer_row(layers_));
  rows_.resize(packs_ * rows_per_pack_);
}

// What differs from slice to slice of a segment.
void SliceSystem::set_slice(std::size_t index, const model::Leg& leg, const LegConstants& constants,
                            const Wall& wall, double leg_radius) {
  at(index, SliceShape::gap) = wall.gap / wall.inner_radius;
  at(index, SliceShape::leg_radius) = leg_radius / wall.inner_radius;
  // The bandage is slack at r = A, so no equilibrium lies beyond that strain; without contact any bound will
  // do.
  const double bound = pressure_bound(leg, constants, wall.gap / leg_radius);
  at(index, SliceShape::pressure_limit) = bound > 0 ? bound : 1;
}

void SliceSystem::set(std::size_t index, const model::Leg& leg, const model::Segment& segment,
                      const model::Bandage& bandage, const Wall& wall, double slice_radius, double voltage,
                      const Quadrature* wall_rule) {
  const LegConstants constants = leg_constants(leg, segment);
  set_slice(index, leg, constants, wall, slice_radius);
  set_common(index, 1, constants, bandage, wall, voltage, wall_rule ? *wall_rule : shape_.wall);
  repeat_last(index + 1);
}

void SliceSystem::set_segment(std::size_t first, std::span<const double> heights, const model::Leg& leg,
                              const model::Segment& segment, const model::Bandage& bandage,
                              const model::Module& module, const Quadrature& wall_rule,
                              std::span<double> radii) {
  const LegConstants constants = leg_constants(leg, segment);
  const double mean_radius = segment.mean_radius();
  Wall wall;
  for (std::size_t k = 0; k < heights.size(); ++k) {
    radii[k] = segment.lower_radius + heights[k] * (segment.upper_radius - segment.lower_radius);
    wall = reference_wall(bandage, module, mean_radius, radii[k]);
    set_slice(first + k, leg, constants, wall, radii[k]);
  }
  set_common(first, heights.size(), constants, bandage, wall, module.voltage, wall_rule);
  repeat_last(first + heights.size());
}

// What the slices of a segment have in common, from the leg's law and the wall without its gap.
void SliceSystem::set_common(std::size_t first, std::size_t count, const LegConstants& constants,
                             const model::Bandage& bandage, const Wall& wall, double voltage,
                             const Quadrature& rule) {
  const double inner = wall.inner_radius, scale = constants.pressure_scale;
  const auto fill = [&](int row, double value) {
    for (std::size_t slice = first; slice < first + count; ++slice) at(slice, row) = value;
  };
  const double area = wall.thickness * (2 * inner + wall.thickness) / (inner * inner);  // (B^2 - A^2)/A^2
  const double log_area = std::log1p(area);
  fill(SliceShape::log_wall, log_area);
  for (int k = 0; k < 4; ++k) fill(SliceShape::leg_0 + k, constants.value[k]);
  fill(SliceShape::pressure_scale, scale);
  for (int i = 0; i < shape_.ogden_terms; ++i) {
    fill(shape_.mu_row(i), bandage.ogden[i].mu / scale);
    fill(shape_.alpha_row(i), bandage.ogden[i].alpha);
  }
  for (std::size_t j = 0; j < shape_.wall.nodes.size(); ++j) {
    // Points that this slice does not use lie on the inner face, without weight.
    const bool used = j < rule.nodes.size();
    fill(shape_.wall_row(static_cast<int>(j)), used ? std::exp(-log_area * rule.nodes[j]) : 1);
    fill(shape_.weight_row(static_cast<int>(j)), used ? rule.weights[j] : 0);
  }
  for (int k = 0; k < layers_; ++k) {
    // A slice with fewer layers than the system has the rest of them without voltage.
    const double thickness = wall.thickness / bandage.layers;
    const double layer_inner = inner + (k < bandage.layers ? k * thickness : 0);
    const double field = k < bandage.layers ? voltage / layer_inner : 0;  // [V/m]
    fill(shape_.layer_row(k), (inner / layer_inner) * (inner / layer_inner));
    fill(shape_.layer_row(k) + 1, thickness * (2 * layer_inner + thickness) / (layer_inner * layer_inner));
    fill(shape_.layer_row(k) + 2, 2 * vacuum_permittivity * bandage.permittivity * field * field / scale);
  }
}

// The last pack's spare places repeat the last slice, so that no garbage slows or spoils the pack.
void SliceSystem::repeat_last(std::size_t end) {
  if (end != slices_ || end % pack_width == 0) return;
  const std::size_t last = (end - 1) % pack_width;
  Pack* rows = rows_.data() + (end - 1) / pack_width * rows_per_pack_;
  for (std::size_t row = 0; row < rows_per_pack_; ++row)
    for (std::size_t i = last + 1; i < pack_width; ++i) rows[row][i] = rows[row][last];
}

SliceSystem SliceSystem::replicate(std::size_t index) const {
  SliceShape shape = shape_;
  shape.layers = layers_;
  SliceSystem copy(shape, pack_width);
  copy.shape_.layers = shape_.layers;
  for (std::size_t row = 0; row < rows_per_pack_; ++row)
    for (int i = 0; i < pack_width; ++i) copy.rows_[row][i] = constant(index, static_cast<int>(row));
  return copy;
}

}  // namespace gaiter::physics
