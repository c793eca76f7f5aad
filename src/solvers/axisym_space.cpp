// SPDX-License-Identifier: BSD-2-Clause
#include "gaiter/solvers/axisym_space.hpp"

#include <algorithm>
#include <array>

#include "gaiter/petsc/check.hpp"
#include "gaiter/petsc/session.hpp"

namespace gaiter::solvers {

namespace {

using Section = petsc::Handle<PetscSection, PetscSectionDestroy>;

// A cell's points of the DMPlex: itself, its corners counterclockwise from the lower inner one, and its
// sides, the first between corners 0 and 1. `reversed`: the side's own direction is against the growing local
// coordinate.
struct CellPoints {
  PetscInt cell = 0;
  int block = 0, column = 0, row = 0;
  std::array<PetscInt, 4> corner{}, side{};
  std::array<bool, 4> reversed{};
};

PetscErrorCode number_in_mesh(DM dm, const char* label, PetscInt first, PetscInt point, PetscInt* number) {
  PetscFunctionBegin;
  DMLabel numbers = nullptr;
  PetscCall(DMGetLabel(dm, label, &numbers));
  if (numbers)
    PetscCall(DMLabelGetValue(numbers, point, number));
  else
    *number = point - first;
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode find_points(DM dm, const AxisymMesh& mesh, PetscInt cell, PetscInt first_cell,
                           PetscInt first_vertex, PetscInt last_vertex, CellPoints& points) {
  PetscFunctionBegin;
  PetscInt number = 0;
  PetscCall(number_in_mesh(dm, "cell", first_cell, cell, &number));
  points.cell = cell;
  while (points.block + 1 < static_cast<int>(mesh.blocks.size()) &&
         mesh.blocks[points.block + 1].first_cell <= number)
    ++points.block;
  const AxisymBlock& block = mesh.blocks[points.block];
  points.column = (number - block.first_cell) % block.columns();
  points.row = (number - block.first_cell) / block.columns();
  const std::array<int, 4> corners{
      block.vertex(points.column, points.row), block.vertex(points.column + 1, points.row),
      block.vertex(points.column + 1, points.row + 1), block.vertex(points.column, points.row + 1)};

  PetscInt size = 0, *closure = nullptr;
  std::array<PetscInt, 4> sides{};
  int side_count = 0;
  PetscCall(DMPlexGetTransitiveClosure(dm, cell, PETSC_TRUE, &size, &closure));
  for (PetscInt k = 1; k < size; ++k) {
    const PetscInt point = closure[2 * k];
    if (point >= first_vertex && point < last_vertex) {
      PetscCall(number_in_mesh(dm, "vertex", first_vertex, point, &number));
      for (int c = 0; c < 4; ++c)
        if (corners[c] == number) points.corner[c] = point;
    } else if (side_count < 4) {
      sides[side_count++] = point;
    }
  }
  PetscCall(DMPlexRestoreTransitiveClosure(dm, cell, PETSC_TRUE, &size, &closure));
  // Sides 0 and 2 run along the columns, 1 and 3 along the rows; from and to in the sense of the local
  // coordinates.
  constexpr std::array<std::array<int, 2>, 4> ends{{{0, 1}, {1, 2}, {3, 2}, {0, 3}}};
  for (PetscInt side : sides) {
    const PetscInt* cone = nullptr;
    PetscCall(DMPlexGetCone(dm, side, &cone));
    for (int k = 0; k < 4; ++k) {
      const PetscInt from = points.corner[ends[k][0]], to = points.corner[ends[k][1]];
      if ((cone[0] == from && cone[1] == to) || (cone[0] == to && cone[1] == from)) {
        points.side[k] = side;
        points.reversed[k] = cone[0] == to;
      }
    }
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

// What is fixed at the nodes of a point: bit 0 u_r, bit 1 u_z.
struct Fixed {
  bool u_r = false, u_z = false;
};

}  // namespace

// Builds the space; a class so that its steps can share what they find.
template <int P>
class AxisymSpaceBuilder {
 public:
  AxisymSpaceBuilder(AxisymSpace<P>& space, bool held) : space_(space), held_(held) {}

  PetscErrorCode run(MPI_Comm comm) {
    PetscFunctionBegin;
    PetscCall(collect_points());
    PetscCall(make_section(comm));
    PetscCall(number_unknowns());
    PetscCall(gather_surfaces(comm));
    PetscFunctionReturn(PETSC_SUCCESS);
  }

 private:
  using Element = physics::AxisymElement<P>;
  enum Field { displacement, pressure, multiplier, fields };

  bool touches(const AxisymBlock& block, int column) const {
    return block.tube ? column == 0 : column == block.columns();
  }
  bool carries_multiplier(const AxisymBlock& block, int column) const {
    return block.tube == space_.multipliers_on_tube && touches(block, column);
  }

  PetscErrorCode collect_points() {
    PetscFunctionBegin;
    DM dm = space_.plex.get();
    PetscInt first = 0, last = 0, first_vertex = 0, last_vertex = 0;
    PetscCall(DMPlexGetHeightStratum(dm, 0, &first, &last));
    PetscCall(DMPlexGetDepthStratum(dm, 0, &first_vertex, &last_vertex));
    points_.resize(last - first);
    for (PetscInt cell = first; cell < last; ++cell)
      PetscCall(find_points(dm, space_.mesh, cell, first, first_vertex, last_vertex, points_[cell - first]));
    PetscFunctionReturn(PETSC_SUCCESS);
  }

  // Columns and rows of lines that a corner lies on; sides: k as in CellPoints.
  Fixed fixed_on(const AxisymBlock& block, bool bottom_or_top, bool inner, bool outer) const {
    const bool contact = block.tube ? inner : outer;
    return {!block.tube && inner, bottom_or_top || (held_ && contact)};
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
    const std::array<const char*, fields> names{"displacement", "pressure", "multiplier"};
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
      if (block.tube) PetscCall(set(points.cell, pressure, Element::pressures));
    }
    const auto fixed_places = [&](PetscInt point) {
      std::vector<PetscInt> places;
      PetscInt count = 0;
      PetscCallAbort(PETSC_COMM_SELF, PetscSectionGetFieldDof(section, point, displacement, &count));
      for (PetscInt i = 0; i < count; ++i)
        if (i % 2 == 0 ? fixed[point - first].u_r : fixed[point - first].u_z) places.push_back(i);
      return places;
    };
    for (PetscInt point = first; point < last; ++point) {
      const auto count = static_cast<PetscInt>(fixed_places(point).size());
      PetscCall(PetscSectionSetConstraintDof(section, point, count));
      PetscCall(PetscSectionSetFieldConstraintDof(section, point, displacement, count));
    }
    PetscCall(PetscSectionSetUp(section));
    for (PetscInt point = first; point < last; ++point) {
      const std::vector<PetscInt> places = fixed_places(point);
      if (places.empty()) continue;
      // The displacement comes first at every point, so that field and point places are the same.
      PetscCall(PetscSectionSetConstraintIndices(section, point, places.data()));
      PetscCall(PetscSectionSetFieldConstraintIndices(section, point, displacement, places.data()));
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

  // Puts two unknowns a node, from place `from` on, to node (i, j) of a cell.
  static void put(AxisymCell<P>& cell, int i, int j, int from, const std::vector<PetscInt>& local,
                  const std::vector<PetscInt>& global) {
    const int node = i + (P + 1) * j;
    for (int k = 0; k < 2; ++k) {
      cell.local[2 * node + k] = local[from + k];
      cell.global[2 * node + k] = global[from + k];
    }
  }

  PetscErrorCode number_unknowns() {
    PetscFunctionBegin;
    std::vector<PetscInt> local, global;
    for (const CellPoints& points : points_) {
      const AxisymBlock& block = space_.mesh.blocks[points.block];
      AxisymCell<P> cell{points.block, points.column,
                         points.row,   Element::geometry(block.corners(points.column, points.row)),
                         {},           {}};
      cell.local.resize(block.tube ? Element::tube_unknowns : Element::leg_unknowns);
      cell.global.resize(cell.local.size());
      constexpr std::array<std::array<int, 2>, 4> corner_node{{{0, 0}, {P, 0}, {P, P}, {0, P}}};
      for (int c = 0; c < 4; ++c) {
        PetscCall(places(points.corner[c], displacement, local, global));
        put(cell, corner_node[c][0], corner_node[c][1], 0, local, global);
        PetscCall(places(points.side[c], displacement, local, global));
        for (int k = 1; k < P; ++k) {
          const int along = points.reversed[c] ? P - k : k;
          const std::array<std::array<int, 2>, 4> node{{{along, 0}, {P, along}, {along, P}, {0, along}}};
          put(cell, node[c][0], node[c][1], 2 * (k - 1), local, global);
        }
      }
      PetscCall(places(points.cell, displacement, local, global));
      for (int j = 1; j < P; ++j)
        for (int i = 1; i < P; ++i) put(cell, i, j, 2 * ((i - 1) + (P - 1) * (j - 1)), local, global);
      if (block.tube) {
        PetscCall(places(points.cell, pressure, local, global));
        std::copy(local.begin(), local.end(), cell.local.begin() + 2 * Element::nodes);
        std::copy(global.begin(), global.end(), cell.global.begin() + 2 * Element::nodes);
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
        if ((j == 0 || j == P) && block.tube == space_.multipliers_on_tube) {
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
      if (block.tube == space_.multipliers_on_tube) space_.multipliers += block.rows() + 1;
    }
    PetscFunctionReturn(PETSC_SUCCESS);
  }

  AxisymSpace<P>& space_;
  bool held_;
  std::vector<CellPoints> points_;
  Section section_;
};

template <int P>
AxisymSpace<P> AxisymSpace<P>::make(MPI_Comm comm, AxisymMesh mesh, bool multipliers_on_tube, bool held) {
  AxisymSpace space;
  space.mesh = std::move(mesh);
  space.plex = make_plex(comm, space.mesh);
  space.multipliers_on_tube = multipliers_on_tube;
  petsc::check(AxisymSpaceBuilder<P>(space, held).run(comm));
  return space;
}

template struct AxisymSpace<2>;
template struct AxisymSpace<3>;
template struct AxisymSpace<4>;

}  // namespace gaiter::solvers
