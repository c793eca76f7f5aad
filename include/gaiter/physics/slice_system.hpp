// SPDX-License-Identifier: BSD-2-Clause
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "gaiter/model/scene.hpp"
#include "gaiter/physics/leg_law.hpp"
#include "gaiter/physics/quadrature.hpp"
#include "gaiter/physics/segment_pack.hpp"
#include "gaiter/physics/vector_math.hpp"

namespace gaiter::physics {

// What all slices of a system have in common, and so where a pack's rows are.
struct SliceShape {
  Quadrature wall;  // the most points through the wall, in the logarithm of the reference radius
  int ogden_terms = 1;
  int layers = 0;  // 0: no voltage, the actuation is left out
  model::LegMaterial material = model::LegMaterial::compliance;
  bool single = false;  // exponentials and logarithms of the laws in single precision

  // Rows that are always there; the variable ones follow.
  enum Row {
    gap,
    leg_radius,
    log_wall,
    leg_0,
    leg_1,
    leg_2,
    leg_3,
    pressure_limit,
    pressure_scale,
    fixed_rows
  };
  int mu_row(int term) const { return fixed_rows + term; }
  int alpha_row(int term) const { return mu_row(ogden_terms) + term; }
  int wall_row(int point) const { return alpha_row(ogden_terms) + point; }
  int weight_row(int point) const { return wall_row(static_cast<int>(wall.nodes.size())) + point; }
  // Three rows a layer: (A/A_layer)^2, (B_layer^2 - A_layer^2)/A_layer^2, 2 eps V^2/(A_layer^2 S).
  int layer_row(int layer) const { return weight_row(static_cast<int>(wall.nodes.size())) + 3 * layer; }
};

// The reference wall of a bandage module: inner radius and thickness.
struct Wall {
  double inner_radius = 0;  // A [m]
  double thickness = 0;     // B - A [m]
  double gap = 0;           // undeformed leg radius less A, formed without cancellation [m]
};

// The wall of a module on a leg of radius `leg_radius` at the slice, in a segment of mean radius
// `mean_radius`.
Wall reference_wall(const model::Bandage& bandage, const model::Module& module, double mean_radius,
                    double leg_radius);

// The constants of many slices, as structure of arrays: packs of rows, a row holds one quantity of 64 slices.
// Lengths are divided by the inner reference radius A of the wall, pressures by the pressure scale S of the
// leg (1/b of the strain law; K + G/3 of the neo-Hookean leg).
class SliceSystem {
 public:
  SliceSystem() = default;
  SliceSystem(SliceShape shape, std::size_t slices);

  // Makes it as new, in the memory it has.
  void reset(SliceShape shape, std::size_t slices);

  const SliceShape& shape() const { return shape_; }
  std::size_t slices() const { return slices_; }
  std::size_t packs() const { return packs_; }

  // Constants of slice `index`. The radii of the calf and the wall are those of the slice. `wall_rule`: its
  // own points through the wall, at most as many as the shape's, so that a thin wall does not depend on what
  // the thickest of the system needs; null: the shape's.
  void set(std::size_t index, const model::Leg& leg, const model::Segment& segment,
           const model::Bandage& bandage, const Wall& wall, double leg_radius, double voltage,
           const Quadrature* wall_rule = nullptr);

  // Constants of the slices of up to 64 segments: the packs `first_pack`, `first_pack` + 1, ... take those at
  // a height from 0 to 1 of each, a segment a place. `radii` take the leg's radius.
  void set_segments(std::size_t first_pack, std::span<const Pack> heights, const SegmentPack& segments,
                    std::span<Pack> radii);

  // With the voltage on, or off as if there were none (the rest state).
  void energise(bool on) { shape_.layers = on ? layers_ : 0; }

  // A system of `packs() == 1` whose slices all have the constants of slice `index` of this one, in double
  // precision: branches are told apart by the last digits.
  SliceSystem replicate(std::size_t index) const;

  // Constants of up to 64 slices of several packs to the rows of one; the spare places repeat the last slice.
  void gather(std::span<const std::size_t> slices, Pack* rows) const;

  std::size_t rows_per_pack() const { return rows_per_pack_; }
  const Pack* pack(std::size_t index) const { return rows_.data() + index * rows_per_pack_; }
  double constant(std::size_t slice, int row) const {
    return pack(slice / pack_width)[row][slice % pack_width];
  }

 private:
  double& at(std::size_t slice, int row) {
    return rows_[slice / pack_width * rows_per_pack_ + row][slice % pack_width];
  }

  void set_wall_points(Pack* rows, int place, const Quadrature& rule) const;
  void repeat_last(std::size_t end);

  SliceShape shape_;
  int layers_ = 0;
  std::size_t slices_ = 0, packs_ = 0, rows_per_pack_ = 0;
  std::vector<Pack> rows_;
};

}  // namespace gaiter::physics
