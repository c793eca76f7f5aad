// SPDX-License-Identifier: BSD-2-Clause
#include "gaiter/solvers/axisym_case.hpp"

#include <algorithm>
#include <cmath>

#include "gaiter/petsc/check.hpp"
#include "gaiter/petsc/session.hpp"

namespace gaiter::solvers {

namespace {

constexpr double vacuum_permittivity = 8.8541878128e-12;  // [F/m]
constexpr double weakest_spring = 1e-3;  // of the path to the frictionless state, of the shear modulus
constexpr double strongest_spring = 10;
constexpr int most_path_steps = 40;
constexpr double finest_step = 0.01;  // of the path in the square of the voltage, of the full one

bool good(const AxisymReport& report) {
  return report.converged && report.stable;
}

}  // namespace

double axisym_stress_unit(const model::Bandage& bandage) {
  double sum = 0;
  for (const auto& term : bandage.ogden) sum += 0.5 * term.mu * term.alpha;
  return sum;
}

template <int P>
AxisymCase<P>::AxisymCase(MPI_Comm comm, const model::Scene& scene, std::size_t segment, int refinements)
    : scene_(scene), segment_(segment) {
  AxisymResolution resolution;
  resolution.refinements = refinements;
  SpaceChoice choice;
  choice.multipliers_on_tube = scene.axisym.multipliers == model::ContactSide::tube;
  choice.held = scene.contact_axial == model::ContactAxial::held;
  if (scene.axisym.electrostatics == model::Electrostatics::field &&
      scene.bandage.modules[segment].voltage != 0) {
    choice.layers = scene.bandage.layers;
    resolution.tube_columns = choice.layers * ((resolution.tube_columns + choice.layers - 1) / choice.layers);
  }
  AxisymMesh mesh = make_axisym_mesh(scene, segment, segment, resolution);
  const double length = mesh.length;
  auto space = AxisymSpace<P>::make(comm, std::move(mesh), choice);
  system_ = std::make_unique<AxisymSystem<P>>(comm, std::move(space), materials(length));
  solver_ = std::make_unique<AxisymSolver<P>>(*system_);
  petsc::check(DMCreateGlobalVector(system_->space().plex.get(), x_.out()));
  petsc::check(VecDuplicate(x_.get(), kept_.out()));
}

template <int P>
void AxisymCase<P>::try_solver() {
  petsc::check(set_slice_start<P>(*system_, states(false), x_.get()));
  solver_->try_at(x_.get());
}

template <int P>
AxisymSummary AxisymCase<P>::rest() {
  petsc::check(set_slice_start<P>(*system_, states(false), x_.get()));
  AxisymReport report = solver_->solve(x_.get());
  int iterations = report.iterations;
  if (!good(report)) report = follow_spring(iterations);
  return summarise(report, iterations, false);
}

template <int P>
AxisymSummary AxisymCase<P>::actuated() {
  if (scene_.axisym.electrostatics == model::Electrostatics::off) return summarise({true}, 0, false);
  int iterations = 0;
  double reached = 0, step = 1;
  AxisymReport report;
  for (int k = 0; reached < 1 && k < most_path_steps && step > finest_step; ++k) {
    petsc::check(VecCopy(x_.get(), kept_.get()));
    const double target = std::min(1.0, reached + step);
    system_->energise(target);
    report = solver_->solve(x_.get());
    iterations += report.iterations;
    if (good(report)) {
      reached = target;
    } else {
      petsc::check(VecCopy(kept_.get(), x_.get()));
      step *= 0.5;
    }
  }
  // A path from the state at rest that ends on the way: there the branch of stable states ends.
  report.converged = reached == 1;
  report.stable = report.converged;
  AxisymSummary summary = summarise(report, iterations, true);
  summary.stable_voltage = std::sqrt(reached);
  return summary;
}

template <int P>
void AxisymCase<P>::show(bool actuated, const AxisymObserver& observer) const {
  AxisymFields fields = extract_fields(*system_, x_.get());
  fields.actuated = actuated;
  if (petsc::rank(system_->comm()) == 0) observer(std::move(fields));
}

template <int P>
AxisymMaterials AxisymCase<P>::materials(double length) const {
  AxisymMaterials result;
  const double unit = axisym_stress_unit(scene_.bandage), voltage = scene_.bandage.modules[segment_].voltage;
  result.stress = unit;
  for (const auto& term : scene_.bandage.ogden) result.tube.ogden.push_back({term.mu / unit, term.alpha});
  result.tube.bulk_modulus = scene_.bandage.bulk_modulus / unit;
  result.tube.stabilisation = 1;
  result.tube.layers = scene_.bandage.layers;
  result.tube.permittivity =
      vacuum_permittivity * scene_.bandage.permittivity * voltage * voltage / (length * length * unit);
  for (const model::Segment& segment : scene_.leg.segments) {
    physics::LegMaterialLaw law = physics::leg_material(scene_.leg, segment);
    law.shear_modulus /= unit;
    law.bulk_modulus /= unit;
    law.b *= unit;
    law.d *= unit;
    result.leg.push_back(law);
  }
  return result;
}

template <int P>
std::vector<RadialState> AxisymCase<P>::states(bool actuated) const {
  const double height = scene_.leg.segments[segment_].height / system_->space().mesh.length;
  std::vector<RadialState> result;
  const auto add = [&](const ContactSurface& surface) {
    std::vector<double> heights;
    for (const SurfaceNode& node : surface.nodes) heights.push_back(node.height / height);
    result.push_back(slice_states(scene_, segment_, heights, actuated));
  };
  add(system_->space().tubes[0]);
  add(system_->space().leg);
  return result;
}

// From the tube held at its heights, where the slices are all but right, to the free one.
template <int P>
AxisymReport AxisymCase<P>::follow_spring(int& iterations) {
  petsc::check(set_slice_start<P>(*system_, states(false), x_.get()));
  petsc::check(VecCopy(x_.get(), kept_.get()));
  AxisymReport report;
  double spring = strongest_spring, last_spring = 0, factor = 0.25;
  bool released = false, reached = false;
  for (int k = 0; k < most_path_steps && !released; ++k) {
    system_->set_axial_spring(spring);
    report = solver_->solve(x_.get());
    iterations += report.iterations;
    if (good(report)) {
      released = spring == 0;
      reached = true;
      petsc::check(VecCopy(x_.get(), kept_.get()));
      last_spring = spring;
      spring = spring * factor > weakest_spring ? spring * factor : 0;
    } else {
      if (!reached || factor > 0.98) break;
      petsc::check(VecCopy(kept_.get(), x_.get()));
      factor = std::sqrt(factor);
      spring = last_spring * factor;
    }
  }
  system_->set_axial_spring(0);
  report.converged = released;
  report.stable = released || !reached;  // a path that ends on the way: the free tube has no equilibrium
  return report;
}

template <int P>
AxisymSummary AxisymCase<P>::summarise(const AxisymReport& report, int iterations, bool energised) const {
  AxisymSummary summary;
  if (report.converged) summary = summarise_axisym<P>(scene_, segment_, *system_, energised);
  summary.converged = report.converged;
  summary.stable = report.stable;
  summary.iterations = iterations;
  return summary;
}

template class AxisymCase<2>;
template class AxisymCase<3>;
template class AxisymCase<4>;

}  // namespace gaiter::solvers
