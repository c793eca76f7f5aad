// SPDX-License-Identifier: BSD-2-Clause
#pragma once

#include "gaiter/model/bandage.hpp"
#include "gaiter/model/leg.hpp"

namespace gaiter::model {

enum class Fidelity { rigid, slice };
enum class SliceRule { gauss, midpoint };
enum class SliceSolver { newton, fixed_point };

// How finely, and by which algorithm, the slice model is solved.
struct Discretisation {
  SliceRule slice_rule = SliceRule::gauss;
  int slice_count = 6;  // a segment
  int wall_points = 0;  // Gauss points through the wall; 0: as many as the wall needs
  SliceSolver slice_solver = SliceSolver::newton;
  double fixed_point_tolerance = 1e-4;  // change of r over the undeformed radius at which the paper stops [1]
};

// Everything a solve needs: leg, bandage, loads (the modules' voltages) and how to solve.
struct Scene {
  Leg leg;
  Bandage bandage;
  Fidelity fidelity = Fidelity::slice;
  Discretisation discretisation;
};

}  // namespace gaiter::model
