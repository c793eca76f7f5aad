// SPDX-License-Identifier: BSD-2-Clause
#pragma once

#include "gaiter/solvers/axisym_system.hpp"

namespace gaiter::solvers {

// What a state says of a segment. Lengths over mesh.length, stresses over materials().stress; of a state that
// did not converge only the first line.
struct AxisymSummary {
  bool converged = false, stable = true;
  int iterations = 0;
  double pressure = 0;          // height average
  double pressure_area = 0;     // normal force over the deformed area of the tube's inner face
  double volume = 0;            // of the leg
  double radius = 0;            // of the leg's surface, height average
  double stretch = 0;           // inner radius of the tube over the module's reference radius, height average
  double slip = 0;              // largest |z - Z| of the tube's inner face
  double stable_voltage = 1;    // the largest reached on the branch of stable states, over the voltage
  double field = 0;             // largest away from the ends, times mesh.length over the voltage
  double maxwell = 0;           // P_a of Eq. (8), height average
  double highest_pressure = 0;  // away from the ends, where pressures are singular
  bool open_everywhere = false;  // the tube does not touch
};

// One segment of the state that the system was last evaluated at, which is converged; `block`: its tube.
// Pressures, stretch and slip are those of the tube, whose ends are fixed at the segment's heights. Volume
// and radius are those of the leg's material that belongs to the segment: in a leg of several segments it
// moves axially, and the volumes of all add up to the leg's. `energised`: under voltage.
template <int P>
AxisymSummary summarise_axisym(const model::Scene& scene, std::size_t segment, const AxisymSystem<P>& system,
                               int block, bool energised);

// The outputs whose errors are estimated: the height average of the pressure, and the volume of the leg.
enum class AxisymOutput { pressure, volume };

// Derivative of the summary's value by all unknowns, at the state that the system was last evaluated at.
// @note Collective.
template <int P>
PetscErrorCode differentiate_output(const AxisymSystem<P>& system, int block, AxisymOutput output,
                                    Vec gradient);

}  // namespace gaiter::solvers
