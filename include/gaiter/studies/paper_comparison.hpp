// SPDX-License-Identifier: BSD-2-Clause
#pragma once

#include <string>

#include "gaiter/model/scene.hpp"

namespace gaiter::studies {

// Throws base::InputError unless the scene has the paper's six segments, r6 (ankle) to r1 (knee).
void require_paper_segments(const model::Scene& scene);

// Every printed result of Pourazadi, Ahmadi and Menon (2015) beside what this scene gives, and why they
// differ. Solves some hundred small systems on the calling rank alone. The scene passes
// require_paper_segments.
std::string paper_comparison(const model::Scene& scene);

}  // namespace gaiter::studies
