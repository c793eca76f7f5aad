// SPDX-License-Identifier: BSD-2-Clause
// The part of an AxisymSystem that lives on the contact surfaces.
#include <algorithm>
#include <cmath>

#include "gaiter/petsc/check.hpp"
#include "gaiter/petsc/session.hpp"
#include "gaiter/solvers/axisym_system.hpp"

namespace gaiter::solvers {

namespace {

constexpr double contact_stiffness =
    10;  // c of the active set, over stress / length; only iterates depend on it

}  // namespace

template <int P>
physics::ContactJet<P> AxisymSystem<P>::segment_potential(int tube, const physics::ContactSegment& segment,
                                                          bool effective) const {
  physics::ContactEdge<P> tube_edge, leg_edge;
  for (int i = 0; i <= P; ++i) {
    tube_edge.r[i] = tubes_[tube].radius[P * segment.tube_edge + i];
    tube_edge.z[i] = tubes_[tube].height[P * segment.tube_edge + i];
    leg_edge.r[i] = leg_.radius[P * segment.leg_edge + i];
    leg_edge.z[i] = leg_.height[P * segment.leg_edge + i];
  }
  const SurfaceState& carrier = space_.choice.multipliers_on_tube ? tubes_[tube] : leg_;
  const int edge = space_.choice.multipliers_on_tube ? segment.tube_edge : segment.leg_edge;
  std::array<double, 2> multipliers{};
  for (int k = 0; k < 2; ++k) {
    const int node = P * (edge + k);
    multipliers[k] = effective && !carrier.active[node] ? 0 : carrier.multiplier[node];
  }
  return physics::contact_potential<P>(tube_edge, leg_edge, multipliers, space_.choice.multipliers_on_tube,
                                       segment);
}

// Every rank works all segments out, which are few, and adds its share of the pairs.
template <int P>
PetscErrorCode AxisymSystem<P>::add_contact(Vec residual, bool& admissible) {
  PetscFunctionBegin;
  const int leg_edges = static_cast<int>(leg_.height.size() - 1) / P;
  const auto vertices = [](const SurfaceState& state) {
    std::vector<double> heights;
    for (std::size_t i = 0; i < state.height.size(); i += P) heights.push_back(state.height[i]);
    return heights;
  };
  const std::vector<double> leg_vertices = vertices(leg_);
  std::vector<std::vector<physics::ContactSegment>> segments;
  bool listed = true;
  for (std::size_t t = 0; t < tubes_.size(); ++t) {
    segments.push_back(physics::pair_surfaces(vertices(tubes_[t]), leg_vertices));
    if (segments.back().empty()) admissible = false;
    for (const auto& s : segments.back())
      listed = listed && pair_at_[(first_tube_edge_[t] + s.tube_edge) * leg_edges + s.leg_edge] >= 0;
  }
  // The same on all ranks, which hold the same surfaces.
  if (!admissible) PetscFunctionReturn(PETSC_SUCCESS);
  if (!listed) PetscCall(preallocate());

  // Gap volumes G and hat areas, hence the active set.
  std::vector<SurfaceState*> carriers;
  if (space_.choice.multipliers_on_tube)
    for (SurfaceState& tube : tubes_) carriers.push_back(&tube);
  else
    carriers.push_back(&leg_);
  std::vector<std::vector<double>> area;
  for (SurfaceState* carrier : carriers) {
    std::fill(carrier->gap.begin(), carrier->gap.end(), 0.0);
    area.emplace_back(carrier->gap.size(), 0.0);
    for (std::size_t i = 0; i + P < carrier->height.size(); i += P)
      for (std::size_t vertex : {i, i + P})
        area.back()[vertex] += M_PI * carrier->radius[vertex] * (carrier->height[i + P] - carrier->height[i]);
  }
  std::vector<std::vector<physics::ContactJet<P>>> potentials(tubes_.size());
  for (std::size_t t = 0; t < tubes_.size(); ++t)
    for (const auto& segment : segments[t]) {
      const auto& potential =
          potentials[t].emplace_back(segment_potential(static_cast<int>(t), segment, false));
      const std::size_t c = space_.choice.multipliers_on_tube ? t : 0;
      const int edge = space_.choice.multipliers_on_tube ? segment.tube_edge : segment.leg_edge;
      for (int k = 0; k < 2; ++k) {
        carriers[c]->gap[P * (edge + k)] -= potential.gradient[4 * (P + 1) + k];
      }
    }
  active_changes_ = 0;
  for (std::size_t c = 0; c < carriers.size(); ++c)
    for (std::size_t i = 0; i < carriers[c]->gap.size(); i += P) {
      SurfaceState& carrier = *carriers[c];
      if (area[c][i] > 0) carrier.gap[i] /= area[c][i];
      const bool active = area[c][i] > 0 && carrier.multiplier[i] - contact_stiffness * carrier.gap[i] > 0;
      active_changes_ += active != carrier.active[i];
      carrier.active[i] = active;
    }

  const int rank = petsc::rank(comm_), ranks = petsc::size(comm_);
  for (std::size_t t = 0; t < tubes_.size(); ++t)
    for (std::size_t s = 0; s < segments[t].size(); ++s) {
      const physics::ContactSegment& segment = segments[t][s];
      const int pair = pair_at_[(first_tube_edge_[t] + segment.tube_edge) * leg_edges + segment.leg_edge];
      if (pair % ranks != rank) continue;
      const std::vector<PetscInt> unknowns = unknowns_of(pairs_[pair]);
      const SurfaceState& carrier = space_.choice.multipliers_on_tube ? tubes_[t] : leg_;
      const int edge = space_.choice.multipliers_on_tube ? segment.tube_edge : segment.leg_edge;
      // Only a multiplier that does not press changes what was worked out for the gaps.
      if (!carrier.active[P * edge] || !carrier.active[P * (edge + 1)])
        potentials[t][s] = segment_potential(static_cast<int>(t), segment, true);
      const physics::ContactJet<P>& potential = potentials[t][s];
      std::array<double, pair_unknowns> forces = potential.gradient;
      const auto silent = [&](int i) {
        return i >= 4 * (P + 1) && !carrier.active[P * (edge + i - 4 * (P + 1))];
      };
      double* block =
          values_.data() + cell_values_ + std::size_t(pair / ranks) * pair_unknowns * pair_unknowns;
      for (int i = 0; i < pair_unknowns; ++i) {
        if (silent(i)) forces[i] = 0;
        for (int j = 0; j < pair_unknowns; ++j)
          if (!silent(i) && !silent(j)) block[i * pair_unknowns + j] += potential.second(i, j);
      }
      energy_ += potential.value;
      PetscCall(VecSetOption(residual, VEC_IGNORE_NEGATIVE_INDICES, PETSC_TRUE));
      PetscCall(VecSetValues(residual, pair_unknowns, unknowns.data(), forces.data(), ADD_VALUES));
    }
  // Rows of the multipliers that press on nothing: - area lambda = 0.
  const std::size_t my_pairs = pairs_.size() > std::size_t(rank) ? (pairs_.size() - rank - 1) / ranks + 1 : 0;
  std::size_t place = cell_values_ + my_pairs * pair_unknowns * pair_unknowns;
  std::size_t node = 0;
  const auto silence = [&](const SurfaceState& state, const std::vector<double>* areas) -> PetscErrorCode {
    PetscFunctionBegin;
    for (std::size_t i = 0; i < state.height.size(); ++i, ++node) {
      if (static_cast<int>(node % ranks) != rank) continue;
      const PetscInt unknown = surface_unknowns_[3 * node + 2];
      if (unknown >= 0 && !state.active[i]) {
        const double weight = (*areas)[i] > 0 ? (*areas)[i] : 1;
        values_[place] = -weight;
        energy_ -= 0.5 * weight * state.multiplier[i] * state.multiplier[i];
        PetscCall(VecSetValue(residual, unknown, -weight * state.multiplier[i], ADD_VALUES));
      }
      ++place;
    }
    PetscFunctionReturn(PETSC_SUCCESS);
  };
  for (std::size_t t = 0; t < tubes_.size(); ++t)
    PetscCall(silence(tubes_[t], space_.choice.multipliers_on_tube ? &area[t] : nullptr));
  PetscCall(silence(leg_, space_.choice.multipliers_on_tube ? nullptr : &area[0]));
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

template physics::ContactJet<2> AxisymSystem<2>::segment_potential(int, const physics::ContactSegment&,
                                                                   bool) const;
template PetscErrorCode AxisymSystem<2>::add_contact(Vec, bool&);
template PetscErrorCode AxisymSystem<2>::add_spring(Vec);
template physics::ContactJet<3> AxisymSystem<3>::segment_potential(int, const physics::ContactSegment&,
                                                                   bool) const;
template PetscErrorCode AxisymSystem<3>::add_contact(Vec, bool&);
template PetscErrorCode AxisymSystem<3>::add_spring(Vec);
template physics::ContactJet<4> AxisymSystem<4>::segment_potential(int, const physics::ContactSegment&,
                                                                   bool) const;
template PetscErrorCode AxisymSystem<4>::add_contact(Vec, bool&);
template PetscErrorCode AxisymSystem<4>::add_spring(Vec);

}  // namespace gaiter::solvers
