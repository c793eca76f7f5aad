// SPDX-License-Identifier: BSD-2-Clause
#include "gaiter/solvers/axisym_prolong.hpp"

#include <algorithm>
#include <array>

#include "gaiter/petsc/check.hpp"
#include "gaiter/petsc/session.hpp"

namespace gaiter::solvers {

namespace {

// The unknowns of all cells on every rank, fixed ones included: those of cell c from c * stride on.
template <int P>
PetscErrorCode gather_cells(const AxisymSystem<P>& system, Vec x, std::vector<double>& values) {
  PetscFunctionBegin;
  constexpr std::size_t stride = physics::AxisymElement<P>::charged_unknowns, record = stride + 1;
  const AxisymSpace<P>& space = system.space();
  petsc::Vector local;
  PetscCall(DMCreateLocalVector(space.plex.get(), local.out()));
  PetscCall(system.fill_local(x, local.get()));
  const PetscScalar* in = nullptr;
  PetscCall(VecGetArrayRead(local.get(), &in));
  std::vector<double> mine;
  for (const AxisymCell<P>& cell : space.cells) {
    mine.push_back(space.mesh.blocks[cell.block].cell(cell.column, cell.row));
    for (PetscInt place : cell.local) mine.push_back(in[place]);
    mine.resize((mine.size() + record - 1) / record * record, 0.0);
  }
  PetscCall(VecRestoreArrayRead(local.get(), &in));
  const int ranks = petsc::size(system.comm()), count = static_cast<int>(mine.size());
  std::vector<int> counts(ranks), offsets(ranks + 1, 0);
  PetscCallMPI(MPI_Allgather(&count, 1, MPI_INT, counts.data(), 1, MPI_INT, system.comm()));
  for (int rank = 0; rank < ranks; ++rank) offsets[rank + 1] = offsets[rank] + counts[rank];
  std::vector<double> all(offsets[ranks]);
  PetscCallMPI(MPI_Allgatherv(mine.data(), count, MPI_DOUBLE, all.data(), counts.data(), offsets.data(),
                              MPI_DOUBLE, system.comm()));
  values.resize(space.mesh.cells * stride);
  for (std::size_t k = 0; k < all.size(); k += record)
    std::copy_n(all.begin() + k + 1, stride, values.begin() + static_cast<std::size_t>(all[k]) * stride);
  PetscFunctionReturn(PETSC_SUCCESS);
}

// Values at a place in (0, 1) of the Lagrange polynomials of the Lobatto nodes.
template <int P>
std::array<double, P + 1> lagrange_at(double place) {
  const auto& c = physics::lagrange_coefficients<P>();
  std::array<double, P + 1> values{};
  for (int i = 0; i <= P; ++i)
    for (int k = P; k >= 0; --k) values[i] = values[i] * place + c[i][k];
  return values;
}

// A cell of the coarse mesh at one of its places.
template <int P>
struct CoarsePlace {
  using Element = physics::AxisymElement<P>;

  CoarsePlace(double x, double y) : along_R(lagrange_at<P>(x)), along_Z(lagrange_at<P>(y)) {
    std::array<double, P> legendre_x{}, legendre_y{};
    for (auto [values, at] : {std::pair{&legendre_x, 2 * x - 1}, std::pair{&legendre_y, 2 * y - 1}}) {
      (*values)[0] = 1;
      (*values)[1] = at;
      for (int n = 2; n < P; ++n)
        (*values)[n] = ((2 * n - 1) * at * (*values)[n - 1] - (n - 1) * (*values)[n - 2]) / n;
    }
    for (int degree = 0, q = 0; degree < P; ++degree)
      for (int k = 0; k <= degree; ++k, ++q) pressures[q] = legendre_x[degree - k] * legendre_y[k];
  }

  // Of a nodal field with `each` values a node.
  double nodal(const double* values, int each) const {
    double sum = 0;
    for (int j = 0; j <= P; ++j)
      for (int i = 0; i <= P; ++i) sum += along_R[i] * along_Z[j] * values[each * (i + (P + 1) * j)];
    return sum;
  }
  double pressure(const double* values) const {
    double sum = 0;
    for (int q = 0; q < Element::pressures; ++q) sum += pressures[q] * values[q];
    return sum;
  }

