// SPDX-License-Identifier: BSD-2-Clause
#pragma once

#include <map>
#include <span>
#include <string>

#include "gaiter/model/scene.hpp"
#include "gaiter/petsc/session.hpp"

namespace gaiter::studies {

// Options that are not in our table, name (without dash) to text: PETSc's, or misspelt.
using ForeignOptions = std::map<std::string, std::string>;

// Refuses every foreign option that PETSc does not know or cannot read. PETSc knows those that it asks for
// while a solver is set up. Throws InputError. @note Collective.
void check_foreign_options(const petsc::Session& session, const model::Scene& scene,
                           const ForeignOptions& foreign);

// YAML lines of the foreign options that tune the solver, for they decide on the results too.
std::string solver_settings(const ForeignOptions& foreign);

}  // namespace gaiter::studies
