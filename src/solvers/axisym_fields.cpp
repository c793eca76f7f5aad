// SPDX-License-Identifier: BSD-2-Clause
#include "gaiter/solvers/axisym_fields.hpp"

#include <algorithm>
#include <cmath>

#include "gaiter/petsc/check.hpp"
#include "gaiter/petsc/session.hpp"
#include "gaiter/physics/axisym_stress.hpp"
#include "gaiter/physics/quadrature.hpp"

namespace gaiter::solvers {

namespace {

// Value at a place in (0, 1) of the Lagrange polynomial of each Lobatto node.
template <int P>
std::array<double, P + 1> lobatto_weights(double place) {
  const auto& c = physics::lagrange_coefficients<P>();
  std::array<double, P + 1> weights{};
  for (int i = 0; i <= P; ++i)
    for (int k = P; k >= 0; --k) weights[i] = weights[i] * place + c[i][k];
  return weights;
}

// From a cell's Lobatto nodes, and from its Gauss points, to its equispaced points.
template <int P>
class CellMaps {
 public:
  using Element = physics::AxisymElement<P>;
  using Weights = std::array<double, Element::nodes>;

  CellMaps() {
    const physics::Quadrature rule = physics::gauss_legendre(P + 1);
    for (int j = 0; j <= P; ++j)
      for (int i = 0; i <= P; ++i) {
        const int point = i + (P + 1) * j;
        const double x = double(i) / P, y = double(j) / P;
        const auto along_R = lobatto_weights<P>(x), along_Z = lobatto_weights<P>(y);
        for (int n = 0; n < Element::nodes; ++n) {
          of_nodes[point][n] = along_R[n % (P + 1)] * along_Z[n / (P + 1)];
          const int g = n % (P + 1), h = n / (P + 1);
          of_gauss[point][n] =
              rule.weights[g] * projection(x, rule.nodes[g]) * rule.weights[h] * projection(y, rule.nodes[h]);
        }
      }
  }

  std::array<Weights, Element::nodes> of_nodes{}, of_gauss{};

