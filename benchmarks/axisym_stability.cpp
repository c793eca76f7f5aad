// SPDX-License-Identifier: BSD-2-Clause
// Where the stable equilibria of a bandage that slides without friction end, in stretch: a branch of the
// axisymmetric finite elements at rest, followed at growing stretches with steps that are halved where
// Newton's method fails or the state is not stable any more. A row a mesh: the last stable stretch, its mean
// pressure and open contacts; lambda there, the smallest eigenvalue of the tangent in relation to the
// displacements of the tube's inner face (a spring per area of it, over shear modulus and leg radius; at a
// fold it falls with the root of the distance: -trace 1 shows it); of its eigenvector the sign changes of the
// radial displacement along the tube, where that is largest, from 0 at the narrow end to 1, and the ratio of
// the largest radial to the largest axial displacement. The last row is that of the sliding slices. Usage:
// axisym_stability [-meshes 4] [-first 1.8] [-last 4] [-trace 1]
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <memory>
#include <string>
#include <vector>

#include "axisym_integrals.hpp"
#include "axisym_problem.hpp"
#include "gaiter/petsc/session.hpp"
#include "gaiter/solvers/sliding_model.hpp"
#include "paper_scene.hpp"

namespace {

using namespace gaiter;
using KspHandle = petsc::Handle<KSP, KSPDestroy>;

constexpr double finest_step = 2e-5;  // of the stretch
constexpr int inverse_iterations = 40;

double option(const char* name, double value) {
  petsc::check(PetscOptionsGetReal(nullptr, nullptr, name, &value, nullptr));
  return value;
}

struct Mode {
  double eigenvalue = NAN, place = NAN, radial = NAN;
  int sign_changes = 0;
};

// Inverse iteration K y = M x, M the lengths of the nodes of the tube's inner face at their displacements.
template <int P>
PetscErrorCode lowest_mode(axisym::Problem<P>& problem, Mode& mode) {
  PetscFunctionBegin;
  const auto& nodes = problem.system.space().tubes[0].nodes;
  petsc::Vector load, shape;
  PetscCall(VecDuplicate(problem.x.get(), load.out()));
  PetscCall(VecDuplicate(problem.x.get(), shape.out()));
  bool admissible = true;
  PetscCall(problem.system.evaluate(problem.x.get(), load.get(), admissible));
  PetscCall(problem.system.assemble());
  KspHandle ksp;
  PC pc = nullptr;
  PetscCall(KSPCreate(PETSC_COMM_SELF, ksp.out()));
  PetscCall(KSPSetOperators(ksp.get(), problem.system.matrix(), problem.system.matrix()));
  PetscCall(KSPSetType(ksp.get(), KSPPREONLY));
  PetscCall(KSPGetPC(ksp.get(), &pc));
  PetscCall(PCSetType(pc, PCLU));
  PetscCall(PCFactorSetMatSolverType(pc, MATSOLVERMUMPS));
  // Along and across, a node after the other.
  std::vector<PetscInt> unknown;
  std::vector<double> value, length;
  for (std::size_t i = 0; i < nodes.size(); ++i)
    for (PetscInt u : {nodes[i].u_z, nodes[i].u_r}) {
      unknown.push_back(u);
      length.push_back(0.5 * (nodes[std::min(i + 1, nodes.size() - 1)].height - nodes[i ? i - 1 : 0].height));
      value.push_back(u < 0 ? 0 : std::sin(1.0 + 3.0 * static_cast<double>(unknown.size())));
    }
  for (int iteration = 0; iteration < inverse_iterations; ++iteration) {
    PetscCall(VecSet(load.get(), 0));
    PetscCall(VecSetOption(load.get(), VEC_IGNORE_NEGATIVE_INDICES, PETSC_TRUE));
    for (std::size_t i = 0; i < unknown.size(); ++i)
      PetscCall(VecSetValue(load.get(), unknown[i], length[i] * value[i], INSERT_VALUES));
    PetscCall(VecAssemblyBegin(load.get()));
    PetscCall(VecAssemblyEnd(load.get()));
    PetscCall(KSPSolve(ksp.get(), load.get(), shape.get()));
    const PetscScalar* entries = nullptr;
    PetscCall(VecGetArrayRead(shape.get(), &entries));
    double product = 0, norm = 0;
    for (std::size_t i = 0; i < unknown.size(); ++i) {
      const double next = unknown[i] < 0 ? 0 : entries[unknown[i]];
      product += length[i] * next * value[i];
      norm += length[i] * next * next;
      value[i] = next;
    }
    PetscCall(VecRestoreArrayRead(shape.get(), &entries));
    mode.eigenvalue = product / norm;
    for (double& v : value) v /= std::sqrt(norm);
  }
  double last = 0, largest[2] = {0, 0};
  for (std::size_t i = 0; i < value.size(); ++i)
    if (std::fabs(value[i]) > largest[i % 2]) {
      largest[i % 2] = std::fabs(value[i]);
      if (i % 2) mode.place = nodes[i / 2].height / nodes.back().height;
    }
  mode.radial = largest[1] / largest[0];
  for (std::size_t i = 1; i < value.size(); i += 2)
    if (std::fabs(value[i]) > 0.1 * largest[1]) {
      mode.sign_changes += last * value[i] < 0;
      last = value[i];
    }
  PetscFunctionReturn(PETSC_SUCCESS);
}

// The displacements of one stretch at another, whose tube has another radius: the same current places.
template <int P>
PetscErrorCode carry_over(const axisym::Problem<P>& from, axisym::Problem<P>& to) {
  PetscFunctionBegin;
  PetscCall(VecCopy(from.x.get(), to.x.get()));
  const auto &old_cells = from.system.space().cells, &cells = to.system.space().cells;
  const PetscScalar* old_values = nullptr;
  PetscScalar* values = nullptr;
  PetscCall(VecGetArrayRead(from.x.get(), &old_values));
  PetscCall(VecGetArray(to.x.get(), &values));
  for (std::size_t c = 0; c < cells.size(); ++c)
    for (int node = 0; node < (P + 1) * (P + 1); ++node) {
      const PetscInt place = cells[c].global[2 * node];
      if (place >= 0)
        values[place] =
            old_values[place] + old_cells[c].geometry.position[node][0] - cells[c].geometry.position[node][0];
    }
  PetscCall(VecRestoreArray(to.x.get(), &values));
  PetscCall(VecRestoreArrayRead(from.x.get(), &old_values));
  PetscFunctionReturn(PETSC_SUCCESS);
}

template <int P>
void follow(model::Scene scene, int refinements) {
  solvers::AxisymResolution resolution;
  resolution.refinements = refinements;
  double stretch = option("-first", 1.8), step = 0.1;
  const double last = option("-last", 4);
  std::unique_ptr<axisym::Problem<P>> here;
  const char* end = "";
  while (step > finest_step && stretch < last) {
    scene.bandage.modules[0].stretch = here ? stretch + step : stretch;
    auto next = std::make_unique<axisym::Problem<P>>(scene, resolution);
    if (here)
      petsc::check(carry_over<P>(*here, *next));
    else
      next->start(scene);
    const auto report = next->solver.solve(next->x.get());
    if (report.converged && report.stable) {
      if (here) stretch += step;
      here = std::move(next);
      if (option("-trace", 0) > 0) {
        Mode mode;
        petsc::check(lowest_mode<P>(*here, mode));
        std::printf("  %7.4f %d steps, lambda %9.2e, %d sign changes, place %.3f, radial %.2f\n", stretch,
                    report.iterations, mode.eigenvalue, mode.sign_changes, mode.place, mode.radial);
      }
    } else {
      end = report.converged ? "not stable" : "not converged";
      step *= 0.5;
      if (!here) break;
    }
  }
  std::printf("order %d, mesh %d ", P, refinements);
  if (!here) {
    std::printf("%s at the first stretch\n", end);
    return;
  }
  Mode mode;
  petsc::check(lowest_mode<P>(*here, mode));
  const auto sum = axisym::contact_integrals<P>(here->system);
  std::printf("%7.4f %10.2f %4d  %9.2e %4d %6.3f %6.2f  beyond: %s\n", stretch,
              sum.mean * here->system.materials().stress, sum.open, mode.eigenvalue, mode.sign_changes,
              mode.place, mode.radial, end);
  std::fflush(stdout);
}

void follow_slices(model::Scene scene) {
  double stretch = option("-first", 1.8), step = 0.1, pressure = NAN;
  while (step > finest_step && stretch < option("-last", 4)) {
    scene.bandage.modules[0].stretch = stretch + step;
    const auto result = solvers::solve_sliding({&scene, 0}).result;
    if (model::trustworthy(result.status)) {
      stretch += step;
      pressure = result.pressure_rest;
    } else {
      step *= 0.5;
    }
  }
  std::printf("sliding slices  %7.4f %10.2f\n", stretch, pressure);
}

void study(const char* name, const model::Scene& scene) {
  std::printf("%s\n%-15s %7s %10s %4s  %9s %4s %6s %6s\n", name, "", "stretch", "mean [Pa]", "open", "lambda",
              "sign", "place", "radial");
  const int meshes = static_cast<int>(option("-meshes", 4));
  for (int mesh = 0; mesh < meshes; ++mesh) follow<2>(scene, mesh);
  for (int mesh = 0; mesh + 1 < meshes; ++mesh) follow<3>(scene, mesh);
  follow_slices(scene);
  std::printf("\n");
}

}  // namespace

int main(int argc, char** argv) {
  petsc::Session session(std::vector<std::string>(argv + 1, argv + argc));
  for (bool neo_hookean : {false, true})
    for (bool cone : {false, true}) {
      model::Scene scene = paper::cylinder(39.61e-3, 1);
      scene.leg.variant = model::ComplianceVariant::anchored;
      scene.leg.data_limit = INFINITY;
      if (neo_hookean) scene.leg.material = model::LegMaterial::neo_hookean;
      if (cone) {
        scene.leg.segments[0].lower_radius = 35.85e-3;
        scene.leg.segments[0].upper_radius = 43.37e-3;
      }
      study((std::string(cone ? "cone" : "cylinder") + (neo_hookean ? ", neo-Hookean leg" : ", compliance"))
                .c_str(),
            scene);
    }
}
