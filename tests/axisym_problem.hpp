// SPDX-License-Identifier: BSD-2-Clause
#pragma once

#include <vector>

#include "gaiter/petsc/check.hpp"
#include "gaiter/solvers/axisym_solver.hpp"
#include "gaiter/solvers/axisym_start.hpp"

namespace gaiter::axisym {

// Initial shear modulus of the elastomer: the unit of stress of a problem [Pa].
inline double shear_modulus(const model::Bandage& bandage) {
  double sum = 0;
  for (const auto& term : bandage.ogden) sum += 0.5 * term.mu * term.alpha;
  return sum;
}

inline solvers::AxisymMaterials materials_of(const model::Scene& scene) {
  solvers::AxisymMaterials result;
  result.stress = shear_modulus(scene.bandage);
  for (const auto& term : scene.bandage.ogden)
    result.tube.ogden.push_back({term.mu / result.stress, term.alpha});
  result.tube.bulk_modulus = scene.bandage.bulk_modulus / result.stress;
  result.tube.stabilisation = 1;
  for (const model::Segment& segment : scene.leg.segments) {
    physics::LegMaterialLaw law = physics::leg_material(scene.leg, segment);
    law.shear_modulus /= result.stress;
    law.bulk_modulus /= result.stress;
    law.b *= result.stress;
    law.d *= result.stress;
    result.leg.push_back(law);
  }
  return result;
}

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
      : Problem(scene, resolution, materials_of(scene)) {}
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
    petsc::check(solvers::set_slice_start<P>(system, states, x.get()));
  }

  // Puts a cylinder on a leg that has not given way yet, under a pressure [Pa], into x.
  void start(double radius, double pressure) {
    std::vector<solvers::RadialState> states;
    for (const auto* surface : {&system.space().tubes[0], &system.space().leg}) {
      const std::vector<double> everywhere(surface->nodes.size(), radius);
      states.push_back({everywhere, everywhere, std::vector<double>(surface->nodes.size(), pressure)});
    }
    petsc::check(solvers::set_slice_start<P>(system, states, x.get()));
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
