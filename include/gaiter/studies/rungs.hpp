// SPDX-License-Identifier: BSD-2-Clause
#pragma once

#include <string>
#include <vector>

#include "gaiter/model/scene.hpp"

namespace gaiter::studies {

// One way to solve a scene: a model, how finely, by which algorithm.
struct Rung {
  std::string name;  // without blanks
  model::Scene scene;
};

// The ladder of a scene up to its -auto_up_to: from the rigid leg to the finest, which the others are held
// against and which comes last; before it what -fidelity auto makes of the scene at several accuracies, that
// of the scene among them. Also slices with less of a solution: in single precision, with Newton's method
// stopped early (unless -slice_snes_rtol is given, which then holds for all), by the paper's fixed point.
// Rungs that would repeat another are left out: the field's models without voltage, compliance on a rigid
// leg.
std::vector<Rung> rungs_of(const model::Scene& scene);

}  // namespace gaiter::studies
