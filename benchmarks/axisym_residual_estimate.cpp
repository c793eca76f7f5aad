// SPDX-License-Identifier: BSD-2-Clause
// How far slices and sliding slices are from the finite elements, truly and estimated without solving these:
// tapers of 2 to 20 degrees, stretch 1.05 to 2.2, the paper's ankle compliance (anchored), radius 39.6 mm.
// Of each output the true relative error and, in brackets, estimate over error; * marks what is not reliable.
// Then what the estimate costs, over a solve by finite elements on the default mesh with its error estimate.
// Usage: axisym_residual_estimate [-voltage 4000] [-held]
#include <algorithm>
#include <cmath>
#include <cstdio>

#include "gaiter/petsc/check.hpp"
#include "gaiter/petsc/session.hpp"
#include "gaiter/solvers/axisym_model.hpp"
#include "gaiter/solvers/residual_estimate.hpp"
#include "gaiter/solvers/sliding_model.hpp"
#include "paper_scene.hpp"
#include "processor_time.hpp"

namespace {

using namespace gaiter;

model::Scene cone(double degrees, double stretch, double voltage, bool held) {
  model::Scene scene = paper::cone(degrees, stretch, voltage);
  if (held) scene.contact_axial = model::ContactAxial::held;
  return scene;
}

void print_ratio(double estimate, double own, double exact) {
  const double error = own / exact - 1;
  std::printf(" %8.1e (%5.2f)", error, estimate / error);
}

void print_row(const model::Scene& scene) {
  const solvers::SegmentTask task{&scene, 0};
  double start = processor_seconds();
  const model::SegmentResult exact = solvers::solve_axisym(PETSC_COMM_SELF, {&task, 1})[0];
  const double solve = processor_seconds() - start;
  for (auto fidelity : {model::Fidelity::slice, model::Fidelity::sliding}) {
    const model::SegmentResult own = fidelity == model::Fidelity::slice
                                         ? solvers::solve_segments(PETSC_COMM_SELF, {&task, 1})[0]
                                         : solvers::solve_sliding(task).result;
    start = processor_seconds();
    const solvers::ResidualEstimate error = solvers::estimate_by_residual(task, own, fidelity);
    const double share = (processor_seconds() - start) / solve;
    std::printf(" |%s", error.reliable ? " " : "*");
    print_ratio(error.pressure_rest, own.pressure_rest, exact.pressure_rest);
    if (scene.bandage.modules[0].voltage != 0)
      print_ratio(error.actuation_drop, own.actuation_drop, exact.actuation_drop);
    print_ratio(error.volume_change, own.volume_change, exact.volume_change);
    std::printf(" +- %7.1e %4.2f", error.spread, share);
  }
  std::printf("\n");
}

}  // namespace

int main(int argc, char** argv) {
  const petsc::Session session({argv + 1, argv + argc});
  PetscReal voltage = 0;
  PetscBool held = PETSC_FALSE;
  petsc::check(PetscOptionsGetReal(nullptr, nullptr, "-voltage", &voltage, nullptr));
  petsc::check(PetscOptionsGetBool(nullptr, nullptr, "-held", &held, nullptr));
  std::printf("slices, then sliding slices: pressure at rest, %svolume change, spread, cost\n",
              voltage != 0 ? "actuation drop, " : "");
  for (double degrees : {2.0, 5.0, 10.0, 15.0, 20.0})
    for (double stretch : {1.05, 1.1, 1.2, 1.4, 1.8, 2.0, 2.1, 2.2}) {
      std::printf("%2g deg, stretch %4g", degrees, stretch);
      print_row(cone(degrees, stretch, voltage, held));
    }
}
