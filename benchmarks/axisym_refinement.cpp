// SPDX-License-Identifier: BSD-2-Clause
// The axisymmetric finite elements refined: the paper's ankle segment r6, surrogate elastomer, anchored
// compliance, at stretches 1.4 and 2.2, at rest and under voltage. A row a mesh: unknowns, Newton's
// iterations of both states, and what they say of the contact; below each column the order fitted to the
// changes from mesh to mesh, and how much the finest mesh changes. Then the pressure along the height, beside
// that of the slices and of the sliding slices. Where the stable states end before the voltage, the last
// voltage of each mesh instead. Usage:
// axisym_refinement [-meshes 4] [-order 2] [-stretch 1.4] [-voltage 11300] [-held] [-axisym_...]
#include <cmath>
#include <cstdio>
#include <string>
#include <vector>

#include "axisym_integrals.hpp"
#include "fitted_order.hpp"
#include "gaiter/petsc/check.hpp"
#include "gaiter/petsc/session.hpp"
#include "gaiter/solvers/axisym_case.hpp"
#include "gaiter/solvers/slice_model.hpp"
#include "gaiter/solvers/sliding_model.hpp"
#include "paper_scene.hpp"

namespace {

using namespace gaiter;

struct Quantity {
  const char* name;
  double axisym::ContactIntegrals::*value;
  double unit;
};

std::vector<Quantity> quantities(double stress, double length) {
  using axisym::ContactIntegrals;
  return {{"mean [Pa]", &ContactIntegrals::mean, stress},
          {"area mean", &ContactIntegrals::area_mean, stress},
          {"interior", &ContactIntegrals::interior_mean, stress},
          {"radial [N]", &ContactIntegrals::radial_force, stress * length * length},
          {"axial [N]", &ContactIntegrals::axial_force, stress * length * length},
          {"slip [mm]", &ContactIntegrals::slip, 1e3 * length}};
}

// A state on one mesh after the other.
struct Study {
  std::vector<std::vector<double>> values;  // of each quantity, on each mesh
  std::vector<double> pressures;            // along the height, of the finest mesh

