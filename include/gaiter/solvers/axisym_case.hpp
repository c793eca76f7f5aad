// SPDX-License-Identifier: BSD-2-Clause
#pragma once

#include <functional>
#include <memory>
#include <span>
#include <vector>

#include "gaiter/solvers/axisym_fields.hpp"
#include "gaiter/solvers/axisym_solver.hpp"
#include "gaiter/solvers/axisym_start.hpp"
#include "gaiter/solvers/axisym_summary.hpp"

namespace gaiter::solvers {

// The problem's unit of stress: the elastomer's initial shear modulus [Pa].
double axisym_stress_unit(const model::Bandage& bandage);

// The materials of segments first to last of a scene, in the units of their mesh.
AxisymMaterials axisym_materials(const model::Scene& scene, std::size_t first, std::size_t last);

// Neighbouring segments of a scene, one or all, on one mesh, and the way to their states: the leg as one
// body, fixed axially at its two ends, a tube for each segment, fixed axially at either end of its own. The
// scene outlives the case.
template <int P>
class AxisymCase {
 public:
  // Segments first to last, both included. @note Collective.
  AxisymCase(MPI_Comm comm, const model::Scene& scene, std::size_t first, std::size_t last, int refinements)
      : AxisymCase(comm, scene, first, last, AxisymResolution{.refinements = refinements}) {}
  AxisymCase(MPI_Comm comm, const model::Scene& scene, std::size_t first, std::size_t last,
             AxisymResolution resolution);
  AxisymCase(const AxisymCase&) = delete;
  AxisymCase& operator=(const AxisymCase&) = delete;

  void try_solver();  // one linear solve at the start. @note Collective.
  // One summary a segment. Starts from the sliding slices where nothing holds the tubes and these have an
  // answer, else from the slices; where this fails, on the path from a stiffer leg to the
  // scene's, or on that of a spring that is let go.
  // @note Collective.
  std::vector<AxisymSummary> rest();
  // From the state at rest, which comes first. @note Collective.
  std::vector<AxisymSummary> actuated();

  // The same from the states that a coarser mesh has found, where Newton's method gets there from these.
  // @note Collective.
  std::vector<AxisymSummary> rest(AxisymCase& coarser);
  std::vector<AxisymSummary> actuated(AxisymCase& coarser);

  int unknowns() const;  // of all ranks

  // Hands the fields of the state last found over, on rank 0. @note Collective.
  void show(bool actuated, const AxisymObserver& observer) const;

  // Puts what the slices or the sliding slices say of a state into state(), as it is: with ends that bending
  // does not take off the leg. False where these have no answer. Not for a field solved on the mesh.
  // @note Collective.
  bool take_model(model::Fidelity fidelity, bool actuated);

  const AxisymSystem<P>& system() const { return *system_; }
  AxisymSystem<P>& system() { return *system_; }
  AxisymSolver<P>& solver() { return *solver_; }
  Vec state() const { return x_.get(); }  // last found

 private:
  // What a simpler model says of a segment at relative heights of the tube's or the leg's surface.
  using Source = std::function<RadialState(std::size_t, std::span<const double>, bool)>;

  std::vector<RadialState> states(const Source& source) const;
  std::vector<RadialState> slices(const model::Scene& scene) const;
  std::vector<RadialState> sliding(const model::Scene& scene) const;
  AxisymReport solve_from(const model::Scene& scene, int& iterations);
  AxisymReport soften_leg(int& iterations);
  AxisymReport follow_spring(int& iterations);
  std::vector<AxisymSummary> summarise(const AxisymReport& report, int iterations, bool energised);
  AxisymReport solve_from(AxisymCase& coarser, bool energised);
  void recall(bool energised);

  const model::Scene& scene_;
  std::size_t first_, last_;
  std::unique_ptr<AxisymSystem<P>> system_;
  std::unique_ptr<AxisymSolver<P>> solver_;
  petsc::Vector x_, kept_;
  petsc::Vector rest_, actuated_;  // the states found
};

}  // namespace gaiter::solvers
