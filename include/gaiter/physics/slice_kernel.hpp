// SPDX-License-Identifier: BSD-2-Clause
#pragma once

#include "gaiter/physics/slice_system.hpp"

// The laws of a slice, for a pack of 64 slices at a time. All pressures in units of the pack's pressure scale
// S, all strains are the leg's radial strain eps = 1 - r/R_c. `rows` is SliceSystem::pack(k).
namespace gaiter::physics {

// Leg: strain under a pressure, and d strain / d pressure. See leg_law.hpp.
void leg_strain(const SliceShape& shape, const Pack* rows, const Pack& pressure, Pack& strain, Pack& slope);

// Bandage: the pressure P_t = P_m - P_a (paper Eq. 9) with which it presses at a strain of the leg, and
// d P_t / d strain. Negative where the bandage would have to be pulled outwards.
//
// P_m, Eq. (4), is integrated over the logarithm t of the reference radius squared s, where it has no 0/0:
//   P_m = ln(B^2/A^2) int_0^1 sum mu sinh(alpha x) / lambda^2 dt,  lambda^2 = exp(2x) = 1 + (r^2 - A^2)/s,
// and r^2 - A^2 = (r - A)(r + A) is formed from the gap R_c - A. Eq. (4)'s printed sign is dropped.
// P_a, Eq. (8): 2 eps V^2 q / (b^2 log1p(q)^2), q = (b^2 - a^2)/a^2 of each layer in the deformed wall,
// summed. Validity: incompressible, lambda_z = 1, r > 0. Beyond 1e100 the pressure is cut off so that norms
// stay finite.
void bandage_pressure(const SliceShape& shape, const Pack* rows, const Pack& strain, Pack& pressure,
                      Pack& slope);

// True electric field at the inner face of the layer where it is largest, times A / V.
void largest_field(const SliceShape& shape, const Pack* rows, const Pack& strain, Pack& field);

// P_a alone, and d P_a / d strain; zero where shape.layers is 0.
void actuation_pressure(const SliceShape& shape, const Pack* rows, const Pack& strain, Pack& pressure,
                        Pack& slope);

}  // namespace gaiter::physics