  void print_orders() const {
    std::vector<double> orders, last;
    for (const std::vector<double>& value : values) {
      if (value.size() < 3) return;
      std::vector<double> size, change;
      for (std::size_t k = 1; k < value.size(); ++k) {
        size.push_back(std::ldexp(1.0, -static_cast<int>(k)));
        change.push_back(std::fabs(value[k] - value[k - 1]));
      }
      orders.push_back(fitted_order(size, change));
      last.push_back(change.back() / std::fabs(value.back()));
    }
    std::printf("%-40s", "order");
    for (double order : orders) std::printf(" %11.2f", order);
    std::printf("\n%-40s", "last change, relative");
    for (double change : last) std::printf(" %11.1e", change);
    std::printf("\n");
  }
};

std::vector<double> eleven_heights() {
  std::vector<double> heights;
  for (int k = 0; k < 11; ++k) heights.push_back((k + 0.5) / 11);
  return heights;
}

// The sliding slices' at these heights, linear between them.
std::vector<double> sliding_pressures(const solvers::SlidingProfile& profile, double height) {
  std::vector<double> result;
  for (double relative : eleven_heights()) {
    std::size_t above = 1;
    while (above + 1 < profile.height.size() && profile.height[above] < relative * height) ++above;
    const double place =
        (relative * height - profile.height[above - 1]) / (profile.height[above] - profile.height[above - 1]);
    result.push_back((1 - place) * profile.pressure[above - 1] + place * profile.pressure[above]);
  }
  return result;
}

void print_profiles(const model::Scene& scene, const Study& study, bool actuated) {
  const solvers::SlidingSolution sliding = solvers::solve_sliding({&scene, 0});
  const solvers::SegmentTask task{&scene, 0};
  const model::SegmentResult slice = solvers::solve_segments(PETSC_COMM_SELF, {&task, 1})[0];
  const double height = scene.leg.segments[0].height;
  std::printf("  pressure [Pa] at height");
  for (double relative : eleven_heights()) std::printf(" %6.3f", relative);
  const auto row = [](const char* name, const std::vector<double>& pressures, double mean) {
    std::printf("\n  %-22s", name);
    for (double pressure : pressures) std::printf(" %6.0f", pressure);
    std::printf("   mean %8.2f", mean);
  };
  if (!study.pressures.empty()) row("finite elements", study.pressures, study.values[0].back());
  const auto& profile = actuated ? sliding.actuated : sliding.rest;
  if (!profile.height.empty())
    row("sliding slices", sliding_pressures(profile, height),
        actuated ? sliding.result.pressure_actuated : sliding.result.pressure_rest);
  row("slices", solvers::slice_states(scene, 0, eleven_heights(), actuated).pressure,
      actuated ? slice.pressure_actuated : slice.pressure_rest);
  std::printf("\n");
}

template <int P>
void study(double stretch, double voltage, int meshes, bool held) {
  model::Scene scene = paper::scene(stretch, voltage);
  scene.leg.segments.resize(1);
  scene.bandage.modules.resize(1);
  scene.leg.variant = model::ComplianceVariant::anchored;
  scene.contact_axial = held ? model::ContactAxial::held : model::ContactAxial::free;
  const double stress = solvers::axisym_stress_unit(scene.bandage),
               length = scene.leg.segments[0].mean_radius();
  const auto columns = quantities(stress, length);
  for (bool actuated : {false, true}) {
    std::printf("stretch %.1f, %.1f kV, order %d, %s\nmesh unknowns iterations seconds   kV  open", stretch,
                actuated ? 1e-3 * voltage : 0, P, held ? "held" : "free");
    for (const Quantity& column : columns) std::printf(" %11s", column.name);
    std::printf("\n");
    Study found;
    found.values.resize(columns.size());
    for (int mesh = 0; mesh < meshes; ++mesh) {
      const double start = MPI_Wtime();
      solvers::AxisymCase<P> problem(PETSC_COMM_SELF, scene, 0, 0, mesh);
      solvers::AxisymSummary summary = problem.rest()[0];
      double stable = 0;
      if (actuated && summary.converged) {
        summary = problem.actuated()[0];
        stable = 1e-3 * voltage * summary.stable_voltage;
      }
      PetscInt unknowns = 0;
      petsc::check(MatGetSize(problem.system().matrix(), &unknowns, nullptr));
      std::printf("%4d %8d %10d %7.2f %5.2f", mesh, static_cast<int>(unknowns), summary.iterations,
                  MPI_Wtime() - start, stable);
      if (!summary.converged) {
        std::printf(actuated ? "  the last stable voltage\n" : "  no state\n");
        continue;
      }
      const auto sum = axisym::contact_integrals<P>(problem.system());
      std::printf(" %5d", sum.open);
      for (std::size_t q = 0; q < columns.size(); ++q) {
        found.values[q].push_back(sum.*columns[q].value * columns[q].unit);
        std::printf(" %11.5f", found.values[q].back());
      }
      std::printf("\n");
      found.pressures = axisym::contact_pressures<P>(problem.system(), eleven_heights());
      for (double& pressure : found.pressures) pressure *= stress;
    }
    found.print_orders();
    print_profiles(scene, found, actuated);
    std::printf("\n");
  }
}

int integer_option(const char* name, int value) {
  PetscInt result = value;
  petsc::check(PetscOptionsGetInt(nullptr, nullptr, name, &result, nullptr));
  return static_cast<int>(result);
}

double real_option(const char* name, double value) {
  PetscReal result = value;
  petsc::check(PetscOptionsGetReal(nullptr, nullptr, name, &result, nullptr));
  return result;
}

}  // namespace

int main(int argc, char** argv) {
  petsc::Session session(std::vector<std::string>(argv + 1, argv + argc));
  const int meshes = integer_option("-meshes", 4), order = integer_option("-order", 2);
  const double voltage = real_option("-voltage", 11.3e3), only = real_option("-stretch", 0);
  PetscBool held = PETSC_FALSE;
  petsc::check(PetscOptionsHasName(nullptr, nullptr, "-held", &held));
  for (double stretch : {1.4, 2.2}) {
    if (only > 0 && stretch != only) continue;
    if (order == 2) study<2>(stretch, voltage, meshes, held);
    if (order == 3) study<3>(stretch, voltage, meshes, held);
    if (order == 4) study<4>(stretch, voltage, meshes, held);
  }
}
