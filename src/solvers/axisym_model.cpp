// SPDX-License-Identifier: BSD-2-Clause
#include "gaiter/solvers/axisym_model.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "gaiter/solvers/axisym_case.hpp"

namespace gaiter::solvers {

namespace {

using model::Status;

struct Solved {
  AxisymSummary rest, actuated;
};

template <int P>
Solved solve_states(MPI_Comm comm, const SegmentTask& task, int refine, const AxisymObserver& observer) {
  AxisymCase<P> problem(comm, *task.scene, task.segment, refine);
  Solved solved;
  solved.rest = problem.rest();
  if (observer && solved.rest.converged) problem.show(false, observer);
  const bool voltage = task.scene->bandage.modules[task.segment].voltage != 0;
  solved.actuated = voltage && solved.rest.converged ? problem.actuated() : solved.rest;
  if (observer && voltage && solved.actuated.converged) problem.show(true, observer);
  return solved;
}

Solved solve_states(MPI_Comm comm, const SegmentTask& task, int refine, const AxisymObserver& observer = {}) {
  switch (task.scene->axisym.order) {
    case 3:
      return solve_states<3>(comm, task, refine, observer);
    case 4:
      return solve_states<4>(comm, task, refine, observer);
    default:
      return solve_states<2>(comm, task, refine, observer);
  }
}

Status status_of(const Solved& solved, const model::Scene& scene, double unit) {
  const auto failure = [](const AxisymSummary& state) {
    return state.stable ? Status::diverged : Status::no_equilibrium;
  };
  if (!solved.rest.converged) return failure(solved.rest);
  if (!solved.actuated.converged) return failure(solved.actuated);
  const double highest = std::max(solved.rest.highest_pressure, solved.actuated.highest_pressure) * unit;
  if (scene.leg.material == model::LegMaterial::compliance && highest > scene.leg.data_limit)
    return Status::extrapolated;
  if (solved.rest.open_everywhere) return Status::slack;
  if (solved.actuated.open_everywhere) return Status::lifted;
  return Status::contact;
}

model::SegmentResult solve_task(MPI_Comm comm, const SegmentTask& task, const AxisymObserver& observer) {
  const model::Scene& scene = *task.scene;
  const model::Segment& segment = scene.leg.segments[task.segment];
  const double unit = axisym_stress_unit(scene.bandage), length = segment.mean_radius();
  const int refine = scene.axisym.refine;
  const Solved fine = solve_states(comm, task, refine, observer);

  // The pressures on a rigid leg are the slices'; so are those that nothing else gives.
  model::Scene slices = scene;
  slices.fidelity = model::Fidelity::rigid;
  const SegmentTask rigid_task{&slices, task.segment};
  const model::SegmentResult rigid = solve_segments(PETSC_COMM_SELF, {&rigid_task, 1})[0];

  model::SegmentResult result;
  constexpr double none = std::numeric_limits<double>::quiet_NaN();
  result.fidelity = model::Fidelity::axisym;
  result.status = status_of(fine, scene, unit);
  result.iterations = std::max(fine.rest.iterations, fine.actuated.iterations);
  result.pressure_rest_rigid = rigid.pressure_rest_rigid;
  result.pressure_actuated_rigid = rigid.pressure_actuated_rigid;
  result.volume_initial = rigid.volume_initial;
  const bool good = model::trustworthy(result.status);
  const auto put = [&](double value) { return good ? value : none; };
  const double volume = length * length * length;
  result.pressure_rest = put(fine.rest.pressure * unit);
  result.pressure_actuated = put(fine.actuated.pressure * unit);
  result.pressure_rest_area_mean = put(fine.rest.pressure_area * unit);
  result.pressure_actuated_area_mean = put(fine.actuated.pressure_area * unit);
  model::derive_changes(result);
  result.actuation_pressure = put(fine.actuated.maxwell * unit);
  result.volume_rest = put(fine.rest.volume * volume);
  result.volume_actuated = put(fine.actuated.volume * volume);
  result.volume_change = (result.volume_initial - result.volume_actuated) / result.volume_initial;
  result.radius_actuated = put(fine.actuated.radius * length);
  result.stretch_actual = put(fine.rest.stretch);
  result.slip_max = put(std::max(fine.rest.slip, fine.actuated.slip) * length);
  result.electric_field_max = put(fine.actuated.field * scene.bandage.modules[task.segment].voltage / length);
  result.error_estimate = none;
  if (good && refine > 0) {
    const Solved coarse = solve_states(comm, task, refine - 1);
    const auto change = [](double a, double b) { return b != 0 ? std::fabs(a / b - 1) : 0; };
    if (coarse.rest.converged && coarse.actuated.converged)
      result.error_estimate = std::max(change(coarse.rest.pressure, fine.rest.pressure),
                                       change(coarse.actuated.pressure, fine.actuated.pressure));
  }
  return result;
}

}  // namespace

std::vector<model::SegmentResult> solve_axisym(MPI_Comm comm, std::span<const SegmentTask> tasks,
                                               const AxisymObserver& observer) {
  std::vector<model::SegmentResult> results;
  for (const SegmentTask& task : tasks) results.push_back(solve_task(comm, task, observer));
  return results;
}

void try_axisym(MPI_Comm comm, const SegmentTask& task) {
  AxisymCase<2>(comm, *task.scene, task.segment, 0).try_solver();
}

}  // namespace gaiter::solvers
