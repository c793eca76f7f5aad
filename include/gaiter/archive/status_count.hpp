// SPDX-License-Identifier: BSD-2-Clause
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>

#include "gaiter/model/result.hpp"

namespace gaiter::archive {

struct StatusCount {
  std::array<std::int64_t, model::status_count> rows{};  // with each status
  std::size_t first_invalid_case = 0;                    // where there is one
};

// Counts the rows of an archive, a part of it at a time. Serial; throws base::InternalError.
StatusCount count_status(const std::string& path);

}  // namespace gaiter::archive
