// SPDX-License-Identifier: BSD-2-Clause
#pragma once

#include "gaiter/model/leg.hpp"
#include "gaiter/physics/segment_pack.hpp"

// The states that model_error.hpp judges, of up to 64 segments at a time.
namespace gaiter::physics {

// What plain slices say of the segments of a pack.
struct SlicesFound {
  Pack in_contact;                        // all over: 1, else 0
  Pack pressure_rest, pressure_actuated;  // [Pa]
  Pack lost_at_rest, lost_actuated;       // part of the leg's volume
};

// What the shifts and their bounds are made of, in one state.
template <typename Number>
struct State {
  Number pressure_sliding, pressure_slope, pressure_ends;  // ModelShift
  Number volume_sliding, volume_slope, volume_ends;
  Number growth;        // of ln P with ln R, from slice to slice
  Number k;             // K
  Number slide;         // K m H/R: how much the axial stretch differs between the ends
  Number strain;        // of the leg
  Number leg_share;     // part of a change of pressure that the leg's giving way takes off
  Number slope_square;  // m^2
  Number reach_square;  // (m H/R)^2
  Number stretch;       // of the bandage, at the mean radius
  Number narrow;        // and at the narrow end
  Number stable;        // axially: 1, else 0
};

// Both states of a segment, which of them are inside of the box and of the wider one (1, else 0), and of the
// leg's shear modulus: the pressure at rest over it, and it over the leg's stiffness against a small uniform
// pressure.
template <typename Number>
struct States {
  State<Number> rest, actuated;
  Number rest_known, actuated_known;
  Number rest_bounded, actuated_bounded;
  Number shear_load, shear_part;
};

// The places of a pack that are worked on.
struct Places {
  int from = 0, to = pack_width;
};

// All segments have the same leg material and number of Ogden terms. Without contact the states are garbage.
void find_model_states(const SegmentPack& segments, model::LegMaterial material, const SlicesFound& slices,
                       Places places, States<Pack>& states);

}  // namespace gaiter::physics