  std::array<double, P + 1> along_R, along_Z;
  std::array<double, Element::pressures> pressures{};
};

template <int P, int Q>
std::vector<double> interpolate_cell(const AxisymCell<Q>& cell, int column_ratio, int row_ratio,
                                     const double* from) {
  using Coarse = physics::AxisymElement<P>;
  using Fine = physics::AxisymElement<Q>;
  std::vector<double> values(cell.global.size(), 0.0);
  const bool tube = values.size() > Fine::leg_unknowns, charged = values.size() > Fine::tube_unknowns;
  const auto place = [&](double x, double y) {
    return CoarsePlace<P>((cell.column % column_ratio + x) / column_ratio,
                          (cell.row % row_ratio + y) / row_ratio);
  };
  const auto& lobatto = physics::lobatto_points<Q>();
  for (int j = 0; j <= Q; ++j)
    for (int i = 0; i <= Q; ++i) {
      const int node = i + (Q + 1) * j;
      const CoarsePlace<P> at = place(lobatto[i], lobatto[j]);
      for (int axis : {0, 1}) values[2 * node + axis] = at.nodal(from + axis, 2);
      if (charged) values[Fine::tube_unknowns + node] = at.nodal(from + Coarse::tube_unknowns, 1);
    }
  if (!tube) return values;
  std::array<double, Fine::pressures> norm{};
  for (int g = 0; g < Fine::points; ++g) {
    const auto& shapes = cell.geometry.pressure[g];
    const double share = cell.geometry.share[g];
    const double pressure =
        place(cell.geometry.place[g][0], cell.geometry.place[g][1]).pressure(from + Coarse::leg_unknowns);
    for (int q = 0; q < Fine::pressures; ++q) {
      values[Fine::leg_unknowns + q] += share * pressure * shapes[q];
      norm[q] += share * shapes[q] * shapes[q];
    }
  }
  for (int q = 0; q < Fine::pressures; ++q) values[Fine::leg_unknowns + q] /= norm[q];
  return values;
}

template <int P, int Q>
PetscErrorCode prolongate_multipliers(const typename AxisymSystem<P>::SurfaceState& from,
                                      const ContactSurface& surface, Vec y) {
  PetscFunctionBegin;
  const std::size_t edges = (from.multiplier.size() - 1) / P;
  const std::size_t ratio = (surface.nodes.size() - 1) / Q / edges;
  for (std::size_t i = 0; i < surface.nodes.size(); i += Q) {
    if (surface.nodes[i].multiplier < 0) continue;
    const std::size_t vertex = i / Q, edge = std::min(vertex / ratio, edges - 1);
    const double place = double(vertex - ratio * edge) / ratio;
    const double value = (1 - place) * from.multiplier[P * edge] + place * from.multiplier[P * (edge + 1)];
    PetscCall(VecSetValue(y, surface.nodes[i].multiplier, value, INSERT_VALUES));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

}  // namespace

template <int P, int Q>
PetscErrorCode prolongate(const AxisymSystem<P>& coarse, Vec x, const AxisymSystem<Q>& fine, Vec y) {
  PetscFunctionBegin;
  constexpr std::size_t stride = physics::AxisymElement<P>::charged_unknowns;
  std::vector<double> from;
  PetscCall(gather_cells(coarse, x, from));
  PetscCall(VecSet(y, 0));
  PetscCall(VecSetOption(y, VEC_IGNORE_NEGATIVE_INDICES, PETSC_TRUE));
  for (const AxisymCell<Q>& cell : fine.space().cells) {
    const AxisymBlock& block = coarse.space().mesh.blocks[cell.block];
    const int columns = fine.space().mesh.blocks[cell.block].columns() / block.columns();
    const int rows = fine.space().mesh.blocks[cell.block].rows() / block.rows();
    const std::size_t parent = block.cell(cell.column / columns, cell.row / rows);
    const std::vector<double> values =
        interpolate_cell<P, Q>(cell, columns, rows, from.data() + parent * stride);
    PetscCall(VecSetValues(y, static_cast<PetscInt>(values.size()), cell.global.data(), values.data(),
                           INSERT_VALUES));
  }
  for (std::size_t t = 0; t < fine.space().tubes.size(); ++t)
    PetscCall((prolongate_multipliers<P, Q>(coarse.tubes()[t], fine.space().tubes[t], y)));
  PetscCall((prolongate_multipliers<P, Q>(coarse.leg(), fine.space().leg, y)));
  PetscCall(VecAssemblyBegin(y));
  PetscCall(VecAssemblyEnd(y));
  PetscFunctionReturn(PETSC_SUCCESS);
}

#define GAITER_PROLONGATE(P, Q) \
  template PetscErrorCode prolongate(const AxisymSystem<P>&, Vec, const AxisymSystem<Q>&, Vec);
GAITER_PROLONGATE(2, 2)
GAITER_PROLONGATE(3, 3)
GAITER_PROLONGATE(4, 4)
GAITER_PROLONGATE(2, 3)
GAITER_PROLONGATE(3, 4)

}  // namespace gaiter::solvers
