// SPDX-License-Identifier: BSD-2-Clause
#pragma once

#include <array>
#include <cstddef>

#include "gaiter/model/scene.hpp"
#include "gaiter/physics/quadrature.hpp"
#include "gaiter/physics/vector_math.hpp"

namespace gaiter::physics {

// What the slices of a segment are set up from: numbers alone, of one segment (Number = double) or of 64, a
// segment a place (Number = Pack).
template <typename Number>
struct SegmentConstants {
  Number height, lower_radius, upper_radius;  // of the leg, undeformed [m]
  Number data_limit;                          // pressure up to which the leg's law was measured [Pa]
  Number pressure_scale, leg_law[4];          // LegConstants
  Number gives_way, shear_modulus;            // of the leg: 1, or 0 if it is rigid; [Pa]
  Number reference_radius;                    // of the bandage: flat length / (2 pi) [m]
  Number inner_radius, thickness;             // of its reference wall [m]
  Number gap;                                 // mean leg radius less the inner radius of the wall [m]
  Number steepest;                            // largest |alpha| of the Ogden terms
  Number voltage, permittivity, layers;
  Number slides;              // 1: free along the leg, 0: held
  Number stiffens;            // 1: without voltage there is one equilibrium, else 0
  Number wall_points;         // Gauss points through the wall; 0: to be chosen
  Number wall_error;          // of the quadrature through the wall, relative
  Number passive_wall_error;  // the same, where it does not yet tell what the equilibrium makes of it, else 0
};

using SegmentNumbers = SegmentConstants<double>;

// All but the wall's error, and its points where these are to be chosen.
SegmentNumbers segment_numbers(const model::Scene& scene, std::size_t segment);

// Up to 64 segments.
struct SegmentPack {
  int count = 0;  // places in use; the others repeat the last of these
  SegmentConstants<Pack> constants;
  std::array<const model::Bandage*, pack_width> bandages{};
  std::array<const Quadrature*, pack_width> wall_rules{};

  // Puts a segment into a place.
  void set(int place, const SegmentNumbers& numbers, const model::Bandage& bandage,
           const Quadrature& wall_rule);
  // Repeats the last segment to the end of the pack, so that no garbage slows or spoils it.
  void close(int used);
};

}  // namespace gaiter::physics