 private:
  // Kernel of the projection of a function on (0, 1) on the polynomials of degree P: from the P + 1 Gauss
  // points it is the polynomial through them.
  static double projection(double at, double from) {
    double sum = 0;
    for (unsigned k = 0; k <= P; ++k)
      sum += (2 * k + 1) * std::legendre(k, 2 * at - 1) * std::legendre(k, 2 * from - 1);
    return sum;
  }
};

// What rank 0 is told of a cell: its number in the mesh, then these of each point.
enum Item { r, z, u_r, u_z, stress_rr, stress_zz, stress_rz, stress_tt, items };

template <int P>
constexpr std::size_t record_size = 1 + items* physics::AxisymElement<P>::nodes;

// The records of this rank's cells, in the units of the system.
template <int P>
PetscErrorCode describe_cells(const AxisymSystem<P>& system, Vec x, std::vector<double>& records) {
  using Element = physics::AxisymElement<P>;
  PetscFunctionBegin;
  const AxisymSpace<P>& space = system.space();
  const AxisymMaterials& materials = system.materials();
  DM dm = space.plex.get();
  petsc::Vector local;
  PetscCall(DMCreateLocalVector(dm, local.out()));
  PetscCall(system.fill_local(x, local.get()));
  const PetscScalar* values = nullptr;
  PetscCall(VecGetArrayRead(local.get(), &values));
  records.assign(space.cells.size() * record_size<P>, 0.0);
  double* out = records.data();
  static const CellMaps<P> maps;
  std::array<double, Element::charged_unknowns> u;
  for (std::size_t c = 0; c < space.cells.size(); ++c) {
    const AxisymCell<P>& cell = space.cells[c];
    const AxisymBlock& block = space.mesh.blocks[cell.block];
    for (std::size_t i = 0; i < cell.local.size(); ++i) u[i] = values[cell.local[i]];
    const auto stress =
        block.tube ? physics::tube_stress<P>(cell.geometry, materials.tubes[cell.block], system.field(block),
                                             space.choice.layers > 0, u.data())
                   : physics::leg_stress<P>(cell.geometry, materials.leg[block.segment[cell.row]], u.data());
    *out++ = block.cell(cell.column, cell.row);
    for (int point = 0; point < Element::nodes; ++point, out += items)
      for (int n = 0; n < Element::nodes; ++n) {
        const double weight = maps.of_nodes[point][n];
        for (int axis : {0, 1}) {
          out[r + axis] += weight * (cell.geometry.position[n][axis] + u[2 * n + axis]);
          out[u_r + axis] += weight * u[2 * n + axis];
        }
        for (int s = 0; s < 4; ++s) out[stress_rr + s] += maps.of_gauss[point][n] * stress[n][s];
      }
  }
  PetscCall(VecRestoreArrayRead(local.get(), &values));
  PetscFunctionReturn(PETSC_SUCCESS);
}

// All records on rank 0, in the order of the cells' numbers; elsewhere none.
template <int P>
PetscErrorCode gather_records(MPI_Comm comm, const std::vector<double>& mine, std::vector<double>& sorted) {
  PetscFunctionBegin;
  const int ranks = petsc::size(comm), count = static_cast<int>(mine.size());
  std::vector<int> counts(ranks), offsets(ranks + 1, 0);
  PetscCallMPI(MPI_Gather(&count, 1, MPI_INT, counts.data(), 1, MPI_INT, 0, comm));
  for (int rank = 0; rank < ranks; ++rank) offsets[rank + 1] = offsets[rank] + counts[rank];
  std::vector<double> all(offsets[ranks]);
  PetscCallMPI(MPI_Gatherv(mine.data(), count, MPI_DOUBLE, all.data(), counts.data(), offsets.data(),
                           MPI_DOUBLE, 0, comm));
  sorted.resize(all.size());
  for (std::size_t k = 0; k < all.size(); k += record_size<P>)
    std::copy_n(all.begin() + k, record_size<P>,
                sorted.begin() + static_cast<std::size_t>(all[k]) * record_size<P>);
  PetscFunctionReturn(PETSC_SUCCESS);
}

// Contact pressure as a function of the current height, from the surface that carries the multipliers.
template <int P>
class PressureProfile {
 public:
  explicit PressureProfile(const typename AxisymSystem<P>::SurfaceState& surface) : surface_(surface) {}

  bool reaches(double height) const {
    const double slack = 1e-9 * (surface_.height.back() - surface_.height.front());
    return height > surface_.height.front() - slack && height < surface_.height.back() + slack;
  }

  double at_height(double height) const {
    std::size_t edge = 0;
    while (P * (edge + 2) < surface_.height.size() && surface_.height[P * (edge + 1)] < height) ++edge;
    // The heights on an edge grow with the place on it.
    double low = 0, high = 1;
    for (int halving = 0; halving < 60; ++halving) {
      const double middle = 0.5 * (low + high);
      const auto weights = lobatto_weights<P>(middle);
      double there = 0;
      for (int i = 0; i <= P; ++i) there += weights[i] * surface_.height[P * edge + i];
      (there < height ? low : high) = middle;
    }
    return at_place(edge, high);
  }

  double at_place(std::size_t edge, double place) const {
    return (1 - place) * surface_.multiplier[P * edge] + place * surface_.multiplier[P * (edge + 1)];
  }

