// SPDX-License-Identifier: BSD-2-Clause
#pragma once

#include <cstdint>
#include <span>
#include <string>

#include "gaiter/model/scene.hpp"
#include "gaiter/studies/designs.hpp"

namespace gaiter::studies {

// Puts a design into a scene. Why it cannot be solved, with option and value; empty: it can.
// `values`: one an axis.
std::string put_design(const Designs& designs, std::span<const double> values, model::Scene& scene);
std::string put_design(const Designs& designs, std::int64_t design, model::Scene& scene);

// What relates several values of one scene: wall against reference radius, positive shear modulus,
// compliance. Throws InputError that names the option and the values.
void check_scene(const model::Scene& scene);

}  // namespace gaiter::studies
