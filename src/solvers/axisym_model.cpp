// SPDX-License-Identifier: BSD-2-Clause
#include "gaiter/solvers/axisym_model.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "gaiter/solvers/axisym_case.hpp"

namespace gaiter::solvers {

namespace {

using model::Status;

constexpr double none = std::numeric_limits<double>::quiet_NaN();

struct Solved {
  std::vector<AxisymSummary> rest, actuated;  // a segment each
  int unknowns = 0;
  bool converged() const { return rest[0].converged && actuated[0].converged; }
};

// Segments first to last of a scene on one mesh.
struct Piece {
  const model::Scene& scene;
  std::size_t first, last;
  bool actuated = true;  // whether the state under voltage is wanted
};

template <int P>
Solved solve_states(MPI_Comm comm, const Piece& piece, int refine, const AxisymObserver& observer) {
  AxisymCase<P> problem(comm, piece.scene, piece.first, piece.last, refine);
  Solved solved;
  solved.unknowns = problem.unknowns();
  solved.rest = problem.rest();
  if (observer && solved.rest[0].converged) problem.show(false, observer);
  const auto& modules = piece.scene.bandage.modules;
  const bool voltage = std::any_of(modules.begin() + piece.first, modules.begin() + piece.last + 1,
                                   [](const model::Module& module) { return module.voltage != 0; });
  const bool actuate = voltage && piece.actuated && solved.rest[0].converged;
  solved.actuated = actuate ? problem.actuated() : solved.rest;
  if (observer && actuate && solved.actuated[0].converged) problem.show(true, observer);
  return solved;
}

Solved solve_states(MPI_Comm comm, const Piece& piece, int refine, const AxisymObserver& observer = {}) {
  switch (piece.scene.axisym.order) {
    case 3:
      return solve_states<3>(comm, piece, refine, observer);
    case 4:
      return solve_states<4>(comm, piece, refine, observer);
    default:
      return solve_states<2>(comm, piece, refine, observer);
  }
}

Status status_of(const AxisymSummary& rest, const AxisymSummary& actuated, const model::Scene& scene,
                 double unit) {
  const auto failure = [](const AxisymSummary& state) {
    return state.stable ? Status::diverged : Status::no_equilibrium;
  };
  if (!rest.converged) return failure(rest);
  if (!actuated.converged) return failure(actuated);
  const double highest = std::max(rest.highest_pressure, actuated.highest_pressure) * unit;
  if (scene.leg.material == model::LegMaterial::compliance && highest > scene.leg.data_limit)
    return Status::extrapolated;
  if (rest.open_everywhere) return Status::slack;
  if (actuated.open_everywhere) return Status::lifted;
  return Status::contact;
}

// One segment of a piece, from its summaries; lengths over `length`, stresses over `unit`.
model::SegmentResult result_of(const model::Scene& scene, std::size_t segment, const AxisymSummary& rest,
                               const AxisymSummary& actuated, double length, double unit) {
  // The pressures on a rigid leg are the slices'; so are those that nothing else gives.
  model::Scene slices = scene;
  slices.fidelity = model::Fidelity::rigid;
  const SegmentTask rigid_task{&slices, segment};
  const model::SegmentResult rigid = solve_segments(PETSC_COMM_SELF, {&rigid_task, 1})[0];

  model::SegmentResult result;
  result.fidelity = model::Fidelity::axisym;
  result.status = status_of(rest, actuated, scene, unit);
  result.iterations = std::max(rest.iterations, actuated.iterations);
  result.pressure_rest_rigid = rigid.pressure_rest_rigid;
  result.pressure_actuated_rigid = rigid.pressure_actuated_rigid;
  result.volume_initial = rigid.volume_initial;
  const auto at_rest = [&](double value) { return rest.converged ? value : none; };
  const auto put = [&](double value) { return rest.converged && actuated.converged ? value : none; };
  const double volume = length * length * length;
  result.pressure_rest = at_rest(rest.pressure * unit);
  result.pressure_actuated = put(actuated.pressure * unit);
  result.pressure_rest_area_mean = at_rest(rest.pressure_area * unit);
  result.pressure_actuated_area_mean = put(actuated.pressure_area * unit);
  model::derive_changes(result);
  result.actuation_pressure = put(actuated.maxwell * unit);
  result.volume_rest = at_rest(rest.volume * volume);
  result.volume_actuated = put(actuated.volume * volume);
  result.volume_change = (result.volume_initial - result.volume_actuated) / result.volume_initial;
  result.radius_actuated = put(actuated.radius * length);
  result.stretch_actual = at_rest(rest.stretch);
  result.slip_max = put(std::max(rest.slip, actuated.slip) * length);
  result.electric_field_max = put(actuated.field * scene.bandage.modules[segment].voltage / length);
  result.voltage_stable = at_rest(actuated.stable_voltage * scene.bandage.modules[segment].voltage);
  result.error_estimate = result.discretisation_error = none;
  result.model_error = at_rest(0);  // nothing is beyond it
  return result;
}

std::vector<model::SegmentResult> solve_piece(MPI_Comm comm, const Piece& piece,
                                              const AxisymObserver& observer) {
  const model::Scene& scene = piece.scene;
  const double unit = axisym_stress_unit(scene.bandage),
               length = scene.leg.segments[piece.first].mean_radius();
  const int refine = scene.axisym.refine;
  const Solved fine = solve_states(comm, piece, refine, observer);
  std::vector<model::SegmentResult> results;
  for (std::size_t k = 0; k < fine.rest.size(); ++k)
    results.push_back(result_of(scene, piece.first + k, fine.rest[k], fine.actuated[k], length, unit));
  for (model::SegmentResult& result : results)
    result.unknowns = fine.unknowns / static_cast<int>(results.size());
  if (!fine.rest[0].converged || refine == 0) return results;
  const Solved coarse = solve_states(comm, {scene, piece.first, piece.last, fine.converged()}, refine - 1);
  if (!coarse.rest[0].converged || (fine.converged() && !coarse.converged())) return results;
  const auto change = [](double a, double b) { return b != 0 ? std::fabs(a / b - 1) : 0; };
  for (std::size_t k = 0; k < results.size(); ++k)
    results[k].discretisation_error = results[k].error_estimate =
        std::max(change(coarse.rest[k].pressure, fine.rest[k].pressure),
                 fine.converged() ? change(coarse.actuated[k].pressure, fine.actuated[k].pressure) : 0);
  return results;
}

// Where the radii of neighbouring segments differ, the leg of one piece takes their mean.
model::Scene joined(model::Scene scene) {
  for (std::size_t i = 0; i + 1 < scene.leg.segments.size(); ++i) {
    double &below = scene.leg.segments[i].upper_radius, &above = scene.leg.segments[i + 1].lower_radius;
    below = above = 0.5 * (below + above);
  }
  return scene;
}

}  // namespace

std::vector<model::SegmentResult> solve_axisym(MPI_Comm comm, std::span<const SegmentTask> tasks,
                                               const AxisymObserver& observer) {
  std::vector<model::SegmentResult> results;
  for (std::size_t t = 0; t < tasks.size();) {
    const model::Scene& scene = *tasks[t].scene;
    std::vector<model::SegmentResult> piece;
    if (scene.axisym.scope == model::AxisymScope::leg) {
      const model::Scene whole = joined(scene);
      piece = solve_piece(comm, {whole, 0, scene.leg.segments.size() - 1}, observer);
    } else {
      piece = solve_piece(comm, {scene, tasks[t].segment, tasks[t].segment}, observer);
    }
    results.insert(results.end(), piece.begin(), piece.end());
    t += piece.size();
  }
  return results;
}

void try_axisym(MPI_Comm comm, const SegmentTask& task) {
  AxisymCase<2>(comm, *task.scene, task.segment, task.segment, 0).try_solver();
}

}  // namespace gaiter::solvers
