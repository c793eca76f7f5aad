// SPDX-License-Identifier: BSD-2-Clause
#include "gaiter/physics/slice_system.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "gaiter/physics/leg_law.hpp"

namespace gaiter::physics {

namespace {

constexpr double vacuum_permittivity = 8.8541878128e-12;  // [F/m]

// The places of a pack, and one of them by itself.
struct Places {
  int from = 0, to = pack_width;
};

#define GAITER_EACH for (int i = places.from; i < places.to; ++i)

// What the slices of a segment have in common.
GAITER_MULTIVERSION
void set_wall(const SliceShape& shape, int layers, const SegmentConstants<Pack>& segments, Places places,
              Pack* rows) {
  const Pack &inner = segments.inner_radius, &thickness = segments.thickness,
             &scale = segments.pressure_scale;
  Pack& log_wall = rows[SliceShape::log_wall];
  GAITER_EACH {
    rows[SliceShape::pressure_scale][i] = scale[i];
    const double area = thickness[i] * (2 * inner[i] + thickness[i]) / (inner[i] * inner[i]);
    log_wall[i] = log1p(area);  // of (B^2 - A^2)/A^2
  }
  for (int k = 0; k < 4; ++k) GAITER_EACH rows[SliceShape::leg_0 + k][i] = segments.leg_law[k][i];
  for (std::size_t j = 0; j < shape.wall.nodes.size(); ++j) {
    Pack& wall = rows[shape.wall_row(static_cast<int>(j))];  // holds the node
    GAITER_EACH wall[i] = exp(-log_wall[i] * wall[i]);
  }
  for (int k = 0; k < layers; ++k) {
    Pack* layer = rows + shape.layer_row(k);
    GAITER_EACH {
      // A slice with fewer layers than the system has the rest of them without voltage.
      const bool used = k < segments.layers[i];
      const double thin = thickness[i] / segments.layers[i];
      const double layer_inner = inner[i] + (used ? k * thin : 0);
      const double field = used ? segments.voltage[i] / layer_inner : 0;  // [V/m]
      layer[0][i] = (inner[i] / layer_inner) * (inner[i] / layer_inner);
      layer[1][i] = thin * (2 * layer_inner + thin) / (layer_inner * layer_inner);
      layer[2][i] = 2 * vacuum_permittivity * segments.permittivity[i] * field * field / scale[i];
    }
  }
}

// What differs from slice to slice of a segment: its undeformed leg radius, and its gap over A in `rows`.
GAITER_MULTIVERSION
void set_radius(const SliceShape& shape, const Pack& inner, const Pack& radius, Places places, Pack* rows) {
  Pack strain, bound;
  GAITER_EACH {
    strain[i] = rows[SliceShape::gap][i] * inner[i] / radius[i];
    rows[SliceShape::leg_radius][i] = radius[i] / inner[i];
  }
  // The bandage is slack at r = A, so no equilibrium lies beyond that strain; without contact any bound will
  // do.
  const Pack* law = rows + SliceShape::leg_0;
  if (shape.material == model::LegMaterial::neo_hookean)
    GAITER_EACH bound[i] = neo_hookean_pressure_bound(law[0][i], law[1][i], strain[i]);
  else
    GAITER_EACH bound[i] = strain_law_pressure_bound(law[0][i], law[2][i], strain[i]);
  GAITER_EACH rows[SliceShape::pressure_limit][i] = bound[i] > 0 ? bound[i] : 1;
}

#undef GAITER_EACH

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

// A slice's own points, as nodes, which become places in the wall; those that it does not use lie on the
// inner face, without weight.
void SliceSystem::set_wall_points(Pack* rows, int place, const Quadrature& rule) const {
  for (std::size_t j = 0; j < shape_.wall.nodes.size(); ++j) {
    const bool used = j < rule.nodes.size();
    rows[shape_.wall_row(static_cast<int>(j))][place] = used ? rule.nodes[j] : 0;
    rows[shape_.weight_row(static_cast<int>(j))][place] = used ? rule.weights[j] : 0;
  }
}

void SliceSystem::set(std::size_t index, const model::Leg& leg, const model::Segment& segment,
                      const model::Bandage& bandage, const Wall& wall, double slice_radius, double voltage,
                      const Quadrature* wall_rule) {
  const LegConstants law = leg_constants(leg, segment);
  const int place = static_cast<int>(index % pack_width);
  Pack* rows = rows_.data() + index / pack_width * rows_per_pack_;
  SegmentConstants<Pack> constants;
  Pack radius;
  constants.pressure_scale[place] = law.pressure_scale;
  for (int k = 0; k < 4; ++k) constants.leg_law[k][place] = law.value[k];
  constants.inner_radius[place] = wall.inner_radius;
  constants.thickness[place] = wall.thickness;
  constants.voltage[place] = voltage;
  constants.permittivity[place] = bandage.permittivity;
  constants.layers[place] = bandage.layers;
  for (int i = 0; i < shape_.ogden_terms; ++i) {
    rows[shape_.mu_row(i)][place] = bandage.ogden[i].mu / law.pressure_scale;
    rows[shape_.alpha_row(i)][place] = bandage.ogden[i].alpha;
  }
  set_wall_points(rows, place, wall_rule ? *wall_rule : shape_.wall);
  const Places here{place, place + 1};
  set_wall(shape_, layers_, constants, here, rows);
  rows[SliceShape::gap][place] = wall.gap / wall.inner_radius;
  radius[place] = slice_radius;
  set_radius(shape_, constants.inner_radius, radius, here, rows);
  repeat_last(index + 1);
}

void SliceSystem::set_segments(std::size_t first_pack, std::span<const Pack> heights,
                               const SegmentPack& segments, std::span<Pack> radii) {
  const SegmentConstants<Pack>& constants = segments.constants;
  Pack* first = rows_.data() + first_pack * rows_per_pack_;
  for (int i = 0; i < pack_width; ++i) {
    for (int k = 0; k < shape_.ogden_terms; ++k) {
      const model::OgdenTerm& term = segments.bandages[i]->ogden[k];
      first[shape_.mu_row(k)][i] = term.mu / constants.pressure_scale[i];
      first[shape_.alpha_row(k)][i] = term.alpha;
    }
    set_wall_points(first, i, *segments.wall_rules[i]);
  }
  set_wall(shape_, layers_, constants, {}, first);
  for (std::size_t k = 0; k < heights.size(); ++k) {
    Pack* rows = first + k * rows_per_pack_;
    if (k > 0) std::copy_n(first, rows_per_pack_, rows);
    for (int i = 0; i < pack_width; ++i) {
      const double taper = constants.upper_radius[i] - constants.lower_radius[i];
      radii[k][i] = constants.lower_radius[i] + heights[k][i] * taper;
      rows[SliceShape::gap][i] =
          ((heights[k][i] - 0.5) * taper + constants.gap[i]) / constants.inner_radius[i];
    }
    set_radius(shape_, constants.inner_radius, radii[k], {}, rows);
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

void SliceSystem::gather(std::span<const std::size_t> slices, Pack* rows) const {
  std::array<const double*, pack_width> from;
  for (std::size_t i = 0; i < pack_width; ++i) {
    const std::size_t slice = slices[std::min(i, slices.size() - 1)];
    from[i] = &pack(slice / pack_width)[0].value[slice % pack_width];
  }
  for (std::size_t row = 0; row < rows_per_pack_; ++row)
    for (int i = 0; i < pack_width; ++i) rows[row][i] = from[i][row * pack_width];
}

SliceSystem SliceSystem::replicate(std::size_t index) const {
  SliceShape shape = shape_;
  shape.layers = layers_;
  shape.single = false;
  SliceSystem copy(shape, pack_width);
  copy.shape_.layers = shape_.layers;
  for (std::size_t row = 0; row < rows_per_pack_; ++row)
    for (int i = 0; i < pack_width; ++i) copy.rows_[row][i] = constant(index, static_cast<int>(row));
  return copy;
}

}  // namespace gaiter::physics
