// SPDX-License-Identifier: BSD-2-Clause
#include "gaiter/solvers/axisym_case.hpp"

#include <algorithm>
#include <cmath>

#include "gaiter/petsc/check.hpp"
#include "gaiter/petsc/session.hpp"
#include "gaiter/solvers/axisym_prolong.hpp"

namespace gaiter::solvers {

namespace {

constexpr double vacuum_permittivity = 8.8541878128e-12;  // [F/m]
constexpr int most_path_steps = 40;
constexpr double weakest_spring = 1e-3;  // of the path to the frictionless state, of the shear modulus
constexpr double strongest_spring = 10;
constexpr double stiffest_leg = 100;  // of the path to the state at rest, times its own stiffness
constexpr double leg_stride = 0.1, spring_stride = 0.25;  // first factors between two places on these paths
constexpr double shortest_stride = 0.9;
constexpr int most_path_iterations = 12;  // Newton's, of a step on a path: one that gets there needs fewer
constexpr double finest_step = 0.02;      // of the voltage's square, over where it leads: 1 % of the voltage

bool good(const AxisymReport& report) {
  return report.converged && report.stable;
}

// The same scene on a leg that needs `factor` times the pressure for the same deformation.
model::Scene with_stiffer_leg(model::Scene scene, double factor) {
  scene.leg.young_modulus *= factor;
  scene.leg.shear_modulus *= factor;
  for (model::Segment& segment : scene.leg.segments) {
    segment.compliance.b /= factor;
    segment.compliance.d /= factor;
  }
  return scene;
}

}  // namespace

double axisym_stress_unit(const model::Bandage& bandage) {
  double sum = 0;
  for (const auto& term : bandage.ogden) sum += 0.5 * term.mu * term.alpha;
  return sum;
}

AxisymMaterials axisym_materials(const model::Scene& scene, std::size_t first, std::size_t last) {
  AxisymMaterials result;
  const double unit = axisym_stress_unit(scene.bandage);
  const double length = scene.leg.segments[first].mean_radius();  // as of the mesh
  result.stress = unit;
  for (std::size_t segment = first; segment <= last; ++segment) {
    physics::TubeMaterial& tube = result.tubes.emplace_back();
    const double voltage = scene.bandage.modules[segment].voltage;
    for (const auto& term : scene.bandage.ogden) tube.ogden.push_back({term.mu / unit, term.alpha});
    tube.bulk_modulus = scene.bandage.bulk_modulus / unit;
    tube.stabilisation = 1;
    tube.layers = scene.bandage.layers;
    tube.permittivity =
        vacuum_permittivity * scene.bandage.permittivity * voltage * voltage / (length * length * unit);
  }
  for (const model::Segment& segment : scene.leg.segments) {
    physics::LegMaterialLaw law = physics::leg_material(scene.leg, segment);
    law.shear_modulus /= unit;
    law.bulk_modulus /= unit;
    law.b *= unit;
    law.d *= unit;
    result.leg.push_back(law);
  }
  return result;
}

template <int P>
AxisymCase<P>::AxisymCase(MPI_Comm comm, const model::Scene& scene, std::size_t first, std::size_t last,
                          AxisymResolution resolution)
    : scene_(scene), first_(first), last_(last) {
  SpaceChoice choice;
  choice.multipliers_on_tube = scene.axisym.multipliers == model::ContactSide::tube;
  choice.held = scene.contact_axial == model::ContactAxial::held;
  const auto& modules = scene.bandage.modules;
  const bool voltage = std::any_of(modules.begin() + first, modules.begin() + last + 1,
                                   [](const model::Module& module) { return module.voltage != 0; });
  if (scene.axisym.electrostatics == model::Electrostatics::field && voltage) {
    choice.layers = scene.bandage.layers;
    resolution.tube_columns = choice.layers * ((resolution.tube_columns + choice.layers - 1) / choice.layers);
  }
  AxisymMesh mesh = make_axisym_mesh(scene, first, last, resolution);
  auto space = AxisymSpace<P>::make(comm, std::move(mesh), choice);
  system_ = std::make_unique<AxisymSystem<P>>(comm, std::move(space), axisym_materials(scene, first, last));
  solver_ = std::make_unique<AxisymSolver<P>>(*system_);
  petsc::check(DMCreateGlobalVector(system_->space().plex.get(), x_.out()));
  for (petsc::Vector* vector : {&kept_, &rest_, &actuated_})
    petsc::check(VecDuplicate(x_.get(), vector->out()));
}

template <int P>
void AxisymCase<P>::try_solver() {
  petsc::check(set_start<P>(*system_, slices(scene_), x_.get()));
  solver_->try_at(x_.get());
}

template <int P>
std::vector<AxisymSummary> AxisymCase<P>::rest() {
  int iterations = 0;
  AxisymReport report = solve_from(scene_, iterations);
  if (!good(report)) report = soften_leg(iterations);
  if (!report.converged && report.stable) report = follow_spring(iterations);
  return summarise(report, iterations, false);
}

template <int P>
std::vector<AxisymSummary> AxisymCase<P>::actuated() {
  const bool off = scene_.axisym.electrostatics == model::Electrostatics::off;
  int iterations = 0;
  double reached = 0;
  // Where the path is to lead, last of all to the full voltage. Each target that fails is tried again from
  // half way to it, and so the last one from close by.
  std::vector<double> targets;
  if (!off) targets.push_back(1);
  for (int k = 0; !targets.empty() && k < most_path_steps; ++k) {
    const double target = targets.back();
    petsc::check(VecCopy(x_.get(), kept_.get()));
    system_->energise(target);
    const AxisymReport report = solver_->solve(x_.get(), most_path_iterations);
    iterations += report.iterations;
    if (good(report)) {
      reached = target;
      targets.pop_back();
      continue;
    }
    petsc::check(VecCopy(kept_.get(), x_.get()));
    if (target - reached < finest_step * target) break;
    targets.push_back(0.5 * (reached + target));
  }
  // A path from the state at rest that ends on the way: there the branch of stable states ends.
  const bool arrived = targets.empty();
  std::vector<AxisymSummary> summaries = summarise({arrived, arrived}, iterations, !off);
  for (AxisymSummary& summary : summaries) summary.stable_voltage = off ? NAN : std::sqrt(reached);
  return summaries;
}

template <int P>
bool AxisymCase<P>::take_model(model::Fidelity fidelity, bool actuated) {
  const bool slides = fidelity == model::Fidelity::sliding;
  std::vector<SlidingProfile> profiles;
  for (std::size_t segment = first_; slides && segment <= last_; ++segment) {
    SlidingSolution solution = solve_sliding({&scene_, segment});
    if (!model::trustworthy(solution.result.status)) return false;
    profiles.push_back(std::move(actuated ? solution.actuated : solution.rest));
  }
  const Source source = [&](std::size_t segment, std::span<const double> heights, bool of_tube) {
    return slides ? sliding_states(scene_, segment, profiles[segment - first_], heights, of_tube)
                  : slice_states(scene_, segment, heights, actuated);
  };
  system_->energise(actuated ? 1 : 0);
  petsc::check(set_start<P>(*system_, states(source), x_.get()));
  return true;
}

// Back to a state that was found.
template <int P>
void AxisymCase<P>::recall(bool energised) {
  bool admissible = true;
  petsc::check(VecCopy((energised ? actuated_ : rest_).get(), x_.get()));
  system_->energise(energised ? 1 : 0);
  petsc::check(system_->evaluate(x_.get(), kept_.get(), admissible));
}

template <int P>
AxisymReport AxisymCase<P>::solve_from(AxisymCase& coarser, bool energised) {
  coarser.recall(energised);
  system_->energise(energised ? 1 : 0);
  petsc::check(prolongate<P, P>(coarser.system(), coarser.state(), *system_, x_.get()));
  return solver_->solve(x_.get(), most_path_iterations);
}

template <int P>
std::vector<AxisymSummary> AxisymCase<P>::rest(AxisymCase& coarser) {
  const AxisymReport report = solve_from(coarser, false);
  return good(report) ? summarise(report, report.iterations, false) : rest();
}

template <int P>
std::vector<AxisymSummary> AxisymCase<P>::actuated(AxisymCase& coarser) {
  if (scene_.axisym.electrostatics == model::Electrostatics::off) return actuated();
  const AxisymReport report = solve_from(coarser, true);
  if (good(report)) return summarise(report, report.iterations, true);
  recall(false);
  return actuated();
}

template <int P>
int AxisymCase<P>::unknowns() const {
  PetscInt size = 0;
  petsc::check(VecGetSize(x_.get(), &size));
  return static_cast<int>(size);
}

template <int P>
void AxisymCase<P>::show(bool actuated, const AxisymObserver& observer) const {
  AxisymFields fields = extract_fields(*system_, x_.get());
  fields.actuated = actuated;
  if (petsc::rank(system_->comm()) == 0) observer(std::move(fields));
}

// The states of all blocks, segment by segment. Where two segments of the leg meet, the mean of both.
template <int P>
std::vector<RadialState> AxisymCase<P>::states(const Source& source) const {
  const AxisymSpace<P>& space = system_->space();
  const double length = space.mesh.length;
  std::vector<RadialState> result;
  RadialState leg;
  std::size_t row = 0;
  for (std::size_t segment = first_; segment <= last_; ++segment) {
    const AxisymBlock& tube = space.mesh.blocks[segment - first_];
    const double bottom = tube.height.front(), height = tube.height.back() - bottom;
    const auto heights = [&](const ContactSurface& surface, std::size_t from, std::size_t to) {
      std::vector<double> relative;
      for (std::size_t i = from; i <= to; ++i)
        relative.push_back((surface.nodes[i].height - bottom) / height);
      return relative;
    };
    const ContactSurface& face = space.tubes[segment - first_];
    result.push_back(source(segment, heights(face, 0, face.nodes.size() - 1), true));
    for (double& current : result.back().height) current += bottom * length;

    const std::vector<std::size_t>& rows = space.mesh.leg().segment;
    const std::size_t from = P * row;
    while (row < rows.size() && rows[row] == segment) ++row;
    const RadialState piece = source(segment, heights(space.leg, from, P * row), false);
    for (auto member : {&RadialState::leg_strain, &RadialState::pressure}) {
      std::vector<double>& all = leg.*member;
      if (!all.empty()) all.back() = 0.5 * (all.back() + (piece.*member).front());
      all.insert(all.end(), (piece.*member).begin() + (all.empty() ? 0 : 1), (piece.*member).end());
    }
  }
  result.push_back(std::move(leg));
  return result;
}

template <int P>
std::vector<RadialState> AxisymCase<P>::slices(const model::Scene& scene) const {
  return states([&](std::size_t segment, std::span<const double> heights, bool) {
    RadialState state = slice_states(scene, segment, heights, false);
    open_ends(scene, segment, state);
    return state;
  });
}

// At rest, segment by segment: the slices' where the tubes are held, and where the sliding ones have no
// answer.
template <int P>
std::vector<RadialState> AxisymCase<P>::sliding(const model::Scene& scene) const {
  if (scene.contact_axial == model::ContactAxial::held) return slices(scene);
  model::Scene at_rest = scene;
  for (model::Module& module : at_rest.bandage.modules) module.voltage = 0;
  std::vector<SlidingProfile> profiles;
  for (std::size_t segment = first_; segment <= last_; ++segment) {
    SlidingSolution solution = solve_sliding({&at_rest, segment});
    const bool found = model::trustworthy(solution.result.status);
    profiles.push_back(found ? std::move(solution.rest) : SlidingProfile());
  }
  return states([&](std::size_t segment, std::span<const double> heights, bool of_tube) {
    const SlidingProfile& profile = profiles[segment - first_];
    RadialState state = profile.height.empty() ? slice_states(scene, segment, heights, false)
                                               : sliding_states(scene, segment, profile, heights, of_tube);
    open_ends(scene, segment, state);
    return state;
  });
}

// At rest, on the leg of a scene, from what simpler models say of it.
template <int P>
AxisymReport AxisymCase<P>::solve_from(const model::Scene& scene, int& iterations) {
  system_->set_leg(axisym_materials(scene, first_, last_).leg);
  petsc::check(set_start<P>(*system_, sliding(scene), x_.get()));
  const AxisymReport report = solver_->solve(x_.get());
  iterations += report.iterations;
  return report;
}

// From a leg that hardly gives way, where the start is all but right, to the scene's own.
template <int P>
AxisymReport AxisymCase<P>::soften_leg(int& iterations) {
  double stiffness = stiffest_leg, stride = leg_stride;
  AxisymReport report = solve_from(with_stiffer_leg(scene_, stiffness), iterations);
  const bool reached = good(report);
  for (int k = 0; reached && stiffness > 1 && k < most_path_steps && stride < shortest_stride; ++k) {
    petsc::check(VecCopy(x_.get(), kept_.get()));
    const double target = std::max(1.0, stiffness * stride);
    system_->set_leg(axisym_materials(with_stiffer_leg(scene_, target), first_, last_).leg);
    report = solver_->solve(x_.get(), most_path_iterations);
    iterations += report.iterations;
    if (good(report)) {
      stiffness = target;
    } else {
      petsc::check(VecCopy(kept_.get(), x_.get()));
      stride = std::sqrt(stride);
    }
  }
  system_->set_leg(axisym_materials(scene_, first_, last_).leg);
  report.converged = reached && stiffness == 1;
  report.stable = report.converged || !reached;  // a path that ends on the way: no equilibrium on this leg
  return report;
}

// From the tube held at its heights, where the slices are all but right, to the free one.
template <int P>
AxisymReport AxisymCase<P>::follow_spring(int& iterations) {
  petsc::check(set_start<P>(*system_, slices(scene_), x_.get()));
  petsc::check(VecCopy(x_.get(), kept_.get()));
  AxisymReport report;
  double spring = strongest_spring, last_spring = 0, stride = spring_stride;
  bool released = false, reached = false;
  for (int k = 0; k < most_path_steps && !released && stride < shortest_stride; ++k) {
    system_->set_axial_spring(spring);
    report = reached ? solver_->solve(x_.get(), most_path_iterations) : solver_->solve(x_.get());
    iterations += report.iterations;
    if (good(report)) {
      released = spring == 0;
      reached = true;
      petsc::check(VecCopy(x_.get(), kept_.get()));
      last_spring = spring;
    } else {
      if (!reached) break;
      petsc::check(VecCopy(kept_.get(), x_.get()));
      stride = std::sqrt(stride);
    }
    spring = last_spring * stride > weakest_spring ? last_spring * stride : 0;
  }
  system_->set_axial_spring(0);
  report.converged = released;
  report.stable = released || !reached;  // a path that ends on the way: the free tube has no equilibrium
  return report;
}

template <int P>
std::vector<AxisymSummary> AxisymCase<P>::summarise(const AxisymReport& report, int iterations,
                                                    bool energised) {
  if (report.converged) petsc::check(VecCopy(x_.get(), (energised ? actuated_ : rest_).get()));
  std::vector<AxisymSummary> summaries;
  for (std::size_t segment = first_; segment <= last_; ++segment) {
    AxisymSummary summary;
    if (report.converged)
      summary = summarise_axisym<P>(scene_, segment, *system_, static_cast<int>(segment - first_), energised);
    summary.converged = report.converged;
    summary.stable = report.stable;
    summary.iterations = iterations;
    summaries.push_back(summary);
  }
  return summaries;
}

template class AxisymCase<2>;
template class AxisymCase<3>;
template class AxisymCase<4>;

}  // namespace gaiter::solvers
