// SPDX-License-Identifier: BSD-2-Clause
#pragma once

#include <cstddef>
#include <vector>

#include "gaiter/model/bandage.hpp"
#include "gaiter/model/leg.hpp"

namespace gaiter::model {

// In the order of the archive's numbers; results are never `automatic`, which chooses one of the others.
enum class Fidelity { rigid, slice, sliding, axisym, first_order, automatic };
enum class SliceRule { gauss, midpoint };
enum class SliceSolver { newton, fixed_point };
enum class SlicePrecision { in_double, in_single };  // of the laws' exponentials and logarithms
enum class ContactAxial { free, held };              // along the leg: lubricated, or as laid on

// How finely, and by which algorithm, the slice model is solved.
struct Discretisation {
  SliceRule slice_rule = SliceRule::gauss;
  int slice_count = 6;  // a segment
  int wall_points = 0;  // Gauss points through the wall; 0: as many as the wall needs
  SliceSolver slice_solver = SliceSolver::newton;
  SlicePrecision slice_precision = SlicePrecision::in_double;
  double newton_tolerance =
      1e-12;               // relative, of a slice's pressure, unless -slice_snes_rtol says another [1]
  int sliding_count = 24;  // slices of a sliding segment, rounded up to a multiple of three
  double fixed_point_tolerance = 1e-4;  // change of r over the undeformed radius at which the paper stops [1]
};

// Electric field in the wall: in closed form across the deformed wall, from the potential solved on the mesh,
// or none.
enum class Electrostatics { radial, field, off };
enum class ContactSide { tube, leg };
enum class AxisymScope { segment, leg };  // on one mesh: a segment, its ends held axially, or the whole leg

// How the axisymmetric finite element model is solved.
struct AxisymChoice {
  Electrostatics electrostatics = Electrostatics::field;
  ContactSide multipliers = ContactSide::tube;  // surface whose vertices carry the contact pressure
  int order = 2;                                // of the displacement: 2, 3 or 4
  int refine = 1;                               // uniform refinements of the coarsest mesh
  AxisymScope scope = AxisymScope::segment;
  int ranks_per_case = 1;  // that share one mesh
};

// Outputs whose errors count.
struct Wanted {
  bool pressure_rest = true, pressure_actuated = true, actuation_drop = false, volume_change = false;

  // Which states they need.
  bool at_rest() const { return pressure_rest || actuation_drop; }
  bool actuated() const { return pressure_actuated || actuation_drop || volume_change; }
  bool any() const { return pressure_rest || actuated(); }
};

// What -fidelity auto is to reach.
struct Goal : Wanted {
  double accuracy = 1e-3;               // relative, of each wanted output [1]
  Fidelity up_to = Fidelity::axisym;    // the finest model that may be taken
  std::vector<Wanted> of_segment = {};  // where segments differ: of each; empty: all want the same

  const Wanted& of(std::size_t segment) const { return of_segment.empty() ? *this : of_segment[segment]; }
};

// Everything a solve needs: leg, bandage, loads (the modules' voltages) and how to solve.
struct Scene {
  Leg leg;
  Bandage bandage;
  Fidelity fidelity = Fidelity::slice;
  ContactAxial contact_axial = ContactAxial::free;  // sliding and axisym
  Discretisation discretisation;
  AxisymChoice axisym;
  Goal goal;

  // -fidelity auto leaves out segments of which nothing is wanted.
  bool wants(std::size_t segment) const { return fidelity != Fidelity::automatic || goal.of(segment).any(); }
};

}  // namespace gaiter::model
