// SPDX-License-Identifier: BSD-2-Clause
#include <cstdio>
#include <exception>
#include <optional>

#include "gaiter/base/error.hpp"
#include "gaiter/studies/program.hpp"

int main(int argc, char** argv) {
  using namespace gaiter;
  std::optional<studies::CommandLine> line;
  try {
    line = studies::split_command_line(argc, argv);
  } catch (const base::InputError& error) {
    std::fprintf(stderr, "gaiter: %s\n", error.what());
    return studies::wrong_input;
  }
  // Outside every try block: see petsc::Session.
  petsc::Session session(line->others);
  try {
    return studies::run_program(session, *line);
  } catch (const base::InputError& error) {
    // Thrown on all ranks alike.
    if (petsc::rank(PETSC_COMM_WORLD) == 0) std::fprintf(stderr, "gaiter: %s\n", error.what());
    return studies::wrong_input;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "gaiter, rank %d: %s\n", petsc::rank(PETSC_COMM_WORLD), error.what());
    MPI_Abort(PETSC_COMM_WORLD, studies::internal_failure);
  }
  return studies::internal_failure;
}
