// SPDX-License-Identifier: BSD-2-Clause
#include "gaiter/solvers/axisym_space.hpp"

#include <algorithm>
#include <array>

#include "gaiter/petsc/check.hpp"
#include "gaiter/petsc/session.hpp"
#include "gaiter/solvers/axisym_points.hpp"

namespace gaiter::solvers {

namespace {

using Section = petsc::Handle<PetscSection, PetscSectionDestroy>;

// What is fixed at the nodes of a point.
struct Fixed {
  bool u_r = false, u_z = false, potential = false;
};

}  // namespace

// Builds the space; a class so that its steps can share what they find.
template <int P>
class AxisymSpaceBuilder {
 public:
  explicit AxisymSpaceBuilder(AxisymSpace<P>& space) : space_(space) {}

  PetscErrorCode run(MPI_Comm comm) {
    PetscFunctionBegin;
    PetscCall(find_cell_points(space_.plex.get(), space_.mesh, points_));
    PetscCall(make_section(comm));
    PetscCall(number_unknowns());
    PetscCall(gather_surfaces(comm));
    PetscFunctionReturn(PETSC_SUCCESS);
  }

 private:
  using Element = physics::AxisymElement<P>;
  enum Field { displacement, pressure, multiplier, potential, fields };

  bool touches(const AxisymBlock& block, int column) const {
    return block.tube ? column == 0 : column == block.columns();
  }
  bool carries_multiplier(const AxisymBlock& block, int column) const {
    return block.tube == space_.choice.multipliers_on_tube && touches(block, column);
  }

  bool charged() const { return space_.choice.layers > 0; }
  // Number of the electrode, from inside, that a line between columns is; -1: none.
  int electrode(const AxisymBlock& block, int line) const {
    const int columns = block.columns() / space_.choice.layers;
    return line % columns == 0 ? line / columns : -1;
  }

  // Columns and rows of lines that a corner lies on; sides: k as in CellPoints.
  Fixed fixed_on(const AxisymBlock& block, bool bottom_or_top, bool inner, bool outer) const {
    const bool contact = block.tube ? inner : outer;
    return {!block.tube && inner, bottom_or_top || (space_.choice.held && contact)};
  }
  Fixed fixed_at_corner(const CellPoints& points, int corner) const {
    const AxisymBlock& block = space_.mesh.blocks[points.block];
    const int column = points.column + (corner == 1 || corner == 2), row = points.row + (corner >= 2);
    return fixed_on(block, row == 0 || row == block.rows(), column == 0, column == block.columns());
  }
  Fixed fixed_on_side(const CellPoints& points, int side) const {
    const AxisymBlock& block = space_.mesh.blocks[points.block];
    const bool bottom = side == 0 && points.row == 0, top = side == 2 && points.row + 1 == block.rows();
    return fixed_on(block, bottom || top, side == 3 && points.column == 0,
                    side == 1 && points.column + 1 == block.columns());
  }

