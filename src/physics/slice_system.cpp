// SPDX-License-Identifier: BSD-2-Clause
#include "gaiter/physics/slice_system.hpp"

#include <cmath>

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

SliceSystem::SliceSystem(SliceShape shape, std::size_t slices)
    : shape_(std::move(shape)),
      slices_(slices),
      packs_((slices + pack_width - 1) / pack_width),
      rows_per_pack_(layer(shape_.layers)),
      rows_(packs_ * rows_per_pack_) {}

void SliceSystem::set(std::size_t index, const model::Leg& leg, const model::Segment& segment,
                      const model::Bandage& bandage, const Wall& wall, double slice_radius, double voltage) {
  const double inner = wall.inner_radius;
  const LegConstants constants = leg_constants(leg, segment);
  const double scale = constants.pressure_scale;
  at(index, gap) = wall.gap / inner;
  at(index, leg_radius) = slice_radius / inner;
  const double area = wall.thickness * (2 * inner + wall.thickness) / (inner * inner);  // (B^2 - A^2)/A^2
  const double log_area = std::log1p(area);
  at(index, log_wall) = log_area;
  for (int k = 0; k < 4; ++k) at(index, leg_0 + k) = constants.value[k];
  // The bandage is slack at r = A, so no equilibrium lies beyond that strain; without contact any bound will
  // do.
  const double bound = pressure_bound(leg, constants, wall.gap / slice_radius);
  at(index, pressure_limit) = bound > 0 ? bound : 1;
  at(index, pressure_scale) = scale;
  for (int i = 0; i < shape_.ogden_terms; ++i) {
    at(index, mu(i)) = bandage.ogden[i].mu / scale;
    at(index, alpha(i)) = bandage.ogden[i].alpha;
  }
  for (std::size_t j = 0; j < shape_.wall.nodes.size(); ++j)
    at(index, wall_point(static_cast<int>(j))) = std::exp(-log_area * shape_.wall.nodes[j]);
  for (int k = 0; k < shape_.layers; ++k) {
    const double thickness = wall.thickness / shape_.layers;
    const double layer_inner = inner + k * thickness;
    at(index, layer(k)) = (inner / layer_inner) * (inner / layer_inner);
    at(index, layer(k) + 1) = thickness * (2 * layer_inner + thickness) / (layer_inner * layer_inner);
    at(index, layer(k) + 2) = 2 * vacuum_permittivity * bandage.permittivity * (voltage / layer_inner) *
                              (voltage / layer_inner) / scale;
  }
  // The pack's spare places repeat the last slice, so that no garbage slows or spoils the pack.
  if (index + 1 != slices_) return;
  Pack* rows = rows_.data() + index / pack_width * rows_per_pack_;
  for (std::size_t row = 0; row < rows_per_pack_; ++row)
    for (int i = index % pack_width + 1; i < pack_width; ++i) rows[row][i] = rows[row][index % pack_width];
}

SliceSystem SliceSystem::replicate(std::size_t index) const {
  SliceSystem copy(shape_, pack_width);
  for (std::size_t row = 0; row < rows_per_pack_; ++row)
    for (int i = 0; i < pack_width; ++i) copy.rows_[row][i] = constant(index, static_cast<int>(row));
  return copy;
}

}  // namespace gaiter::physics
