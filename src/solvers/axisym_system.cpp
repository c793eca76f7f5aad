// SPDX-License-Identifier: BSD-2-Clause
#include "gaiter/solvers/axisym_system.hpp"

#include <algorithm>
#include <cmath>

#include "gaiter/petsc/check.hpp"
#include "gaiter/petsc/session.hpp"
#include "gaiter/solvers/axisym_events.hpp"

namespace gaiter::solvers {

namespace {

constexpr double window =
    0.15;  // how far apart in height the edges of a pair may be, over the unit of length

}  // namespace

template <int P>
AxisymSystem<P>::AxisymSystem(MPI_Comm comm, AxisymSpace<P> space, AxisymMaterials materials)
    : comm_(comm), space_(std::move(space)), materials_(std::move(materials)) {
  petsc::check(create());
}

template <int P>
PetscErrorCode AxisymSystem<P>::create() {
  PetscFunctionBegin;
  DM dm = space_.plex.get();
  PetscCall(DMCreateLocalVector(dm, local_x_.out()));
  PetscCall(DMCreateLocalVector(dm, local_residual_.out()));

  // Surface values: u_r, u_z and multiplier of each node of the tubes, then of the leg, on every rank.
  const auto list = [&](const ContactSurface& surface) {
    for (const SurfaceNode& node : surface.nodes)
      for (PetscInt unknown : {node.u_r, node.u_z, node.multiplier}) surface_unknowns_.push_back(unknown);
  };
  first_tube_edge_.push_back(0);
  for (const ContactSurface& tube : space_.tubes) {
    list(tube);
    first_tube_edge_.push_back(first_tube_edge_.back() + static_cast<int>(tube.nodes.size() - 1) / P);
  }
  list(space_.leg);
  std::vector<PetscInt> free;
  for (PetscInt unknown : surface_unknowns_)
    if (unknown >= 0) free.push_back(unknown);
  Vec global = nullptr;
  PetscCall(DMCreateGlobalVector(dm, &global));
  petsc::Vector whole(global);
  petsc::Handle<IS, ISDestroy> from;
  PetscCall(ISCreateGeneral(PETSC_COMM_SELF, static_cast<PetscInt>(free.size()), free.data(),
                            PETSC_COPY_VALUES, from.out()));
  PetscCall(VecCreateSeq(PETSC_COMM_SELF, static_cast<PetscInt>(free.size()), surface_values_.out()));
  PetscCall(VecScatterCreate(global, from.get(), surface_values_.get(), nullptr, scatter_.out()));

  PetscInt size = 0;
  PetscCall(VecGetLocalSize(global, &size));
  PetscCall(MatCreate(comm_, matrix_.out()));
  PetscCall(MatSetOptionsPrefix(matrix_.get(), "axisym_"));
  PetscCall(MatSetSizes(matrix_.get(), size, size, PETSC_DETERMINE, PETSC_DETERMINE));
  PetscCall(MatSetType(matrix_.get(), MATAIJ));
  PetscCall(MatSetFromOptions(matrix_.get()));
  PetscCall(MatSetOption(matrix_.get(), MAT_SYMMETRIC, PETSC_TRUE));
  PetscCall(MatSetOption(matrix_.get(), MAT_SYMMETRY_ETERNAL, PETSC_TRUE));

  // Pairs are listed from the current heights; at first those of the reference.
  const auto rest = [](const ContactSurface& surface) {
    SurfaceState state;
    for (const SurfaceNode& node : surface.nodes) {
      state.radius.push_back(node.radius);
      state.height.push_back(node.height);
    }
    state.multiplier.assign(surface.nodes.size(), 0);
    state.gap.assign(surface.nodes.size(), 0);
    state.active.assign(surface.nodes.size(), true);
    return state;
  };
  for (const ContactSurface& tube : space_.tubes) tubes_.push_back(rest(tube));
  leg_ = rest(space_.leg);
  PetscCall(preallocate());
  PetscFunctionReturn(PETSC_SUCCESS);
}

template <int P>
void AxisymSystem<P>::list_pairs() {
  pairs_.clear();
  const int leg_edges = static_cast<int>(leg_.height.size() - 1) / P;
  pair_at_.assign(static_cast<std::size_t>(first_tube_edge_.back()) * leg_edges, -1);
  for (std::size_t t = 0; t < tubes_.size(); ++t)
    for (int e = 0; e < first_tube_edge_[t + 1] - first_tube_edge_[t]; ++e)
      for (int f = 0; f < leg_edges; ++f) {
        const double above = tubes_[t].height[P * e] - leg_.height[P * (f + 1)];
        const double below = leg_.height[P * f] - tubes_[t].height[P * (e + 1)];
        if (above > window || below > window) continue;
        pair_at_[(first_tube_edge_[t] + e) * leg_edges + f] = static_cast<int>(pairs_.size());
        pairs_.push_back({static_cast<int>(t), e, f});
      }
}

template <int P>
std::vector<PetscInt> AxisymSystem<P>::unknowns_of(const Pair& pair) const {
  std::vector<PetscInt> unknowns;
  const auto& tube = space_.tubes[pair.tube].nodes;
  const auto& leg = space_.leg.nodes;
  for (int i = 0; i <= P; ++i) unknowns.push_back(tube[P * pair.tube_edge + i].u_r);
  for (int i = 0; i <= P; ++i) unknowns.push_back(tube[P * pair.tube_edge + i].u_z);
  for (int i = 0; i <= P; ++i) unknowns.push_back(leg[P * pair.leg_edge + i].u_r);
  for (int i = 0; i <= P; ++i) unknowns.push_back(leg[P * pair.leg_edge + i].u_z);
  const auto& carrier = space_.choice.multipliers_on_tube ? tube : leg;
  const int edge = space_.choice.multipliers_on_tube ? pair.tube_edge : pair.leg_edge;
  unknowns.push_back(carrier[P * edge].multiplier);
  unknowns.push_back(carrier[P * (edge + 1)].multiplier);
  return unknowns;
}

// The tangent's pattern: blocks of this rank's cells, then its share of the blocks of the pairs, of the
// diagonals of the multipliers and of the springs, in this order in values_.
template <int P>
PetscErrorCode AxisymSystem<P>::preallocate() {
  PetscFunctionBegin;
  ++pattern_;
  list_pairs();
  std::vector<PetscInt> rows, columns;
  const auto add_block = [&](const std::vector<PetscInt>& unknowns) {
    for (PetscInt row : unknowns)
      for (PetscInt column : unknowns) {
        rows.push_back(column < 0 ? -1 : row);
        columns.push_back(row < 0 ? -1 : column);
      }
  };
  for (const AxisymCell<P>& cell : space_.cells) add_block(cell.global);
  cell_values_ = rows.size();
  const int rank = petsc::rank(comm_), ranks = petsc::size(comm_);
  for (std::size_t k = rank; k < pairs_.size(); k += ranks) add_block(unknowns_of(pairs_[k]));
  for (std::size_t k = 2; k < surface_unknowns_.size(); k += 3)
    if (static_cast<int>(k / 3 % ranks) == rank) {
      rows.push_back(surface_unknowns_[k]);
      columns.push_back(surface_unknowns_[k]);
    }
  first_spring_value_ = rows.size();
  for (const ContactSurface& tube : space_.tubes)
    for (std::size_t i = rank; i < tube.nodes.size(); i += ranks) {
      rows.push_back(tube.nodes[i].u_z);
      columns.push_back(tube.nodes[i].u_z);
    }
  values_.assign(rows.size(), 0);
  PetscCall(MatSetPreallocationCOO(matrix_.get(), static_cast<PetscCount>(rows.size()), rows.data(),
                                   columns.data()));
  PetscFunctionReturn(PETSC_SUCCESS);
}

template <int P>
PetscErrorCode AxisymSystem<P>::read_surfaces(Vec x) {
  PetscFunctionBegin;
  PetscCall(VecScatterBegin(scatter_.get(), x, surface_values_.get(), INSERT_VALUES, SCATTER_FORWARD));
  PetscCall(VecScatterEnd(scatter_.get(), x, surface_values_.get(), INSERT_VALUES, SCATTER_FORWARD));
  const PetscScalar* values = nullptr;
  PetscCall(VecGetArrayRead(surface_values_.get(), &values));
  std::size_t unknown = 0, place = 0;
  const auto next = [&] { return surface_unknowns_[unknown++] >= 0 ? values[place++] : 0.0; };
  const auto read = [&](const ContactSurface& surface, SurfaceState& state) {
    for (std::size_t i = 0; i < surface.nodes.size(); ++i) {
      state.radius[i] = surface.nodes[i].radius + next();
      state.height[i] = surface.nodes[i].height + next();
      state.multiplier[i] = next();
    }
  };
  for (std::size_t t = 0; t < tubes_.size(); ++t) read(space_.tubes[t], tubes_[t]);
  read(space_.leg, leg_);
  PetscCall(VecRestoreArrayRead(surface_values_.get(), &values));
  PetscFunctionReturn(PETSC_SUCCESS);
}

template <int P>
PetscErrorCode AxisymSystem<P>::evaluate(Vec x, Vec residual, bool& admissible) {
  PetscFunctionBegin;
  admissible = true;
  energy_ = 0;
  PetscCall(VecSet(residual, 0));
  PetscCall(read_surfaces(x));
  std::fill(values_.begin(), values_.end(), 0.0);
  PetscCall(PetscLogEventBegin(axisym_events().contact, 0, 0, 0, 0));
  PetscCall(add_contact(residual, admissible));
  PetscCall(PetscLogEventEnd(axisym_events().contact, 0, 0, 0, 0));
  PetscCall(add_spring(residual));
  PetscCall(PetscLogEventBegin(axisym_events().cells, 0, 0, 0, 0));
  PetscCall(add_cells(x, residual, admissible));
  PetscCall(PetscLogEventEnd(axisym_events().cells, 0, 0, 0, 0));
  admissible = petsc::agree(comm_, admissible);
  PetscFunctionReturn(PETSC_SUCCESS);
}

template <int P>
PetscErrorCode AxisymSystem<P>::assemble() {
  PetscFunctionBegin;
  PetscCall(MatSetValuesCOO(matrix_.get(), values_.data(), INSERT_VALUES));
  PetscFunctionReturn(PETSC_SUCCESS);
}

template <int P>
PetscErrorCode AxisymSystem<P>::fill_local(Vec x, Vec local) const {
  PetscFunctionBegin;
  PetscCall(VecSet(local, 0));
  PetscCall(DMGlobalToLocal(space_.plex.get(), x, INSERT_VALUES, local));
  PetscScalar* values = nullptr;
  PetscCall(VecGetArray(local, &values));
  for (const auto& [place, potential] : space_.electrodes) values[place] = potential;
  PetscCall(VecRestoreArray(local, &values));
  PetscFunctionReturn(PETSC_SUCCESS);
}

template <int P>
double AxisymSystem<P>::energy() const {
  return petsc::sum(comm_, energy_);
}

template <int P>
PetscErrorCode AxisymSystem<P>::add_cells(Vec x, Vec residual, bool& admissible) {
  PetscFunctionBegin;
  DM dm = space_.plex.get();
  PetscCall(fill_local(x, local_x_.get()));
  PetscCall(VecSet(local_residual_.get(), 0));
  const PetscScalar* in = nullptr;
  PetscScalar* out = nullptr;
  PetscCall(VecGetArrayRead(local_x_.get(), &in));
  PetscCall(VecGetArray(local_residual_.get(), &out));
  std::array<double, Element::charged_unknowns> unknowns, forces;
  double* tangent = values_.data();
  for (std::size_t c = 0; admissible && c < space_.cells.size(); ++c) {
    const AxisymCell<P>& cell = space_.cells[c];
    const AxisymBlock& block = space_.mesh.blocks[cell.block];
    for (std::size_t i = 0; i < cell.local.size(); ++i) unknowns[i] = in[cell.local[i]];
    double energy = 0;
    bool fine = false;
    if (!block.tube)
      fine = Element::leg(cell.geometry, materials_.leg[block.segment[cell.row]], unknowns.data(), energy,
                          forces.data(), tangent);
    else if (space_.choice.layers)
      fine = Element::charged_tube(cell.geometry, materials_.tubes[cell.block], field(block), unknowns.data(),
                                   energy, forces.data(), tangent);
    else
      fine = Element::tube(cell.geometry, materials_.tubes[cell.block], field(block), unknowns.data(), energy,
                           forces.data(), tangent);
    admissible = admissible && fine;
    energy_ += energy;
    for (std::size_t i = 0; i < cell.local.size(); ++i) out[cell.local[i]] += forces[i];
    tangent += cell.local.size() * cell.local.size();
  }
  PetscCall(VecRestoreArray(local_residual_.get(), &out));
  PetscCall(VecRestoreArrayRead(local_x_.get(), &in));
  PetscCall(DMLocalToGlobal(dm, local_residual_.get(), ADD_VALUES, residual));
  PetscFunctionReturn(PETSC_SUCCESS);
}

template <int P>
PetscErrorCode AxisymSystem<P>::largest_displacement(Vec direction, double& largest) const {
  PetscFunctionBegin;
  DM dm = space_.plex.get();
  petsc::Vector local;
  PetscCall(VecDuplicate(local_x_.get(), local.out()));
  PetscCall(VecSet(local.get(), 0));
  PetscCall(DMGlobalToLocal(dm, direction, INSERT_VALUES, local.get()));
  const PetscScalar* values = nullptr;
  PetscCall(VecGetArrayRead(local.get(), &values));
  largest = 0;
  for (const AxisymCell<P>& cell : space_.cells)
    for (int i = 0; i < 2 * Element::nodes; ++i)
      largest = std::max(largest, std::fabs(values[cell.local[i]]));
  PetscCall(VecRestoreArrayRead(local.get(), &values));
  largest = petsc::largest(comm_, largest);
  PetscFunctionReturn(PETSC_SUCCESS);
}

template class AxisymSystem<2>;
template class AxisymSystem<3>;
template class AxisymSystem<4>;

}  // namespace gaiter::solvers
