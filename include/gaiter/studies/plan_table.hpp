// SPDX-License-Identifier: BSD-2-Clause
#pragma once

#include <string>

#include "gaiter/studies/designs.hpp"
#include "gaiter/studies/scene_options.hpp"

namespace gaiter::studies {

// What -fidelity auto would do, from the forecast alone: a line a segment or, of many designs, a line a
// model. Throws base::InputError with another fidelity, which leaves nothing to plan.
std::string plan_text(const Request& request, const Designs& designs);

}  // namespace gaiter::studies
