// SPDX-License-Identifier: BSD-2-Clause
#include "gaiter/solvers/residual_estimate.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "gaiter/solvers/axisym_case.hpp"
#include "gaiter/solvers/axisym_dual.hpp"

namespace gaiter::solvers {

namespace {

constexpr double none = std::numeric_limits<double>::quiet_NaN();
constexpr int order = 2;

// What the finite elements are expected to say of a state, from the simpler model's own and from a step
// further.
struct Prediction {
  bool reliable = false;
  double pressure = none, volume = none;              // [Pa, m3]
  double first_pressure = none, first_volume = none;  // before the step
};

Prediction predict(AxisymCase<order>& problem, const SegmentTask& task, model::Fidelity fidelity,
                   bool actuated) {
  Prediction prediction;
  if (!problem.take_model(fidelity, actuated)) return prediction;
  const double stress = problem.system().materials().stress, length = problem.system().space().mesh.length;
  AxisymDual<order> dual(problem.system(), problem.solver());
  const auto weigh = [&] {
    if (!dual.linearise(problem.state())) return false;
    const AxisymSummary at = summarise_axisym<order>(*task.scene, task.segment, problem.system(), 0, false);
    prediction.pressure = (at.pressure + dual.error(0, AxisymOutput::pressure)) * stress;
    prediction.volume = (at.volume + dual.error(0, AxisymOutput::volume)) * length * length * length;
    return true;
  };
  if (!weigh()) return prediction;
  prediction.first_pressure = prediction.pressure;
  prediction.first_volume = prediction.volume;
  const bool whole = dual.advance(problem.state());
  prediction.reliable = weigh() && whole;
  return prediction;
}

double relative(double own, double expected) {
  return expected != 0 ? own / expected - 1 : none;
}

// An estimate, and how much the step has changed it.
double weigh(double own, double expected, double before, double& spread) {
  const double error = relative(own, expected), change = std::fabs(error - relative(own, before));
  if (std::isfinite(change)) spread = std::max(spread, change);
  return error;
}

}  // namespace

double ResidualEstimate::largest() const {
  double result = none;
  for (double error : {pressure_rest, pressure_actuated, actuation_drop, volume_change})
    result = std::fmax(result, std::fabs(error));
  return result;
}

ResidualEstimate estimate_by_residual(const SegmentTask& task, const model::SegmentResult& own,
                                      model::Fidelity fidelity) {
  ResidualEstimate error{
      .pressure_rest = none, .pressure_actuated = none, .actuation_drop = none, .volume_change = none};
  if (!model::trustworthy(own.status) || !(own.pressure_rest > 0)) return error;
  // The simpler models have the field in closed form; on the mesh it is the same to 2e-4 of the pressures.
  model::Scene scene = *task.scene;
  scene.axisym.electrostatics = model::Electrostatics::radial;
  const SegmentTask radial{&scene, task.segment};
  AxisymCase<order> problem(PETSC_COMM_SELF, scene, task.segment, task.segment, 0);
  const Prediction rest = predict(problem, radial, fidelity, false);
  error.reliable = rest.reliable;
  error.pressure_rest = weigh(own.pressure_rest, rest.pressure, rest.first_pressure, error.spread);
  Prediction last = rest;
  if (scene.bandage.modules[task.segment].voltage != 0) {
    error.reliable = error.reliable && own.pressure_actuated > 0;
    if (!(own.pressure_actuated > 0)) return error;
    last = predict(problem, radial, fidelity, true);
    error.reliable = error.reliable && last.reliable;
    error.pressure_actuated = weigh(own.pressure_actuated, last.pressure, last.first_pressure, error.spread);
    error.actuation_drop = weigh(own.actuation_drop, rest.pressure - last.pressure,
                                 rest.first_pressure - last.first_pressure, error.spread);
  }
  const auto change = [&](double volume) { return (own.volume_initial - volume) / own.volume_initial; };
  error.volume_change =
      weigh(own.volume_change, change(last.volume), change(last.first_volume), error.spread);
  return error;
}

}  // namespace gaiter::solvers
