// SPDX-License-Identifier: BSD-2-Clause
#pragma once

#include <span>
#include <string>

#include "gaiter/model/result.hpp"
#include "gaiter/studies/designs.hpp"
#include "gaiter/studies/scene_options.hpp"

namespace gaiter::studies {

// What -fidelity auto would do, from the forecast alone: a line a wanted segment or, of many designs, a line
// a model. Throws base::InputError with another fidelity, which leaves nothing to plan.
std::string plan_text(const Request& request, const Designs& designs);

// What it took of one design, once solved: a line a segment that was planned.
std::string taken_text(const model::Scene& scene, std::span<const model::SegmentResult> results);

}  // namespace gaiter::studies