  PetscErrorCode make_section(MPI_Comm comm) {
    PetscFunctionBegin;
    DM dm = space_.plex.get();
    PetscInt first = 0, last = 0;
    PetscCall(DMPlexGetChart(dm, &first, &last));
    PetscCall(PetscSectionCreate(comm, section_.out()));
    PetscSection section = section_.get();
    PetscCall(PetscSectionSetNumFields(section, fields));
    const std::array<const char*, fields> names{"displacement", "pressure", "multiplier", "potential"};
    for (int field = 0; field < fields; ++field)
      PetscCall(PetscSectionSetFieldName(section, field, names[field]));
    PetscCall(PetscSectionSetFieldComponents(section, displacement, 2));
    PetscCall(PetscSectionSetChart(section, first, last));

    std::vector<Fixed> fixed(last - first);
    const auto set = [&](PetscInt point, Field field, PetscInt count) -> PetscErrorCode {
      PetscFunctionBegin;
      PetscInt total = 0, others = 0;
      PetscCall(PetscSectionSetFieldDof(section, point, field, count));
      for (int f = 0; f < fields; ++f) {
        PetscCall(PetscSectionGetFieldDof(section, point, f, &others));
        total += others;
      }
      PetscCall(PetscSectionSetDof(section, point, total));
      PetscFunctionReturn(PETSC_SUCCESS);
    };
    for (const CellPoints& points : points_) {
      const AxisymBlock& block = space_.mesh.blocks[points.block];
      for (int c = 0; c < 4; ++c) {
        const Fixed corner = fixed_at_corner(points, c), side = fixed_on_side(points, c);
        PetscCall(set(points.corner[c], displacement, 2));
        if (carries_multiplier(block, points.column + (c == 1 || c == 2)))
          PetscCall(set(points.corner[c], multiplier, 1));
        PetscCall(set(points.side[c], displacement, 2 * (P - 1)));
        for (auto [point, of] : {std::pair{points.corner[c], corner}, std::pair{points.side[c], side}}) {
          fixed[point - first].u_r = fixed[point - first].u_r || of.u_r;
          fixed[point - first].u_z = fixed[point - first].u_z || of.u_z;
        }
      }
      PetscCall(set(points.cell, displacement, 2 * (P - 1) * (P - 1)));
      if (!block.tube) continue;
      PetscCall(set(points.cell, pressure, Element::pressures));
      if (!charged()) continue;
      for (int c = 0; c < 4; ++c) {
        PetscCall(set(points.corner[c], potential, 1));
        PetscCall(set(points.side[c], potential, P - 1));
        fixed[points.corner[c] - first].potential = electrode(block, points.column + (c == 1 || c == 2)) >= 0;
        if (c % 2 == 1)  // the sides along the rows, and so along the electrodes
          fixed[points.side[c] - first].potential = electrode(block, points.column + (c == 1)) >= 0;
      }
      PetscCall(set(points.cell, potential, (P - 1) * (P - 1)));
    }
    // Places of the fixed unknowns of a field at a point.
    const auto fixed_places = [&](PetscInt point, Field field) {
      std::vector<PetscInt> places;
      PetscInt count = 0;
      const Fixed& what = fixed[point - first];
      PetscCallAbort(PETSC_COMM_SELF, PetscSectionGetFieldDof(section, point, field, &count));
      for (PetscInt i = 0; i < count; ++i)
        if (field == potential ? what.potential : (i % 2 == 0 ? what.u_r : what.u_z)) places.push_back(i);
      return places;
    };
    for (PetscInt point = first; point < last; ++point) {
      PetscInt total = 0;
      for (Field field : {displacement, potential}) {
        const auto count = static_cast<PetscInt>(fixed_places(point, field).size());
        PetscCall(PetscSectionSetFieldConstraintDof(section, point, field, count));
        total += count;
      }
      PetscCall(PetscSectionSetConstraintDof(section, point, total));
    }
    PetscCall(PetscSectionSetUp(section));
    for (PetscInt point = first; point < last; ++point) {
      std::vector<PetscInt> all;
      PetscInt start = 0, offset = 0;
      PetscCall(PetscSectionGetOffset(section, point, &start));
      for (Field field : {displacement, potential}) {
        const std::vector<PetscInt> places = fixed_places(point, field);
        if (places.empty()) continue;
        PetscCall(PetscSectionGetFieldOffset(section, point, field, &offset));
        PetscCall(PetscSectionSetFieldConstraintIndices(section, point, field, places.data()));
        for (PetscInt place : places) all.push_back(offset - start + place);
      }
      if (!all.empty()) PetscCall(PetscSectionSetConstraintIndices(section, point, all.data()));
    }
    PetscCall(DMSetLocalSection(dm, section));
    PetscFunctionReturn(PETSC_SUCCESS);
  }

