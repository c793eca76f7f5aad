// SPDX-License-Identifier: BSD-2-Clause
#pragma once

#include <memory>
#include <vector>

#include "gaiter/solvers/axisym_fields.hpp"
#include "gaiter/solvers/axisym_solver.hpp"
#include "gaiter/solvers/axisym_start.hpp"
#include "gaiter/solvers/axisym_summary.hpp"

namespace gaiter::solvers {

// The problem's unit of stress: the elastomer's initial shear modulus [Pa].
double axisym_stress_unit(const model::Bandage& bandage);

// One segment of a scene on one mesh, and the way to its states. The scene outlives it.
template <int P>
class AxisymCase {
 public:
  // @note Collective.
  AxisymCase(MPI_Comm comm, const model::Scene& scene, std::size_t segment, int refinements);
  AxisymCase(const AxisymCase&) = delete;
  AxisymCase& operator=(const AxisymCase&) = delete;

  void try_solver();         // one linear solve at the start. @note Collective.
  AxisymSummary rest();      // @note Collective.
  AxisymSummary actuated();  // from the state at rest, which comes first. @note Collective.

  // Hands the fields of the state last found over, on rank 0. @note Collective.
  void show(bool actuated, const AxisymObserver& observer) const;

 private:
  AxisymMaterials materials(double length) const;
  std::vector<RadialState> states(bool actuated) const;
  AxisymReport follow_spring(int& iterations);
  AxisymSummary summarise(const AxisymReport& report, int iterations, bool energised) const;

  const model::Scene& scene_;
  std::size_t segment_;
  std::unique_ptr<AxisymSystem<P>> system_;
  std::unique_ptr<AxisymSolver<P>> solver_;
  petsc::Vector x_, kept_;
};

}  // namespace gaiter::solvers
