// SPDX-License-Identifier: BSD-2-Clause
#pragma once

#include <cstdint>
#include <span>
#include <string>

#include "gaiter/model/result.hpp"

namespace gaiter::studies {

// The table of one design, a line a segment in the scene's order, with notes on everything that is not plain
// contact, on fields beyond the breakdown field, and on estimated errors above one per mille.
std::string result_table(const model::Scene& scene, std::span<const model::SegmentResult> results);

// How many rows of an archive have which status, and how to list those without a trustworthy result.
std::string status_summary(std::span<const std::int64_t> counts, const std::string& archive);

}  // namespace gaiter::studies
