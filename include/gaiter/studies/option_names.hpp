// SPDX-License-Identifier: BSD-2-Clause
#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "gaiter/base/error.hpp"
#include "gaiter/model/leg.hpp"

namespace gaiter::studies {

// The segments that -leg_segments names, with nothing but their names. Throws InputError for a name that is
// empty, there twice, or a word that follows leg_ or bandage_ in the option table.
std::vector<model::Segment> parse_segments(std::string_view name, std::string_view text);

// The name nearest to a misspelt one, of all options and their sweeps on these segments; empty: none is near.
std::string nearest_option(std::string_view name, std::span<const model::Segment> segments);

// The complaint about an option that neither we nor PETSc know, with the nearest name there is.
base::InputError unknown_option(std::string_view name, std::span<const model::Segment> segments);

}  // namespace gaiter::studies
