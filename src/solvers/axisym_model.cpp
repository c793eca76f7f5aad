// SPDX-License-Identifier: BSD-2-Clause
#include "gaiter/solvers/axisym_model.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>

#include "gaiter/solvers/axisym_case.hpp"
#include "gaiter/solvers/axisym_enriched.hpp"

namespace gaiter::solvers {

namespace {

using model::Status;

constexpr double none = std::numeric_limits<double>::quiet_NaN();
constexpr double dual_safety = 5;  // the dual finds 0.28 of the pressures' error at least (expected_changes)

// Segments first to last of a scene on one mesh.
struct Piece {
  const model::Scene& scene;
  std::size_t first, last;

  bool voltage() const {
    const auto& modules = scene.bandage.modules;
    return std::any_of(modules.begin() + first, modules.begin() + last + 1,
                       [](const model::Module& module) { return module.voltage != 0; });
  }
};

double change(double a, double b) {
  return b != 0 ? std::fabs(a / b - 1) : 0;
}

// A piece on one of its meshes, and what was found there, a segment each.
template <int P>
struct Level {
  Level(MPI_Comm comm, const Piece& piece, int refine)
      : problem(comm, piece.scene, piece.first, piece.last, refine) {}

  AxisymCase<P> problem;
  std::vector<AxisymSummary> rest, actuated;
  std::vector<double> error;  // of the pressures, relative, of the worse state; empty: not known

  bool at_rest() const { return rest[0].converged && rest[0].stable; }
  bool converged() const { return rest[0].converged && actuated[0].converged; }

  void solve_rest(Level* coarser) {
    rest = coarser && coarser->at_rest() ? problem.rest(coarser->problem) : problem.rest();
    actuated = rest;
  }
  void solve_actuated(const Piece& piece) {
    if (piece.voltage() && rest[0].converged) actuated = problem.actuated();
  }

  // What the mesh before makes of the same states.
  void compare(const Level& coarser) {
    if (!coarser.rest[0].converged || (converged() && !coarser.converged())) return;
    for (std::size_t k = 0; k < rest.size(); ++k)
      error.push_back(std::max(change(coarser.rest[k].pressure, rest[k].pressure),
                               converged() ? change(coarser.actuated[k].pressure, actuated[k].pressure) : 0));
  }

  // What the dual expects of the next mesh at the state last found; false where it expects nothing. In a leg
  // of several segments a segment has its neighbours' errors too, which lean on it.
  bool add_expected(Level& finer, const std::vector<AxisymSummary>& state) {
    const std::vector<AxisymChange> changes = expected_changes(problem, finer.problem);
    error.resize(changes.size(), 0.0);
    for (std::size_t k = 0; k < changes.size(); ++k)
      for (std::size_t i = std::max<std::size_t>(k, 1) - 1; i < std::min(k + 2, changes.size()); ++i) {
        const double pressure = state[i].pressure;
        error[k] = std::max(error[k], dual_safety * change(pressure + changes[i].pressure, pressure));
      }
    return !changes.empty();
  }
};

template <int P>
void show(Level<P>& level, bool actuated, const AxisymObserver& observer) {
  const auto& state = actuated ? level.actuated : level.rest;
  if (observer && state[0].converged) level.problem.show(actuated, observer);
}

// On the mesh that the scene asks for.
template <int P>
std::unique_ptr<Level<P>> solve_level(MPI_Comm comm, const Piece& piece, const AxisymObserver& observer) {
  const int refine = piece.scene.axisym.refine;
  // Newton's method starts where the coarser mesh's ended: the end that lifts off is then all but found.
  std::unique_ptr<Level<P>> coarser, finer;
  if (refine > 0) {
    coarser = std::make_unique<Level<P>>(comm, piece, refine - 1);
    coarser->solve_rest(nullptr);
  }
  auto level = std::make_unique<Level<P>>(comm, piece, refine);
  level->solve_rest(coarser.get());
  show(*level, false, observer);
  // No mesh is coarser than the coarsest, and twice a solve there is still cheaper than one on the next.
  bool expected = refine == 0 && level->rest[0].converged;
  if (expected) {
    finer = std::make_unique<Level<P>>(comm, piece, 1);
    expected = level->add_expected(*finer, level->rest);
  }
  level->solve_actuated(piece);
  if (piece.voltage() && level->rest[0].converged) show(*level, true, observer);
  if (expected && piece.voltage() && level->converged())
    expected = level->add_expected(*finer, level->actuated);
  if (!expected) level->error.clear();
  if (coarser && level->rest[0].converged) {
    if (level->converged()) coarser->solve_actuated(piece);
    level->compare(*coarser);
  }
  return level;
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

template <int P>
std::vector<model::SegmentResult> results_of(const Piece& piece, const Level<P>& level) {
  const double unit = axisym_stress_unit(piece.scene.bandage),
               length = piece.scene.leg.segments[piece.first].mean_radius();
  std::vector<model::SegmentResult> results;
  for (std::size_t k = 0; k < level.rest.size(); ++k) {
    results.push_back(
        result_of(piece.scene, piece.first + k, level.rest[k], level.actuated[k], length, unit));
    results.back().unknowns = level.problem.unknowns() / static_cast<int>(level.rest.size());
    if (!level.error.empty())
      results.back().discretisation_error = results.back().error_estimate = level.error[k];
  }
  return results;
}

std::vector<model::SegmentResult> solve_piece(MPI_Comm comm, const Piece& piece,
                                              const AxisymObserver& observer) {
  switch (piece.scene.axisym.order) {
    case 3:
      return results_of(piece, *solve_level<3>(comm, piece, observer));
    case 4:
      return results_of(piece, *solve_level<4>(comm, piece, observer));
    default:
      return results_of(piece, *solve_level<2>(comm, piece, observer));
  }
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
