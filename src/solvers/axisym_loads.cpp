// SPDX-License-Identifier: BSD-2-Clause
// What acts on the faces of an AxisymSystem's tubes besides contact: the electric field across the wall, and
// the spring of a path.
#include <algorithm>

#include "gaiter/petsc/check.hpp"
#include "gaiter/petsc/session.hpp"
#include "gaiter/physics/electrodes.hpp"
#include "gaiter/solvers/axisym_system.hpp"

namespace gaiter::solvers {

template <int P>
PetscErrorCode AxisymSystem<P>::add_electrodes(Vec residual, bool& admissible) {
  PetscFunctionBegin;
  constexpr int size = physics::ElectrodeJet<P>::size;
  const int rank = petsc::rank(comm_), ranks = petsc::size(comm_);
  if (energised_ == 0 || space_.choice.layers || !admissible) PetscFunctionReturn(PETSC_SUCCESS);
  double* block = values_.data() + first_electrode_value_;
  PetscCall(VecSetOption(residual, VEC_IGNORE_NEGATIVE_INDICES, PETSC_TRUE));
  for (std::size_t t = 0; t < tubes_.size(); ++t) {
    const AxisymBlock& body = space_.mesh.blocks[space_.tubes[t].block];
    const double A = body.inner[0], B = body.outer[0];
    const int layers = materials_.tube.layers;
    std::vector<double> shares;
    for (int k = 0; k <= layers; ++k) {
      const double along = double(k) / layers;
      shares.push_back(along * (2 * A + along * (B - A)) / (A + B));
    }
    for (std::size_t e = rank; P * e + P < tubes_[t].radius.size(); e += ranks, block += size * size) {
      physics::ContactEdge<P> inner, outer;
      for (int i = 0; i <= P; ++i) {
        inner.r[i] = tubes_[t].radius[P * e + i];
        inner.z[i] = tubes_[t].height[P * e + i];
        outer.r[i] = outer_faces_[t].radius[P * e + i];
        outer.z[i] = outer_faces_[t].height[P * e + i];
      }
      const auto energy =
          physics::electrode_energy<P>(energised_ * materials_.tube.permittivity, inner, outer, shares);
      admissible = admissible && std::isfinite(energy.value);
      energy_ += energy.value;
      for (int i = 0; i < size; ++i)
        for (int j = 0; j < size; ++j) block[i * size + j] = energy.second(i, j);
      PetscCall(
          VecSetValues(residual, size, unknowns_across(t, e).data(), energy.gradient.data(), ADD_VALUES));
    }
  }
  PetscCall(VecAssemblyBegin(residual));
  PetscCall(VecAssemblyEnd(residual));
  PetscFunctionReturn(PETSC_SUCCESS);
}

template <int P>
PetscErrorCode AxisymSystem<P>::add_spring(Vec residual) {
  PetscFunctionBegin;
  std::size_t place = first_spring_value_;
  const int rank = petsc::rank(comm_), ranks = petsc::size(comm_);
  for (std::size_t t = 0; t < tubes_.size(); ++t) {
    const auto& nodes = space_.tubes[t].nodes;
    for (std::size_t i = rank; i < nodes.size(); i += ranks, ++place) {
      if (spring_ == 0 || nodes[i].u_z < 0) continue;
      const double below = nodes[i].height - nodes[std::max<std::size_t>(i, 1) - 1].height;
      const double above = nodes[std::min(i + 1, nodes.size() - 1)].height - nodes[i].height;
      const double stiffness = spring_ * 0.5 * (below + above), slip = tubes_[t].height[i] - nodes[i].height;
      values_[place] = stiffness;
      energy_ += 0.5 * stiffness * slip * slip;
      PetscCall(VecSetValue(residual, nodes[i].u_z, stiffness * slip, ADD_VALUES));
    }
  }
  PetscCall(VecAssemblyBegin(residual));
  PetscCall(VecAssemblyEnd(residual));
  PetscFunctionReturn(PETSC_SUCCESS);
}

#define GAITER_LOADS(P)                                                \
  template PetscErrorCode AxisymSystem<P>::add_electrodes(Vec, bool&); \
  template PetscErrorCode AxisymSystem<P>::add_spring(Vec);
GAITER_LOADS(2)
GAITER_LOADS(3)
GAITER_LOADS(4)

}  // namespace gaiter::solvers