  // Places of one field of a point in the local Vec, and in the global Vec with -1 for fixed ones.
  PetscErrorCode places(PetscInt point, Field field, std::vector<PetscInt>& local,
                        std::vector<PetscInt>& global) const {
    PetscFunctionBegin;
    PetscSection overall = nullptr;
    PetscCall(DMGetGlobalSection(space_.plex.get(), &overall));
    PetscInt count = 0, offset = 0, point_offset = 0, start = 0, fixed_count = 0;
    const PetscInt* fixed = nullptr;
    PetscCall(PetscSectionGetFieldDof(section_.get(), point, field, &count));
    PetscCall(PetscSectionGetFieldOffset(section_.get(), point, field, &offset));
    PetscCall(PetscSectionGetOffset(section_.get(), point, &point_offset));
    PetscCall(PetscSectionGetOffset(overall, point, &start));
    PetscCall(PetscSectionGetConstraintDof(section_.get(), point, &fixed_count));
    if (fixed_count > 0) PetscCall(PetscSectionGetConstraintIndices(section_.get(), point, &fixed));
    if (start < 0) start = -(start + 1);  // owned by another rank
    local.clear();
    global.clear();
    for (PetscInt i = 0; i < count; ++i) {
      const PetscInt place = offset - point_offset + i;
      const auto before = std::count_if(fixed, fixed + fixed_count, [&](PetscInt f) { return f < place; });
      const bool is_fixed = std::find(fixed, fixed + fixed_count, place) != fixed + fixed_count;
      local.push_back(offset + i);
      global.push_back(is_fixed ? -1 : start + place - static_cast<PetscInt>(before));
    }
    PetscFunctionReturn(PETSC_SUCCESS);
  }

  // Gives the nodes of a cell their `each` unknowns of a field, from place `first` of the cell's list on.
  PetscErrorCode number_nodes(const CellPoints& points, Field field, int each, int first,
                              AxisymCell<P>& cell) const {
    PetscFunctionBegin;
    std::vector<PetscInt> local, global;
    const auto put = [&](int i, int j, int from) {
      const int node = i + (P + 1) * j;
      for (int k = 0; k < each; ++k) {
        cell.local[first + each * node + k] = local[each * from + k];
        cell.global[first + each * node + k] = global[each * from + k];
      }
    };
    constexpr std::array<std::array<int, 2>, 4> corner_node{{{0, 0}, {P, 0}, {P, P}, {0, P}}};
    for (int c = 0; c < 4; ++c) {
      PetscCall(places(points.corner[c], field, local, global));
      put(corner_node[c][0], corner_node[c][1], 0);
      PetscCall(places(points.side[c], field, local, global));
      for (int k = 1; k < P; ++k) {
        const int along = points.reversed[c] ? P - k : k;
        const std::array<std::array<int, 2>, 4> node{{{along, 0}, {P, along}, {along, P}, {0, along}}};
        put(node[c][0], node[c][1], k - 1);
      }
    }
    PetscCall(places(points.cell, field, local, global));
    for (int j = 1; j < P; ++j)
      for (int i = 1; i < P; ++i) put(i, j, (i - 1) + (P - 1) * (j - 1));
    PetscFunctionReturn(PETSC_SUCCESS);
  }

  PetscErrorCode number_unknowns() {
    PetscFunctionBegin;
    std::vector<PetscInt> local, global;
    for (const CellPoints& points : points_) {
      const AxisymBlock& block = space_.mesh.blocks[points.block];
      AxisymCell<P> cell{points.block, points.column,
                         points.row,   Element::geometry(block.corners(points.column, points.row)),
                         {},           {}};
      cell.local.resize(!block.tube ? Element::leg_unknowns
                        : charged() ? Element::charged_unknowns
                                    : Element::tube_unknowns);
      cell.global.resize(cell.local.size());
      PetscCall(number_nodes(points, displacement, 2, 0, cell));
      if (block.tube) {
        PetscCall(places(points.cell, pressure, local, global));
        std::copy(local.begin(), local.end(), cell.local.begin() + 2 * Element::nodes);
        std::copy(global.begin(), global.end(), cell.global.begin() + 2 * Element::nodes);
      }
      if (block.tube && charged()) {
        PetscCall(number_nodes(points, potential, 1, Element::tube_unknowns, cell));
        for (int node = 0; node < Element::nodes; ++node) {
          const int column = node % (P + 1);
          const int line = column == 0 ? points.column : column == P ? points.column + 1 : -1;
          if (line < 0 || electrode(block, line) < 0) continue;
          const double value = electrode(block, line) % 2;
          space_.electrodes.emplace_back(cell.local[Element::tube_unknowns + node], value);
        }
      }
      space_.cells.push_back(std::move(cell));
    }
    PetscFunctionReturn(PETSC_SUCCESS);
  }