 private:
  const typename AxisymSystem<P>::SurfaceState& surface_;
};

// Pressure at a place on the contact surface of a block; of several tubes on the leg, the one of the leg's
// own segment comes first where two end at the same height.
template <int P>
double contact_pressure(const AxisymSystem<P>& system, std::size_t block_number, std::size_t row,
                        double place, double height) {
  const AxisymSpace<P>& space = system.space();
  const AxisymBlock& block = space.mesh.blocks[block_number];
  if (block.tube == space.choice.multipliers_on_tube) {
    const auto& own = block.tube ? system.tubes()[block_number] : system.leg();
    return PressureProfile<P>(own).at_place(row, place);
  }
  if (block.tube) {
    const PressureProfile<P> leg(system.leg());
    return leg.reaches(height) ? leg.at_height(height) : 0;
  }
  double pressure = 0;
  for (std::size_t t = 0; t < system.tubes().size(); ++t) {
    const PressureProfile<P> tube(system.tubes()[t]);
    if (!tube.reaches(height)) continue;
    pressure = tube.at_height(height);
    if (space.mesh.blocks[t].segment.front() == block.segment[row]) break;
  }
  return pressure;
}

// Rows of a block that belong to one segment, and the points they share.
struct Patch {
  std::size_t block, first_row, rows;
};

std::vector<Patch> list_patches(const AxisymMesh& mesh) {
  std::vector<Patch> patches;
  for (std::size_t b = 0; b < mesh.blocks.size(); ++b) {
    const auto& segment = mesh.blocks[b].segment;
    for (std::size_t row = 0; row < segment.size(); ++row)
      if (row == 0 || segment[row] != segment[row - 1])
        patches.push_back({b, row, 1});
      else
        ++patches.back().rows;
  }
  return patches;
}

// Adds a patch's points and cells to the fields.
template <int P>
void add_patch(const AxisymSystem<P>& system, const Patch& patch, const std::vector<double>& records,
               AxisymFields& fields) {
  const AxisymMesh& mesh = system.space().mesh;
  const AxisymBlock& block = mesh.blocks[patch.block];
  const double length = mesh.length, unit = system.materials().stress;
  const std::size_t columns = block.columns(), line = P * columns + 1;
  const std::size_t first = fields.contact_pressure.size(), last = first + line * (P * patch.rows + 1);
  fields.position.resize(2 * last);
  fields.displacement.resize(2 * last);
  fields.stress.resize(4 * last, 0.0);
  fields.contact_pressure.resize(last, 0.0);
  std::vector<int> sharing(last - first, 0);
  for (std::size_t row = 0; row < patch.rows; ++row)
    for (std::size_t column = 0; column < columns; ++column) {
      const int number = block.cell(static_cast<int>(column), static_cast<int>(patch.first_row + row));
      const double* item = records.data() + number * record_size<P> + 1;
      for (std::size_t j = 0; j <= P; ++j)
        for (std::size_t i = 0; i <= P; ++i, item += items) {
          const std::size_t along = P * column + i;
          const std::size_t point = first + along + line * (P * row + j);
          fields.cells.push_back(static_cast<std::int64_t>(point));
          ++sharing[point - first];
          for (int axis : {0, 1}) {
            fields.position[2 * point + axis] = length * item[r + axis];
            fields.displacement[2 * point + axis] = length * item[u_r + axis];
          }
          for (int s = 0; s < 4; ++s) fields.stress[4 * point + s] += unit * item[stress_rr + s];
          if (along == (block.tube ? 0 : line - 1))
            fields.contact_pressure[point] =
                unit * contact_pressure(system, patch.block, patch.first_row + row, double(j) / P, item[z]);
        }
      fields.tube.push_back(block.tube);
      fields.segment.push_back(static_cast<int>(block.segment[patch.first_row + row]));
    }
  for (std::size_t point = first; point < last; ++point)
    for (int s = 0; s < 4; ++s) fields.stress[4 * point + s] /= sharing[point - first];
}

}  // namespace

template <int P>
AxisymFields extract_fields(const AxisymSystem<P>& system, Vec x) {
  std::vector<double> mine, records;
  petsc::check(describe_cells(system, x, mine));
  petsc::check(gather_records<P>(system.comm(), mine, records));
  const AxisymMesh& mesh = system.space().mesh;
  AxisymFields fields;
  fields.first_segment = mesh.leg().segment.front();
  fields.last_segment = mesh.leg().segment.back();
  fields.order = P;
  if (petsc::rank(system.comm()) == 0)
    for (const Patch& patch : list_patches(mesh)) add_patch(system, patch, records, fields);
  return fields;
}

template AxisymFields extract_fields(const AxisymSystem<2>&, Vec);
template AxisymFields extract_fields(const AxisymSystem<3>&, Vec);
template AxisymFields extract_fields(const AxisymSystem<4>&, Vec);

}  // namespace gaiter::solvers
