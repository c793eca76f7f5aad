// SPDX-License-Identifier: BSD-2-Clause
// The axisymmetric finite elements at the extremes of stretch, wall, modulus of the leg, bulk modulus and
// taper, at rest: on the paper's ankle segment r6 (a cone of taper 0.2) and on cylinders of its mean radius.
// A row a scene, and for meshes 0, 1 and 2 its status, Newton's steps, seconds and mean pressure; then the
// change from mesh 1 to mesh 2, and the deviation of mesh 1 from a value that is independent of it: the
// slices on a cylinder of incompressible elastomer, elsewhere elements of third order on mesh 1. Usage:
// axisym_range [-study stretch|wall|leg|bulk|taper|fidelities] [-axisym_... (PETSc's options)]
#include <cmath>
#include <cstdio>
#include <string>
#include <vector>

#include "gaiter/petsc/check.hpp"
#include "gaiter/petsc/session.hpp"
#include "gaiter/solvers/axisym_model.hpp"
#include "gaiter/solvers/sliding_model.hpp"
#include "paper_scene.hpp"

namespace {

using namespace gaiter;

std::string name_of(model::Status status) {
  constexpr const char* names[model::status_count] = {"contact",      "slack",     "lifted",
                                                      "extrapolated", "pulled_in", "no_equilibrium",
                                                      "diverged",     "invalid",   "not_wanted"};
  return names[static_cast<std::size_t>(status)];
}

bool is_cylinder(const model::Scene& scene) {
  return scene.leg.segments[0].lower_radius == scene.leg.segments[0].upper_radius;
}

model::SegmentResult elements(const model::Scene& scene) {
  const solvers::SegmentTask task{&scene, 0};
  return solvers::solve_axisym(PETSC_COMM_SELF, {&task, 1})[0];
}

model::SegmentResult slices(const model::Scene& scene) {
  const solvers::SegmentTask task{&scene, 0};
  return solvers::solve_segments(PETSC_COMM_SELF, {&task, 1})[0];
}

double independent_pressure(model::Scene scene) {
  if (is_cylinder(scene) && std::isinf(scene.bandage.bulk_modulus)) return slices(scene).pressure_rest;
  scene.axisym.order = 3;
  scene.axisym.refine = 1;
  return elements(scene).pressure_rest;
}

void print_row(const std::string& label, model::Scene scene) {
  double pressures[3];
  std::printf("%-30s", label.c_str());
  for (int refine : {0, 1, 2}) {
    scene.axisym.refine = refine;
    const double start = MPI_Wtime();
    const model::SegmentResult result = elements(scene);
    pressures[refine] = result.pressure_rest;
    std::printf(" | %-14s %3d %5.2f %11.3f", name_of(result.status).c_str(), result.iterations,
                MPI_Wtime() - start, result.pressure_rest);
  }
  std::printf(" | %8.1e", pressures[2] / pressures[1] - 1);
  std::printf(" %8.1e\n", pressures[1] / independent_pressure(scene) - 1);
  std::fflush(stdout);
}

model::Scene segment_of(bool cone, double stretch) {
  model::Scene scene = paper::cylinder(39.61e-3, stretch);
  if (cone) {
    scene.leg.segments[0].lower_radius = 35.85e-3;
    scene.leg.segments[0].upper_radius = 43.37e-3;
  }
  scene.fidelity = model::Fidelity::axisym;
  scene.leg.variant = model::ComplianceVariant::anchored;
  scene.leg.data_limit = INFINITY;
  return scene;
}

model::Scene neo_hookean(bool cone, double stretch) {
  model::Scene scene = segment_of(cone, stretch);
  scene.leg.material = model::LegMaterial::neo_hookean;
  return scene;
}

std::string label(const char* format, double value, double stretch, bool cone, const char* leg = "") {
  char text[80];
  std::snprintf(text, sizeof text, format, value);
  std::string result = text;
  std::snprintf(text, sizeof text, " %s %.2f %s", cone ? "cone" : "cyl.", stretch, leg);
  return result + text;
}

void stretches() {
  for (bool cone : {false, true})
    for (double stretch : {1.05, 1.1, 1.2, 1.4, 1.8, 2.2, 2.3, 2.4, 2.6, 3.0, 4.0})
      print_row(label("stretch %.2f,", stretch, stretch, cone), segment_of(cone, stretch));
}

void walls() {
  for (bool cone : {false, true})
    for (double stretch : {1.4, 2.2})
      for (bool soft : {false, true})
        for (double wall : {0.1e-3, 0.3e-3, 1e-3, 3e-3, 5e-3}) {
          model::Scene scene = soft ? neo_hookean(cone, stretch) : segment_of(cone, stretch);
          scene.bandage.thickness = wall;
          print_row(label("wall %.1f mm,", 1e3 * wall, stretch, cone, soft ? "n-H" : "law"), scene);
        }
}

void legs() {
  for (bool cone : {false, true})
    for (double stretch : {1.4, 2.2})
      for (double factor : {1e-2, 1e-1, 1.0, 1e1, 1e2, 1e4}) {
        model::Scene scene = neo_hookean(cone, stretch);
        scene.leg.young_modulus *= factor;
        print_row(label("E 80 kPa x %g,", factor, stretch, cone), scene);
      }
}

void bulk_moduli() {
  for (bool cone : {false, true})
    for (double stretch : {1.4, 2.2})
      for (double modulus : {3.7e6, 37e6, 370e6, 3.7e9, 370e9, double(INFINITY)}) {
        model::Scene scene = segment_of(cone, stretch);
        scene.bandage.bulk_modulus = modulus;
        print_row(label("K %g MPa,", 1e-6 * modulus, stretch, cone), scene);
      }
}

model::Scene tapered(double degrees, double stretch) {
  model::Scene scene = segment_of(false, stretch);
  const double rise = 0.5 * scene.leg.segments[0].height * std::tan(degrees * M_PI / 180);
  scene.leg.segments[0].lower_radius -= rise;
  scene.leg.segments[0].upper_radius += rise;
  return scene;
}

void tapers() {
  for (double stretch : {1.4, 1.8, 2.2})
    for (double degrees : {0., 5., 10., 15., 20., 25.})
      print_row(label("taper %.0f deg,", degrees, stretch, degrees > 0), tapered(degrees, stretch));
}

// Sliding slices beside the elements: relative difference of the mean pressures, slips and their difference.
void fidelities() {
  std::printf("%-9s %-7s %-15s %-15s %11s %9s %9s %9s\n", "taper", "stretch", "elements", "sliding",
              "pressure", "differ", "slip mm", "differ");
  for (double degrees : {0., 5., 10., 15., 20.})
    for (double stretch : {1.1, 1.4, 1.8, 2.0, 2.2}) {
      const model::Scene scene = tapered(degrees, stretch);
      const model::SegmentResult fine = elements(scene), coarse = solvers::solve_sliding({&scene, 0}).result;
      std::printf("%4.0f deg  %-7.2f %-15s %-15s %11.3f %8.3f%% %9.4f %9.4f\n", degrees, stretch,
                  name_of(fine.status).c_str(), name_of(coarse.status).c_str(), fine.pressure_rest,
                  100 * (coarse.pressure_rest / fine.pressure_rest - 1), 1e3 * fine.slip_max,
                  1e3 * (coarse.slip_max - fine.slip_max));
    }
}

}  // namespace

int main(int argc, char** argv) {
  petsc::Session session(std::vector<std::string>(argv + 1, argv + argc));
  char chosen[32] = "";
  petsc::check(PetscOptionsGetString(nullptr, nullptr, "-study", chosen, sizeof chosen, nullptr));
  const struct {
    const char* name;
    void (*run)();
  } studies[] = {{"stretch", stretches}, {"wall", walls},   {"leg", legs},
                 {"bulk", bulk_moduli},  {"taper", tapers}, {"fidelities", fidelities}};
  for (const auto& study : studies) {
    if (chosen[0] && std::string(chosen) != study.name) continue;
    std::printf("%s: mesh 0, 1, 2: status, steps, seconds, pressure [Pa] | 2 to 1 | 1 to independent\n",
                study.name);
    study.run();
    std::printf("\n");
  }
}
