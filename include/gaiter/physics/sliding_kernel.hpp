// SPDX-License-Identifier: BSD-2-Clause
#pragma once

#include "gaiter/physics/sliding_system.hpp"

// The laws of sliding slices (see sliding_system.hpp) at one Gauss point of 64 segments. Lengths over A,
// pressures over S. `section` and `rows` are SlidingSystem::section(k) and pack(k).
namespace gaiter::physics {

// Where the tube's circle is: three numbers.
struct SlidingPlace {
  Pack height;   // z less half the segment's height
  Pack advance;  // dz/dZ - 1
  // u, which says both how hard the tube presses and where it is: on the leg, u > 0, the pressure (or, for
  // the neo-Hookean leg, the strain over that of the unit pressure in the linear limit), from which the law
  // of the leg gives pressure and strain without being inverted; off the leg, u <= 0, the strain that a leg
  // touching the tube would have, beyond that of no pressure, in the same unit.
  Pack contact;
};

// Derivatives of the energy e(z, zeta, eps) per reference height over 2 pi, zeta = dz/dZ. The third variable
// of the second derivatives is `contact`: d eps = strain_slope d contact.
struct SlidingTerms {
  Pack z, zeta, strain;                 // e_z, e_zeta, e_eps
  Pack z_z, z_zeta, zeta_zeta;          // second derivatives
  Pack z_strain, zeta_strain;           // second derivatives
  Pack strain_slope, strain_stiffness;  // d eps / d contact; d e_eps / d contact
  Pack energy;                          // e
  Pack energy_size;                     // sum of the sizes of its parts, of which rounding is a part
  Pack admissible;                      // 1, or 0: inverted, crushed or not finite
};

void sliding_terms(const SlidingShape& shape, const SliceShape& slice, const Pack* section, const Pack* rows,
                   const SlidingPlace& place, SlidingTerms& terms);

// What is reported of a circle.
struct SlidingCircle {
  Pack pressure;            // P, 0 off the leg
  Pack leg_strain;          // of the leg itself
  Pack leg_radius;          // undeformed, at this height
  Pack tube_radius;         // r; larger than the leg's where they do not touch
  Pack actuation_pressure;  // what the voltage takes from the tube's pressure at this place
  Pack field;               // largest true field at the inner face of a layer, times A / V
};

void describe_circle(const SlidingShape& shape, const SliceShape& slice, const Pack* section,
                     const Pack* rows, const SlidingPlace& place, SlidingCircle& circle);

}  // namespace gaiter::physics
