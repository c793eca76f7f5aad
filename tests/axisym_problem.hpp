// SPDX-License-Identifier: BSD-2-Clause
#pragma once

#include <algorithm>
#include <vector>

#include "gaiter/petsc/check.hpp"
#include "gaiter/solvers/axisym_case.hpp"
#include "gaiter/solvers/axisym_solver.hpp"
#include "gaiter/solvers/axisym_start.hpp"

namespace gaiter::axisym {

// The first segment of a scene at rest, or with AxisymScope::leg all of them, on this rank alone. Has a
// potential as in AxisymCase. Stays where it is: the solver points to the system.
template <int P>
struct Problem {
  solvers::AxisymSystem<P> system;
  solvers::AxisymSolver<P> solver{system};
  petsc::Vector x;

  Problem(const model::Scene& scene, const solvers::AxisymResolution& resolution,
          solvers::AxisymMaterials materials)
      : system(
            PETSC_COMM_SELF,
            solvers::AxisymSpace<P>::make(
                PETSC_COMM_SELF, solvers::make_axisym_mesh(scene, 0, last(scene), layered(scene, resolution)),
                {scene.axisym.multipliers == model::ContactSide::tube,
                 scene.contact_axial == model::ContactAxial::held, layers(scene)}),
            std::move(materials)) {
    petsc::check(DMCreateGlobalVector(system.space().plex.get(), x.out()));
  }
  Problem(const model::Scene& scene, const solvers::AxisymResolution& resolution)
      : Problem(scene, resolution, solvers::axisym_materials(scene, 0, last(scene))) {}
  Problem(const Problem&) = delete;
  Problem& operator=(const Problem&) = delete;

  static std::size_t last(const model::Scene& scene) {
    return scene.axisym.scope == model::AxisymScope::leg ? scene.leg.segments.size() - 1 : 0;
  }
  // Of the potential's space: 0 where there is none.
  static int layers(const model::Scene& scene) {
    double voltage = 0;
    for (std::size_t s = 0; s <= last(scene); ++s) voltage += scene.bandage.modules[s].voltage;
    const bool field = scene.axisym.electrostatics == model::Electrostatics::field;
    return field && voltage > 0 ? scene.bandage.layers : 0;
  }
  static solvers::AxisymResolution layered(const model::Scene& scene, solvers::AxisymResolution resolution) {
    const int count = std::max(1, layers(scene));
    resolution.tube_columns = count * ((resolution.tube_columns + count - 1) / count);
    return resolution;
  }

  double length() const { return system.space().mesh.length; }

  // Puts the slice solution into x.
  void start(const model::Scene& scene) {
    std::vector<solvers::RadialState> states;
    solvers::RadialState leg;
    const auto& space = system.space();
    double bottom = 0;
    for (std::size_t s = 0; s < space.tubes.size(); ++s) {
      const double height = scene.leg.segments[s].height, top = bottom + height;
      std::vector<double> of_tube, of_leg;
      for (const auto& node : space.tubes[s].nodes)
        of_tube.push_back((node.height * length() - bottom) / height);
      const bool last_one = s + 1 == space.tubes.size();
      for (const auto& node : space.leg.nodes) {
        const double relative = (node.height * length() - bottom) / height;
        if (relative > -1e-9 && (relative < 1 - 1e-9 || last_one)) of_leg.push_back(relative);
      }
      states.push_back(solvers::slice_states(scene, s, of_tube, false));
      for (double& at : states.back().height) at += bottom;
      const solvers::RadialState piece = solvers::slice_states(scene, s, of_leg, false);
      leg.leg_strain.insert(leg.leg_strain.end(), piece.leg_strain.begin(), piece.leg_strain.end());
      leg.pressure.insert(leg.pressure.end(), piece.pressure.begin(), piece.pressure.end());
      bottom = top;
    }
    states.push_back(leg);
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
