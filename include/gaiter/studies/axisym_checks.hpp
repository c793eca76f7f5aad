// SPDX-License-Identifier: BSD-2-Clause
#pragma once

#include "gaiter/model/scene.hpp"

namespace gaiter::studies {

// What the finite elements ask of a scene beyond what every fidelity does; base::InputError names the option.
void check_axisym(const model::Scene& scene);

}  // namespace gaiter::studies
