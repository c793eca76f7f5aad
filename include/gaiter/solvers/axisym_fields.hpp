// SPDX-License-Identifier: BSD-2-Clause
#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "gaiter/solvers/axisym_system.hpp"

namespace gaiter::solvers {

// Nodal fields of a solved state, in SI. Points are shared by the cells of one body on one segment, so that
// stresses may jump where one segment's leg meets the next; a cell has order + 1 points a side, equispaced on
// the reference cell.
struct AxisymFields {
  std::size_t first_segment = 0, last_segment = 0;  // of the scene, that the mesh covers
  bool actuated = false;
  int order = 2;
  // Of each point.
  std::vector<double> position;          // deformed r, z [m]
  std::vector<double> displacement;      // u_r, u_z [m]
  std::vector<double> stress;            // Cauchy rr, zz, rz, tt, mean over the cells at the point [Pa]
  std::vector<double> contact_pressure;  // on the contact surfaces, elsewhere 0 [Pa]
  // Of each cell.
  std::vector<std::int64_t> cells;  // its points, along R first
  std::vector<int> tube;            // 1: bandage, 0: leg
  std::vector<int> segment;         // of the scene
};

// Is given the fields of each state as it is found.
using AxisymObserver = std::function<void(AxisymFields)>;

// The fields at x, which is the last vector that the system has evaluated: on rank 0 of its communicator, no
// points elsewhere. Stresses are those of the Gauss points, where they are most accurate, extrapolated in
// each cell by the polynomial through them. @note Collective.
template <int P>
AxisymFields extract_fields(const AxisymSystem<P>& system, Vec x);

}  // namespace gaiter::solvers
