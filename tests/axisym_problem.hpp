// SPDX-License-Identifier: BSD-2-Clause
#pragma once

#include <vector>

#include "gaiter/petsc/check.hpp"
#include "gaiter/solvers/axisym_case.hpp"
#include "gaiter/solvers/axisym_solver.hpp"
#include "gaiter/solvers/axisym_start.hpp"

namespace gaiter::axisym {

// The first segment of a scene at rest, on this rank alone. Stays where it is: the solver points to the
// system.
template <int P>
struct Problem {
  solvers::AxisymSystem<P> system;
  solvers::AxisymSolver<P> solver{system};
  petsc::Vector x;

  Problem(const model::Scene& scene, const solvers::AxisymResolution& resolution,
          solvers::AxisymMaterials materials)
      : system(
            PETSC_COMM_SELF,
            solvers::AxisymSpace<P>::make(PETSC_COMM_SELF, solvers::make_axisym_mesh(scene, 0, 0, resolution),
                                          {scene.axisym.multipliers == model::ContactSide::tube,
                                           scene.contact_axial == model::ContactAxial::held}),
            std::move(materials)) {
    petsc::check(DMCreateGlobalVector(system.space().plex.get(), x.out()));
  }
  Problem(const model::Scene& scene, const solvers::AxisymResolution& resolution)
      : Problem(scene, resolution, solvers::axisym_materials(scene, 0, 0)) {}
  Problem(const Problem&) = delete;
  Problem& operator=(const Problem&) = delete;

  double length() const { return system.space().mesh.length; }

  // Puts the slice solution into x.
  void start(const model::Scene& scene) {
    std::vector<solvers::RadialState> states;
    const auto add = [&](const solvers::ContactSurface& surface) {
      std::vector<double> heights;
      for (const auto& node : surface.nodes)
        heights.push_back(node.height * length() / scene.leg.segments[0].height);
      states.push_back(solvers::slice_states(scene, 0, heights, false));
    };
    add(system.space().tubes[0]);
    add(system.space().leg);
    petsc::check(solvers::set_start<P>(system, states, x.get()));
  }

  // Puts a cylinder on a leg that has not given way yet, under a pressure [Pa], into x.
  void start(double radius, double pressure) {
    std::vector<solvers::RadialState> states;
    for (const auto* surface : {&system.space().tubes[0], &system.space().leg}) {
      const auto everywhere = [&](double value) { return std::vector<double>(surface->nodes.size(), value); };
      std::vector<double> heights;
      for (const auto& node : surface->nodes) heights.push_back(node.height * length());
      states.push_back({heights, everywhere(1), everywhere(radius), everywhere(0), everywhere(pressure)});
    }
    petsc::check(solvers::set_start<P>(system, states, x.get()));
  }

  std::vector<double> values() const {
    PetscInt size = 0;
    const PetscScalar* data = nullptr;
    petsc::check(VecGetLocalSize(x.get(), &size));
    petsc::check(VecGetArrayRead(x.get(), &data));
    std::vector<double> result(data, data + size);
    petsc::check(VecRestoreArrayRead(x.get(), &data));
    return result;
  }
};

}  // namespace gaiter::axisym