  // Every rank tells what its cells know of the contact surfaces: block, place along the surface, global
  // unknowns.
  PetscErrorCode gather_surfaces(MPI_Comm comm) {
    PetscFunctionBegin;
    constexpr int record = 5;  // block, place, u_r, u_z, multiplier
    std::vector<PetscInt> mine, local, global;
    for (std::size_t c = 0; c < points_.size(); ++c) {
      const AxisymCell<P>& cell = space_.cells[c];
      const AxisymBlock& block = space_.mesh.blocks[cell.block];
      const int column = block.tube ? 0 : P;
      if (!touches(block, cell.column + (block.tube ? 0 : 1))) continue;
      for (int j = 0; j <= P; ++j) {
        const int node = column + (P + 1) * j;
        PetscInt carried = -1;
        if ((j == 0 || j == P) && block.tube == space_.choice.multipliers_on_tube) {
          const int corner = block.tube ? (j == 0 ? 0 : 3) : (j == 0 ? 1 : 2);
          PetscCall(places(points_[c].corner[corner], multiplier, local, global));
          carried = global[0];
        }
        for (PetscInt value : {PetscInt(cell.block), PetscInt(P * cell.row + j), cell.global[2 * node],
                               cell.global[2 * node + 1], carried})
          mine.push_back(value);
      }
    }
    const int ranks = petsc::size(comm), count = static_cast<int>(mine.size());
    std::vector<int> counts(ranks), offsets(ranks + 1, 0);
    PetscCallMPI(MPI_Allgather(&count, 1, MPI_INT, counts.data(), 1, MPI_INT, comm));
    for (int r = 0; r < ranks; ++r) offsets[r + 1] = offsets[r] + counts[r];
    std::vector<PetscInt> all(offsets[ranks]);
    PetscCallMPI(MPI_Allgatherv(mine.data(), count, MPIU_INT, all.data(), counts.data(), offsets.data(),
                                MPIU_INT, comm));

    const auto& lobatto = physics::lobatto_points<P>();
    for (std::size_t b = 0; b < space_.mesh.blocks.size(); ++b) {
      const AxisymBlock& block = space_.mesh.blocks[b];
      ContactSurface surface{static_cast<int>(b), std::vector<SurfaceNode>(P * block.rows() + 1)};
      const std::vector<double>& radius = block.tube ? block.inner : block.outer;
      for (int place = 0; place <= P * block.rows(); ++place) {
        const int row = std::min(place / P, block.rows() - 1);
        const double along = lobatto[place - P * row];
        surface.nodes[place].radius = radius[row] + along * (radius[row + 1] - radius[row]);
        surface.nodes[place].height = block.height[row] + along * (block.height[row + 1] - block.height[row]);
      }
      (block.tube ? space_.tubes.emplace_back() : space_.leg) = std::move(surface);
    }
    for (std::size_t k = 0; k < all.size(); k += record) {
      const auto block = static_cast<std::size_t>(all[k]);
      ContactSurface& surface = space_.mesh.blocks[block].tube ? space_.tubes[block] : space_.leg;
      SurfaceNode& node = surface.nodes[all[k + 1]];
      node.u_r = all[k + 2];
      node.u_z = all[k + 3];
      node.multiplier = std::max(node.multiplier, all[k + 4]);
    }
    for (const AxisymBlock& block : space_.mesh.blocks) {
      if (block.tube) space_.pressures += block.columns() * block.rows() * Element::pressures;
      if (block.tube == space_.choice.multipliers_on_tube) space_.multipliers += block.rows() + 1;
      if (block.tube && charged())
        space_.potentials += (P * block.columns() - space_.choice.layers) * (P * block.rows() + 1);
    }
    PetscFunctionReturn(PETSC_SUCCESS);
  }

  AxisymSpace<P>& space_;
  std::vector<CellPoints> points_;
  Section section_;
};

template <int P>
AxisymSpace<P> AxisymSpace<P>::make(MPI_Comm comm, AxisymMesh mesh, const SpaceChoice& choice) {
  AxisymSpace space;
  space.mesh = std::move(mesh);
  space.plex = make_plex(comm, space.mesh);
  space.choice = choice;
  petsc::check(AxisymSpaceBuilder<P>(space).run(comm));
  return space;
}

template struct AxisymSpace<2>;
template struct AxisymSpace<3>;
template struct AxisymSpace<4>;

}  // namespace gaiter::solvers
