// SPDX-License-Identifier: BSD-2-Clause
#pragma once

#include <optional>

#include "gaiter/physics/slice_system.hpp"

// Which equilibrium, where there may be several. A bandage under voltage, or one that softens (|alpha| < 2),
// can have a limit point; Newton's method would step over it. The searches here walk along the path that the
// real bandage takes, 64 points at a time, and look into every interval in which the sign changes or in which
// the balance comes closer and then recedes, so that a pair of roots between two points is found too.
namespace gaiter::physics {

struct Interval {
  double from = 0, to = 0;  // `from` is reached first
};

// Pressures (units of S) around the equilibrium that the leg of slice `slice` reaches first when the pressure
// grows from 0 to `highest` (ascending; the bandage is let down on the leg), or when it falls from `highest`
// to 0 (the voltage rises). None: no contact on the way, or no equilibrium. Empty, at `highest`: a voltage
// too low to be told from rounding.
std::optional<Interval> contact_interval(const SliceSystem& system, std::size_t slice, double highest,
                                         bool ascending);

// Strain of a leg that would just touch the bandage that floats free outside strain `start` (r = R_c (1 -
// strain), so it is below `start`): the first radius at which P_m = P_a. None: it expands without end (pulled
// in).
std::optional<double> floating_strain(const SliceSystem& system, std::size_t slice, double start);

// The same of a pack of slices whose bandages stiffen: where these rise to their equilibrium and pass it but
// once it is found in a few steps, else `found` is 0 and floating_strain() has to look.
void floating_strains(const SliceShape& shape, const Pack* rows, const Pack& start, Pack& strain,
                      Pack& found);

}  // namespace gaiter::physics
