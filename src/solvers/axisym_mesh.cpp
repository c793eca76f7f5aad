// SPDX-License-Identifier: BSD-2-Clause
#include "gaiter/solvers/axisym_mesh.hpp"

#include <cmath>

#include "gaiter/petsc/check.hpp"
#include "gaiter/petsc/session.hpp"
#include "gaiter/physics/slice_system.hpp"

namespace gaiter::solvers {

namespace {

// Lines of `count` cells on (0, 1) whose sizes shrink geometrically, by `ratio` in all, towards 0, 1, both or
// neither.
std::vector<double> graded(int count, double ratio, bool to_0, bool to_1) {
  const auto size = [&](int k) {
    const double place = count > 1 ? k / (count - 1.0) : 0;  // 0 first cell, 1 last
    if (to_0 && to_1) return std::pow(ratio, -std::fabs(2 * place - 1));
    return to_0 || to_1 ? std::pow(ratio, to_1 ? -place : place - 1) : 1.0;
  };
  std::vector<double> lines{0};
  for (int k = 0; k < count; ++k) lines.push_back(lines.back() + size(k));
  for (double& line : lines) line /= lines.back();
  lines.back() = 1;
  return lines;
}

// Halves every cell as often as asked.
std::vector<double> refined(std::vector<double> lines, int times) {
  for (; times > 0; --times) {
    std::vector<double> finer{lines[0]};
    for (std::size_t k = 1; k < lines.size(); ++k) {
      finer.push_back(0.5 * (lines[k - 1] + lines[k]));
      finer.push_back(lines[k]);
    }
    lines = std::move(finer);
  }
  return lines;
}

PetscErrorCode label_points(DM dm, const char* name, PetscInt depth) {
  PetscFunctionBegin;
  DMLabel label = nullptr;
  PetscInt first = 0, last = 0;
  PetscCall(DMCreateLabel(dm, name));
  PetscCall(DMGetLabel(dm, name, &label));
  PetscCall(DMPlexGetDepthStratum(dm, depth, &first, &last));
  for (PetscInt point = first; point < last; ++point) PetscCall(DMLabelSetValue(label, point, point - first));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode create(MPI_Comm comm, const AxisymMesh& mesh, Plex& plex) {
  PetscFunctionBegin;
  std::vector<PetscInt> cells;
  std::vector<PetscReal> coordinates;
  if (petsc::rank(comm) == 0)
    for (const AxisymBlock& block : mesh.blocks) {
      for (int row = 0; row < block.rows(); ++row)
        for (int column = 0; column < block.columns(); ++column)
          for (PetscInt vertex : {block.vertex(column, row), block.vertex(column + 1, row),
                                  block.vertex(column + 1, row + 1), block.vertex(column, row + 1)})
            cells.push_back(vertex);
      for (int row = 0; row <= block.rows(); ++row)
        for (int column = 0; column <= block.columns(); ++column)
          for (double coordinate : block.position(column, row))
            coordinates.push_back(coordinate * mesh.length);
    }
  PetscCall(DMPlexCreateFromCellListPetsc(comm, 2, static_cast<PetscInt>(cells.size() / 4),
                                          static_cast<PetscInt>(coordinates.size() / 2), 4, PETSC_TRUE,
                                          cells.data(), 2, coordinates.data(), plex.out()));
  PetscCall(DMSetOptionsPrefix(plex.get(), "axisym_"));
  PetscMPIInt ranks = 1;
  PetscCallMPI(MPI_Comm_size(comm, &ranks));
  if (ranks > 1) {
    PetscCall(label_points(plex.get(), "cell", 2));
    PetscCall(label_points(plex.get(), "vertex", 0));
    PetscPartitioner partitioner = nullptr;
    PetscCall(DMPlexGetPartitioner(plex.get(), &partitioner));
    PetscCall(PetscPartitionerSetFromOptions(partitioner));
    DM distributed = nullptr;
    PetscCall(DMPlexDistribute(plex.get(), 0, nullptr, &distributed));
    if (distributed) plex = Plex(distributed);
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

}  // namespace

AxisymMesh make_axisym_mesh(const model::Scene& scene, std::size_t first, std::size_t last,
                            const AxisymResolution& resolution) {
  AxisymMesh mesh;
  mesh.length = scene.leg.segments[first].mean_radius();
  AxisymBlock leg;
  leg.height.push_back(0);
  const int row_refinements = resolution.refinements + resolution.row_refinements;
  const int column_refinements = resolution.refinements + resolution.column_refinements;
  leg.across =
      refined(graded(resolution.leg_columns, resolution.skin_grading, false, true), column_refinements);
  const std::vector<double> tube_lines =
      refined(graded(resolution.tube_rows, resolution.end_grading, true, true), row_refinements);
  const std::vector<double> wall_lines =
      refined(graded(resolution.tube_columns, 1, false, false), column_refinements);

  for (std::size_t s = first; s <= last; ++s) {
    const model::Segment& segment = scene.leg.segments[s];
    const physics::Wall wall = physics::reference_wall(scene.bandage, scene.bandage.modules[s],
                                                       segment.mean_radius(), segment.mean_radius());
    const double bottom = leg.height.back(), height = segment.height / mesh.length;
    AxisymBlock tube;
    tube.tube = true;
    tube.across = wall_lines;
    for (double line : tube_lines) {
      tube.height.push_back(bottom + height * line);
      tube.inner.push_back(wall.inner_radius / mesh.length);
      tube.outer.push_back((wall.inner_radius + wall.thickness) / mesh.length);
    }
    tube.segment.assign(tube.rows(), s);
    mesh.blocks.push_back(std::move(tube));

    const auto radius = [&](double line) {
      return (segment.lower_radius + line * (segment.upper_radius - segment.lower_radius)) / mesh.length;
    };
    if (s == first) leg.outer.push_back(radius(0));
    // Not towards other segments: there the edges of the tubes press singular peaks into a leg that is free
    // to move along, and small cells would fold under them.
    const std::vector<double> leg_lines =
        refined(graded(resolution.leg_rows, resolution.end_grading, s == first, s == last), row_refinements);
    for (std::size_t k = 1; k < leg_lines.size(); ++k) {
      leg.height.push_back(bottom + height * leg_lines[k]);
      leg.outer.push_back(radius(leg_lines[k]));
      leg.segment.push_back(s);
    }
  }
  leg.inner.assign(leg.height.size(), 0.0);
  mesh.blocks.push_back(std::move(leg));
  for (AxisymBlock& block : mesh.blocks) {
    block.first_cell = mesh.cells;
    block.first_vertex = mesh.vertices;
    mesh.cells += block.columns() * block.rows();
    mesh.vertices += (block.columns() + 1) * (block.rows() + 1);
  }
  return mesh;
}

Plex make_plex(MPI_Comm comm, const AxisymMesh& mesh) {
  Plex plex;
  petsc::check(create(comm, mesh, plex));
  return plex;
}

}  // namespace gaiter::solvers
