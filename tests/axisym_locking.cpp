// SPDX-License-Identifier: BSD-2-Clause
// The tube's elements do not lock: on a coarse mesh of long cells the contact pressure is as good for an
// incompressible wall as for a compressible one, and as good for a thin wall as for a thick one.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <limits>

#include "axisym_integrals.hpp"
#include "axisym_problem.hpp"
#include "paper_scene.hpp"

namespace gaiter::axisym {
namespace {

model::Scene cone(double stretch, double wall) {
  model::Scene scene = paper::cylinder(36.1e-3, stretch);
  scene.leg.segments[0].upper_radius = 43.1e-3;
  scene.leg.material = model::LegMaterial::neo_hookean;
  scene.bandage.thickness = wall;
  return scene;
}

// One cell through the wall and 12 along it, 2.9 mm each.
solvers::AxisymResolution long_cells(int refinements) {
  solvers::AxisymResolution result;
  result.tube_rows = 12;
  result.tube_columns = 1;
  result.end_grading = 1;
  result.refinements = refinements;
  return result;
}

ContactIntegrals solve(const model::Scene& scene, int refinements) {
  Problem<2> problem(scene, long_cells(refinements));
  problem.start(scene);
  const auto report = problem.solver.solve(problem.x.get());
  EXPECT_TRUE(report.converged && report.stable);
  return contact_integrals<2>(problem.system);
}

double change(double value, double reference) {
  return std::fabs(value / reference - 1);
}

TEST(Locking, IsAbsentAtEveryThicknessAndBulkModulus) {
  std::printf("  wall [mm]  K / shear modulus  error of mean pressure  of area mean\n");
  for (double wall : {0.1e-3, 1e-3, 5e-3})
    for (double bulk : {1e2, 1e4, 1e6, std::numeric_limits<double>::infinity()}) {
      model::Scene scene = cone(1.4, wall);
      scene.bandage.bulk_modulus = bulk * solvers::axisym_stress_unit(scene.bandage);
      const ContactIntegrals coarse = solve(scene, 0), fine = solve(scene, 2);
      const double mean = change(coarse.mean, fine.mean), area = change(coarse.area_mean, fine.area_mean);
      std::printf("  %9g  %17g  %22.1e  %12.1e\n", 1e3 * wall, bulk, mean, area);
      EXPECT_LT(mean, 3e-4);
      EXPECT_LT(area, 3e-4);
    }
}

// What locking looks like: the pressure field's stabilising term made so large, step by step, that it asks
// for incompressibility at every Gauss point, as an element of displacements alone does. The case is one of
// bending, a tube that is open over a third of its length.
TEST(Locking, ShowsWhereIncompressibilityIsAskedForAtEveryPoint) {
  const model::Scene scene = cone(1.05, 3e-3);
  const double reference = solve(scene, 2).interior_mean;
  EXPECT_LT(change(solve(scene, 0).interior_mean, reference), 3e-3);

  petsc::Vector last;
  double locked = 0;
  for (double stabilisation = 1; stabilisation < 2e5; stabilisation *= std::sqrt(10.0)) {
    auto materials = solvers::axisym_materials(scene, 0, 0);
    materials.tubes[0].stabilisation = stabilisation;
    Problem<2> problem(scene, long_cells(0), materials);
    if (last.get())
      petsc::check(VecCopy(last.get(), problem.x.get()));
    else
      problem.start(scene);
    ASSERT_TRUE(problem.solver.solve(problem.x.get()).converged);
    locked = contact_integrals<2>(problem.system).interior_mean;
    petsc::check(VecDuplicate(problem.x.get(), last.out()));
    petsc::check(VecCopy(problem.x.get(), last.get()));
  }
  std::printf("  locked: %.1e\n", change(locked, reference));
  EXPECT_GT(change(locked, reference), 2e-2);
}

}  // namespace
}  // namespace gaiter::axisym
