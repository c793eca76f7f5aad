// SPDX-License-Identifier: BSD-2-Clause
#pragma once

#include "gaiter/model/result.hpp"
#include "gaiter/physics/slice_newton.hpp"

namespace gaiter::physics {

// What is found of the slices of a pack, SI.
struct SliceOutcomes {
  Pack leg_radius;               // undeformed [m]
  Pack inner_radius;             // of the bandage's reference wall, A [m]
  Pack pressure_rest_rigid;      // [Pa]
  Pack pressure_actuated_rigid;  // [Pa]
  Pack pressure_rest;            // [Pa]
  Pack pressure_actuated;        // [Pa]
  Pack radius_rest;              // of the leg [m]
  Pack radius_actuated;          // of the leg [m]
  Pack strain_actuated;          // of the leg: 1 - radius_actuated / leg_radius with all its digits [1]
  Pack bandage_radius_rest;      // inner face; larger than the leg's where they do not touch [m]
  Pack bandage_radius_actuated;  // the leg's where the bandage has none (pulled in) [m]
  Pack actuation_drop;           // pressure_rest - pressure_actuated with all its digits [Pa]
  Pack error_rest;               // of pressure_rest, by rounding and by what Newton has left [Pa]
  Pack error_actuated;           // of pressure_actuated, likewise [Pa]
  Pack error_of_difference;      // of the two, without what they have in common [Pa]
  Pack actuation_pressure;       // Eq. (8) at the actuated radius [Pa]
  Pack electric_field;           // [V/m]
  Pack iterations;
  Pack status;  // numbers of model::Status

  model::Status status_of(int place) const {
    return static_cast<model::Status>(static_cast<int>(status[place]));
  }
};

// The functions below take the rows of the pack's constants; pressures in units of the pressure scale.

// On a leg that does not give way, from the bandage's pressure there at rest and its relief by the voltage;
// negative pressures mean no contact.
void record_rigid(const Pack* rows, const Pack& at_rest, const Pack& relief, SliceOutcomes& outcomes);

// The rigid answer as the whole result.
void adopt_rigid(SliceOutcomes& outcomes);

// The state at rest, which is also that of no voltage, and the one under voltage. Puts the state's strain on
// the leg's law: the last step left it on a tangent of the law, and without contact where it was.
void record_rest(const SliceShape& shape, const Pack* rows, const SegmentConstants<Pack>& segments,
                 PackState& state, SliceOutcomes& outcomes);
void record_actuated(const SliceShape& shape, const Pack* rows, const SegmentConstants<Pack>& segments,
                     PackState& state, SliceOutcomes& outcomes);

// What needs the actuated radius of the bandage: actuation pressure and field. `voltage` [V].
void record_loads(const SliceShape& shape, const Pack* rows, const Pack& voltage, SliceOutcomes& outcomes);

}  // namespace gaiter::physics
