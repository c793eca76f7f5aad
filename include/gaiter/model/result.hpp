// SPDX-License-Identifier: BSD-2-Clause
#pragma once

#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>

#include "gaiter/model/scene.hpp"

namespace gaiter::model {

// Of a slice, and of a segment: the last of its slices' in this order, at rest or actuated.
enum class Status : signed char {
  contact,         // the bandage presses on the leg
  slack,           // too wide to touch the leg even at rest
  lifted,          // pressed at rest, lifted off under voltage
  extrapolated,    // pressure beyond the compliance data
  pulled_in,       // under voltage the bandage has no equilibrium of its own and none on the leg
  no_equilibrium,  // none exists in the admissible range of radii
  diverged,        // the solver gave up; the numbers are NaN
  invalid,         // not solved: the values of this design of a sweep make no possible scene
  not_wanted       // not solved: -fidelity auto, and no output of this segment is wanted
};
constexpr std::size_t status_count = static_cast<std::size_t>(Status::not_wanted) + 1;

// True where the numbers of a result can be used (pulled_in: the pressure is 0, as computed).
constexpr bool trustworthy(Status status) {
  return status < Status::no_equilibrium;
}

// True where there should be a result and is none.
constexpr bool failed(Status status) {
  return !trustworthy(status) && status != Status::not_wanted;
}

// What every fidelity reports of one segment of one design. Names as in the archive.
struct SegmentResult {
  double pressure_rest = 0;                // height average (1/H) int P dz [Pa]
  double pressure_actuated = 0;            // [Pa]
  double pressure_rest_rigid = 0;          // the same on a leg that does not give way [Pa]
  double pressure_actuated_rigid = 0;      // [Pa]
  double pressure_rest_area_mean = 0;      // normal force over the deformed area of the inner face [Pa]
  double pressure_actuated_area_mean = 0;  // [Pa]
  double pressure_rest_change = 0;      // of pressure_rest, because the leg gives way: 1 - with / without [1]
  double pressure_actuated_change = 0;  // of pressure_actuated, likewise [1]
  double actuation_drop = 0;            // pressure_rest - pressure_actuated [Pa]
  double actuation_pressure = 0;        // P_a of Eq. (8) at the actuated radius, height average [Pa]
  double volume_initial = 0;            // of the leg [m3]
  double volume_rest = 0;               // [m3]
  double volume_actuated = 0;           // [m3]
  double volume_change = 0;             // (initial - actuated) / initial, Eq. (10) [1]
  double radius_actuated = 0;           // of the leg, height average [m]
  double stretch_actual = 0;            // at rest, once the leg has given way, height average [1]
  double slip_max = 0;                  // largest |z - Z| of the tube, at rest or actuated [m]
  double electric_field_max = 0;        // true field, at the inner face of a layer [V/m]
  // Largest voltage reached on the branch of stable states that starts at rest: the module's own where the
  // actuated state was found, NaN where the model does not follow that branch to its end [V].
  double voltage_stable = 0;
  // Of the pressures; by -fidelity auto of the wanted output where they are largest.
  double error_estimate = 0;        // discretisation_error, plus model_error where that is known [1]
  double discretisation_error = 0;  // relative, against the same model resolved [1]
  double model_error = 0;  // what the models beyond this one would change, as far as known; NaN: unknown [1]
  // What -fidelity auto expected when it chose the model; NaN: not known beforehand, or nothing was chosen.
  double planned_discretisation_error = std::numeric_limits<double>::quiet_NaN();  // relative [1]
  double planned_model_error = std::numeric_limits<double>::quiet_NaN();  // by the models still allowed [1]
  double planned_cost = std::numeric_limits<double>::quiet_NaN();         // processor time [s]
  int slice_count = 0;  // over the height; 0: finite elements
  int wall_points = 0;  // through the wall; 0: finite elements
  int unknowns = 0;     // of the system solved; of a whole leg: its share [1]
  int iterations = 0;   // Newton or fixed-point steps, the most of any slice
  Status status = Status::contact;
  Fidelity fidelity = Fidelity::slice;
};

// Fills in what follows from the pressures: their changes and the actuation drop. Without pressure there is
// no change.
inline void derive_changes(SegmentResult& result) {
  const auto change = [](double with, double without) {
    return without != 0 ? 1 - with / without : with - without;
  };
  result.pressure_rest_change = change(result.pressure_rest, result.pressure_rest_rigid);
  result.pressure_actuated_change = change(result.pressure_actuated, result.pressure_actuated_rigid);
  result.actuation_drop = result.pressure_rest - result.pressure_actuated;
}

// An estimated error, rounded up to 8 binary digits: more would mean nothing, and fill archives.
inline double rounded_up(double error) {
  constexpr std::uint64_t rest = (std::uint64_t{1} << 44) - 1;
  if (!(error > 0) || !std::isfinite(error)) return error;
  return std::bit_cast<double>((std::bit_cast<std::uint64_t>(error) + rest) & ~rest);
}

// Rounds the errors and fills in their sum. `known`: the part of the model's error that is, where that is
// not.
inline void derive_error(SegmentResult& result, double known = 0) {
  result.discretisation_error = rounded_up(result.discretisation_error);
  result.model_error = rounded_up(result.model_error);
  const double beyond = result.model_error >= 0 ? result.model_error : known >= 0 ? known : 0;
  result.error_estimate = rounded_up(result.discretisation_error + beyond);
}

// A row of which nothing but the reason is known.
inline SegmentResult without_numbers(Status status, Fidelity fidelity) {
  constexpr double none = std::numeric_limits<double>::quiet_NaN();
  SegmentResult result{none, none, none, none, none, none, none, none, none, none, none,
                       none, none, none, none, none, none, none, none, none, none, none};
  result.status = status;
  result.fidelity = fidelity;
  return result;
}

}  // namespace gaiter::model
