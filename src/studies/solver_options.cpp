// SPDX-License-Identifier: BSD-2-Clause
#include "gaiter/studies/solver_options.hpp"

#include <fmt/format.h>
#include <petscsnes.h>

#include <algorithm>
#include <array>
#include <string_view>

#include "gaiter/base/error.hpp"
#include "gaiter/base/text.hpp"
#include "gaiter/petsc/check.hpp"
#include "gaiter/petsc/error_capture.hpp"
#include "gaiter/solvers/axisym_model.hpp"
#include "gaiter/solvers/slice_solver.hpp"
#include "gaiter/solvers/sliding_solver.hpp"
#include "gaiter/studies/option_names.hpp"
#include "gaiter/studies/solve.hpp"

namespace gaiter::studies {

namespace {

using base::InputError;

// What PETSc asks for when it ends.
constexpr std::array<std::string_view, 6> asked_at_end{"log_view_memory", "malloc_dump",  "memory_view",
                                                       "objects_dump",    "options_left", "options_view"};

bool contains(std::span<const std::string_view> words, std::string_view word) {
  return std::ranges::find(words, word) != words.end();
}

constexpr std::array<std::string_view, 3> solver_prefixes{"axisym_", "slice_", "sliding_"};

bool of_solver(std::string_view name) {
  for (std::string_view prefix : solver_prefixes)
    for (std::string_view part : {"snes_", "ksp_", "pc_", "mat_", "fieldsplit_"})
      if (name.starts_with(prefix) && name.substr(prefix.size()).starts_with(part)) return true;
  return false;
}

bool ends_a_view(std::string_view name) {
  return name.ends_with("_view") || name.find("_view_") != std::string_view::npos ||
         name.ends_with("_converged_reason");
}

// What PETSc asks for only while it solves.
bool asked_while_solving(std::string_view name) {
  return of_solver(name) && (ends_a_view(name) || name.find("_snes_test_jacobian") != std::string_view::npos);
}

bool takes_viewer(std::string_view name) {
  return of_solver(name) && (ends_a_view(name) || name.ends_with("_monitor"));
}

// PETSc's message holds the value, but seldom the name of the option.
[[noreturn]] void refuse(const ForeignOptions& foreign, const std::string& message) {
  const std::string reason = message.substr(0, message.find('\n'));
  std::string named, all;
  for (const auto& [name, text] : foreign) {
    const std::string option = fmt::format("{}-{} '{}'", all.empty() ? "" : ", ", name, text);
    if (of_solver(base::lower(name))) all += option;
    if (named.empty() && !text.empty() && reason.find(text) != std::string::npos)
      named = fmt::format("-{} '{}'", name, text);
  }
  throw InputError(fmt::format("{}: PETSc refuses this: {}", named.empty() ? all : named, reason));
}

void check_tolerances(SNES snes, const std::string& prefix, const ForeignOptions& foreign) {
  PetscReal relative = 0;
  PetscInt steps = 0;
  petsc::check(SNESGetTolerances(snes, nullptr, &relative, nullptr, &steps, nullptr));
  const auto require = [&](bool sound, const std::string& name, auto value, const char* range) {
    if (sound) return;
    const auto found = foreign.find(name);
    throw InputError(fmt::format("-{} '{}': must be {}", name,
                                 found != foreign.end() ? found->second : fmt::format("{}", value), range));
  };
  require(relative >= 0 && relative < 1, prefix + "snes_rtol", relative,
          "at least 0 and less than 1, e.g. '1e-12'");
  require(steps >= 0, prefix + "snes_max_it", steps, "at least 0, e.g. '80'");
}

// Solvers ask for their options when they are made.
void try_solvers(const model::Scene& scene, const ForeignOptions& foreign) {
  const solvers::SliceSolver slices(PETSC_COMM_WORLD, 1, scene.discretisation.slice_solver, 1);
  check_tolerances(slices.snes(), "slice_", foreign);
  if (may_take_axisym(scene)) {
    // On as many ranks as share a mesh.
    const solvers::SegmentTask task{&scene, 0};
    const int rank = petsc::rank(PETSC_COMM_WORLD);
    MPI_Comm group = MPI_COMM_NULL;
    MPI_Comm_split(PETSC_COMM_WORLD, rank / scene.axisym.ranks_per_case, rank, &group);
    try {
      solvers::try_axisym(group, task);
    } catch (...) {
      MPI_Comm_free(&group);
      throw;
    }
    MPI_Comm_free(&group);
  }
  if (scene.fidelity != model::Fidelity::sliding && scene.fidelity != model::Fidelity::automatic) return;
  const solvers::SlidingSolver sliding(PETSC_COMM_WORLD, 1, 3);
  check_tolerances(sliding.snes(), "sliding_", foreign);
}

}  // namespace

void check_foreign_options(const petsc::Session& session, const model::Scene& scene,
                           const ForeignOptions& foreign) {
  // Before the solver, which would fail on the rank that opens files and wait on the others.
  for (const auto& [name, text] : foreign)
    if (takes_viewer(base::lower(name))) petsc::try_viewer("-" + name);
  {
    petsc::ErrorCapture quiet;
    try {
      try_solvers(scene, foreign);
    } catch (const base::InternalError&) {
      refuse(foreign, quiet.message());
    }
  }
  const auto unused = session.unused_options();
  for (const auto& [name, text] : foreign) {
    const std::string lower = base::lower(name);
    if (!unused.contains(name) || contains(asked_at_end, lower) || asked_while_solving(lower)) continue;
    if (nearest_option(lower, scene.leg.segments) == lower) {
      throw InputError(fmt::format(
          "-{} '{}': spelt right, but no part of the chosen solver asks for it (see -slice_snes_view)", name,
          text));
    }
    throw unknown_option(name, scene.leg.segments);
  }
}

std::string solver_settings(const ForeignOptions& foreign) {
  std::string text;
  for (const auto& [name, value] : foreign)
    if (of_solver(base::lower(name))) text += fmt::format("{}: {}\n", name, value);
  return text;
}

}  // namespace gaiter::studies
