// SPDX-License-Identifier: BSD-2-Clause
// The dual's estimate of the finite elements' error, and meshes refined along one direction: a segment at
// rest on the paper's ankle r6 and on steep cones. A row a mesh: unknowns, Newton's steps, error of the mean
// pressure against order 4 refined twice, processor seconds; then the dual's estimate over that error and its
// seconds over the solve's, with all cells halved, rows alone and columns alone.
// Usage: axisym_effectivity [-axisym_...]
#include <cmath>
#include <cstdio>
#include <vector>

#include "gaiter/petsc/session.hpp"
#include "gaiter/solvers/axisym_case.hpp"
#include "gaiter/solvers/axisym_enriched.hpp"
#include "paper_scene.hpp"
#include "processor_time.hpp"

namespace {

using namespace gaiter;
using solvers::AxisymResolution;

model::Scene cone(double degrees, double stretch) {
  model::Scene scene = paper::cylinder(39.6e-3, stretch);
  model::Segment& segment = scene.leg.segments[0];
  const double half = 0.5 * segment.height * std::tan(degrees * M_PI / 180);
  segment.lower_radius -= half;
  segment.upper_radius += half;
  return scene;
}

void print_row(const char* name, const model::Scene& scene, const AxisymResolution& resolution,
               double exact) {
  double start = processor_seconds();
  solvers::AxisymCase<2> problem(PETSC_COMM_SELF, scene, 0, 0, resolution);
  const solvers::AxisymSummary summary = problem.rest()[0];
  const double seconds = processor_seconds() - start, error = exact - summary.pressure;
  std::printf("%-22s %6d %3d %8.1e %7.4f", name, problem.unknowns(), summary.iterations, error / exact,
              seconds);
  std::vector<AxisymResolution> finer(3, resolution);
  ++finer[0].refinements;
  ++finer[1].row_refinements;
  ++finer[2].column_refinements;
  for (const AxisymResolution& halved : finer) {
    start = processor_seconds();
    solvers::AxisymCase<2> mesh(PETSC_COMM_SELF, scene, 0, 0, halved);
    const auto changes = solvers::expected_changes(problem, mesh);
    std::printf(" | %6.2f %4.2f", changes.empty() ? NAN : changes[0].pressure / error,
                (processor_seconds() - start) / seconds);
  }
  std::printf("\n");
}

void study(const char* name, model::Scene scene) {
  scene.leg.variant = model::ComplianceVariant::anchored;
  solvers::AxisymCase<4> truth(PETSC_COMM_SELF, scene, 0, 0, 2);
  const double exact = truth.rest()[0].pressure;
  std::printf("%s\n", name);
  print_row("tube 6, leg 5 x 3", scene, {.tube_rows = 6, .leg_rows = 5, .leg_columns = 3}, exact);
  print_row("coarsest", scene, {}, exact);
  print_row("refined", scene, {.refinements = 1}, exact);
  print_row("refined twice", scene, {.refinements = 2}, exact);
  print_row("rows refined", scene, {.row_refinements = 1}, exact);
  print_row("rows refined twice", scene, {.row_refinements = 2}, exact);
  print_row("columns refined", scene, {.column_refinements = 1}, exact);
  print_row("twice the tube's rows", scene, {.tube_rows = 24}, exact);
  for (double grading : {1.0, 3.0, 16.0, 32.0}) {
    char text[32];
    std::snprintf(text, sizeof text, "grading %g", grading);
    print_row(text, scene, {.end_grading = grading}, exact);
  }
}

}  // namespace

int main(int argc, char** argv) {
  const petsc::Session session({argv + 1, argv + argc});
  std::printf(
      "mesh                  unknowns its  error  seconds | effectivity, cost: all halved | rows | "
      "columns\n");
  study("r6, stretch 1.4", paper::scene(1.4, 0));
  study("r6, stretch 2", paper::scene(2.0, 0));
  study("20 degrees, stretch 1.4", cone(20, 1.4));
  study("20 degrees, stretch 1.1", cone(20, 1.1));
}
