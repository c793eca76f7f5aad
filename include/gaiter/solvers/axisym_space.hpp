// SPDX-License-Identifier: BSD-2-Clause
#pragma once

#include <utility>
#include <vector>

#include "gaiter/physics/axisym_element.hpp"
#include "gaiter/solvers/axisym_mesh.hpp"

namespace gaiter::solvers {

// A cell of this rank and where its unknowns are: u_r, u_z of each node, then the pressures of a tube's cell,
// then the potentials of its nodes where the space has them.
// Places in the local Vec of the DM (fixed unknowns included), and in the global Vec (fixed ones: -1).
template <int P>
struct AxisymCell {
  int block = 0, column = 0, row = 0;
  typename physics::AxisymElement<P>::Geometry geometry;
  std::vector<PetscInt> local, global;
};

// A node of a contact surface; its unknowns' places in the global Vec (-1: fixed at 0).
struct SurfaceNode {
  double radius = 0, height = 0;  // reference
  PetscInt u_r = -1, u_z = -1, multiplier = -1;
};

// One contact surface from bottom to top: P + 1 nodes an edge, neighbouring edges share one. The same on
// every rank.
struct ContactSurface {
  int block = 0;
  std::vector<SurfaceNode> nodes;
};

// What the space of a problem holds besides displacements and pressures.
struct SpaceChoice {
  bool multipliers_on_tube = true;
  bool held = false;
  int layers = 0;  // of the wall that the electric potential is solved in; 0: no potential
};

// The unknowns of an axisymmetric problem on its DMPlex: displacement on both bodies, discontinuous pressure
// in the tubes, a multiplier at each contact vertex of the tubes (or of the leg), and if chosen the electric
// potential in the tubes, over the voltage. Fixed: u_z at both ends of every body, u_r on the axis, with
// `held` u_z on the contact surfaces, and the potential at the electrodes, in turn 0 and 1.
template <int P>
struct AxisymSpace {
  AxisymMesh mesh;
  Plex plex;
  std::vector<AxisymCell<P>> cells;   // of this rank
  std::vector<ContactSurface> tubes;  // one a tube block
  ContactSurface leg;
  SpaceChoice choice;
  PetscInt pressures = 0, multipliers = 0, potentials = 0;  // free ones, over all ranks
  std::vector<std::pair<PetscInt, double>> electrodes;  // places in the local Vec, and the potential there

  // Of the tangent at a stable state: one for each unknown that the energy is largest in.
  PetscInt negative_eigenvalues() const { return pressures + multipliers + potentials; }

  // @note Collective. The columns of every tube must be a multiple of the layers chosen.
  static AxisymSpace make(MPI_Comm comm, AxisymMesh mesh, const SpaceChoice& choice);
};

}  // namespace gaiter::solvers
