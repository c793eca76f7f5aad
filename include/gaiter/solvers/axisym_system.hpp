// SPDX-License-Identifier: BSD-2-Clause
#pragma once

#include <vector>

#include "gaiter/solvers/axisym_space.hpp"

namespace gaiter::solvers {

// What the bodies are made of, in the units of the problem: stresses over `stress`, lengths over mesh.length.
struct AxisymMaterials {
  double stress = 1;  // [Pa]
  // A tube block each. Permittivity: absolute x V^2 / (length^2 stress), potential in V.
  std::vector<physics::TubeMaterial> tubes;
  std::vector<physics::LegMaterialLaw> leg;  // a segment of the scene each
};

// Residual and tangent of tubes on a leg: internal forces, incompressibility and contact, all derived from
// one potential
//   sum of element energies - sum_k lambda_k G_k,
// so that the tangent is symmetric. A multiplier is active while lambda_k - c G_k / (area of its hat) > 0;
// the row of one that is not reads lambda_k = 0, and it presses on nothing: in the potential, - area
// lambda_k^2 / 2 stands for - lambda_k G_k, whose dependence on the area is left out, as lambda_k is 0 after
// one full step.
template <int P>
class AxisymSystem {
 public:
  // @note Collective.
  AxisymSystem(MPI_Comm comm, AxisymSpace<P> space, AxisymMaterials materials);

  // Residual and tangent values at x; the tangent is in matrix() after assemble(). False, on all ranks alike,
  // where the trial is inadmissible (an inverted element, a contact surface that folds). @note Collective.
  PetscErrorCode evaluate(Vec x, Vec residual, bool& admissible);
  PetscErrorCode assemble();

  // A local Vec of the DM from x, the fixed unknowns included. @note Collective.
  PetscErrorCode fill_local(Vec x, Vec local) const;

  // Potential at the last x evaluated. @note Collective.
  double energy() const;

  // The share of the electric field's energy that acts: 0 no voltage, 1 the full one; linear in the voltage's
  // square. The field is that of the space's potential if it has one, else the closed form across the wall.
  void energise(double share) { energised_ = share; }
  double energised() const { return energised_; }
  typename physics::AxisymElement<P>::WallField field(const AxisymBlock& tube) const {
    return {energised_, tube.inner[0], tube.outer[0]};
  }

  // Another leg, of as many segments.
  void set_leg(std::vector<physics::LegMaterialLaw> leg) { materials_.leg = std::move(leg); }

  // A spring, per length of the tubes' inner faces, that holds them at their reference height: 0 for the
  // model itself, a path to it where Newton's method needs one. In units of stress.
  void set_axial_spring(double stiffness) { spring_ = stiffness; }

  // Largest change of a displacement in a direction, over the unit of length. @note Collective.
  PetscErrorCode largest_displacement(Vec direction, double& largest) const;

  // Current contact surfaces at the last x evaluated: radius, height and, at vertices, pressure (0
  // elsewhere).
  struct SurfaceState {
    std::vector<double> radius, height, multiplier, gap;  // gap: of each vertex, mean over its hat
    std::vector<bool> active;
  };
  const std::vector<SurfaceState>& tubes() const { return tubes_; }
  const SurfaceState& leg() const { return leg_; }
  int active_changes() const { return active_changes_; }  // at the last evaluation

  const AxisymSpace<P>& space() const { return space_; }
  const AxisymMaterials& materials() const { return materials_; }
  Mat matrix() const { return matrix_.get(); }
  int pattern() const { return pattern_; }  // counts the patterns matrix() has had: contact may slide far
  MPI_Comm comm() const { return comm_; }

 private:
  using Element = physics::AxisymElement<P>;
  static constexpr int pair_unknowns = 4 * (P + 1) + 2;

  // A tube's edge and a leg's edge that may touch, and the place of their block in the tangent.
  struct Pair {
    int tube = 0, tube_edge = 0, leg_edge = 0;
  };

  PetscErrorCode create();
  PetscErrorCode preallocate();
  std::vector<PetscInt> unknowns_of(const Pair& pair) const;
  void list_pairs();
  PetscErrorCode read_surfaces(Vec x);
  PetscErrorCode add_cells(Vec x, Vec residual, bool& admissible);
  PetscErrorCode add_contact(Vec residual, bool& admissible);
  PetscErrorCode add_spring(Vec residual);
  physics::ContactJet<P> segment_potential(int tube, const physics::ContactSegment& segment,
                                           bool effective) const;

  MPI_Comm comm_;
  AxisymSpace<P> space_;
  AxisymMaterials materials_;
  petsc::Handle<Mat, MatDestroy> matrix_;
  petsc::Handle<VecScatter, VecScatterDestroy> scatter_;
  petsc::Vector surface_values_, local_x_, local_residual_;
  std::vector<PetscInt> surface_unknowns_;

  std::vector<SurfaceState> tubes_;
  SurfaceState leg_;
  std::vector<Pair> pairs_;   // all, the same on every rank
  std::vector<int> pair_at_;  // [tube edge over all tubes][leg edge] -> pair, -1: none
  std::vector<int> first_tube_edge_;
  std::size_t cell_values_ = 0, first_spring_value_ = 0;  // of values_
  std::vector<PetscScalar> values_;
  double energy_ = 0, spring_ = 0, energised_ = 0;
  int active_changes_ = 0, pattern_ = 0;
};

}  // namespace gaiter::solvers
