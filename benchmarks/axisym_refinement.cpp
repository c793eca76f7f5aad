// SPDX-License-Identifier: BSD-2-Clause
// The axisymmetric finite elements refined: the paper's ankle segment r6, surrogate elastomer, anchored
// compliance, at rest, at stretches 1.4 and 2.2, from the slice solution. A row a mesh: unknowns, Newton's
// iterations, and what they say of the contact; below each column the order fitted to the changes from mesh
// to mesh, and how far the finest mesh still is from the limit that this order tells. Usage:
// axisym_refinement [-meshes 5] [-order 2] [-axisym_... (PETSc's options of the solver)]
#include <cmath>
#include <cstdio>
#include <string>
#include <vector>

#include "axisym_integrals.hpp"
#include "axisym_problem.hpp"
#include "fitted_order.hpp"
#include "gaiter/petsc/session.hpp"
#include "paper_scene.hpp"

namespace {

using namespace gaiter;

struct Quantity {
  const char* name;
  double axisym::ContactIntegrals::*value;
  double unit;
};

template <int P>
void study(double stretch, int meshes) {
  model::Scene scene = paper::scene(stretch, 0);
  scene.leg.variant = model::ComplianceVariant::anchored;
  const double stress = solvers::axisym_stress_unit(scene.bandage),
               length = scene.leg.segments[0].mean_radius();
  using axisym::ContactIntegrals;
  const std::vector<Quantity> quantities{
      {"mean [Pa]", &ContactIntegrals::mean, stress},
      {"area mean", &ContactIntegrals::area_mean, stress},
      {"interior", &ContactIntegrals::interior_mean, stress},
      {"radial [N]", &ContactIntegrals::radial_force, stress * length * length},
      {"axial [N]", &ContactIntegrals::axial_force, stress * length * length},
      {"slip [mm]", &ContactIntegrals::slip, 1e3 * length}};
  std::printf("stretch %.1f, order %d\nmesh unknowns iterations seconds  open", stretch, P);
  for (const Quantity& quantity : quantities) std::printf(" %11s", quantity.name);
  std::printf("\n");
  std::vector<std::vector<double>> values(quantities.size());
  for (int mesh = 0; mesh < meshes; ++mesh) {
    solvers::AxisymResolution resolution;
    resolution.refinements = mesh;
    const double start = MPI_Wtime();
    axisym::Problem<P> problem(scene, resolution);
    problem.start(scene);
    const auto report = problem.solver.solve(problem.x.get());
    const double seconds = MPI_Wtime() - start;
    PetscInt unknowns = 0;
    petsc::check(VecGetSize(problem.x.get(), &unknowns));
    std::printf("%4d %8d %10d %7.2f", mesh, static_cast<int>(unknowns), report.iterations, seconds);
    if (!report.converged || !report.stable) {
      std::printf("  %s\n", report.converged ? "not stable" : "not converged");
      return;
    }
    const ContactIntegrals sum = axisym::contact_integrals<P>(problem.system);
    std::printf(" %5d", sum.open);
    for (std::size_t q = 0; q < quantities.size(); ++q) {
      values[q].push_back(sum.*quantities[q].value * quantities[q].unit);
      std::printf(" %11.5f", values[q].back());
    }
    std::printf("\n");
  }
  if (meshes < 3) return;
  std::vector<double> orders, last;
  for (const std::vector<double>& value : values) {
    std::vector<double> size, change;
    for (std::size_t k = 1; k < value.size(); ++k) {
      size.push_back(std::ldexp(1.0, -static_cast<int>(k)));
      change.push_back(std::fabs(value[k] - value[k - 1]));
    }
    orders.push_back(fitted_order(size, change));
    last.push_back(change.back() / std::fabs(value.back()));
  }
  std::printf("%-38s", "order");
  for (double order : orders) std::printf(" %11.2f", order);
  std::printf("\n%-38s", "last change, relative");
  for (double change : last) std::printf(" %11.1e", change);
  std::printf("\n\n");
}

int integer_option(const char* name, int value) {
  PetscInt result = value;
  petsc::check(PetscOptionsGetInt(nullptr, nullptr, name, &result, nullptr));
  return static_cast<int>(result);
}

}  // namespace

int main(int argc, char** argv) {
  petsc::Session session(std::vector<std::string>(argv + 1, argv + argc));
  const int meshes = integer_option("-meshes", 5), order = integer_option("-order", 2);
  for (double stretch : {1.4, 2.2}) {
    if (order == 2) study<2>(stretch, meshes);
    if (order == 3) study<3>(stretch, meshes);
    if (order == 4) study<4>(stretch, meshes);
  }
}
