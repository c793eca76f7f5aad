// SPDX-License-Identifier: BSD-2-Clause
#include <cstdio>
#include <exception>
#include <optional>

#include "gaiter/base/error.hpp"
#include "gaiter/studies/program.hpp"

int main(int argc, char** argv) {
  using namespace gaiter;
  studies::CommandLine line;
  std::optional<base::InputError> mistake;
  try {
    line = studies::split_command_line(argc, argv);
  } catch (const base::InputError& error) {
    mistake = error;  // to be reported by one rank, so not before there are ranks
  }
  // Outside every try block: see petsc::Session.
  petsc::Session session(line.others);
  try {
    if (mistake) throw *mistake;
    session.require_started();
    return studies::run_program(session, line);
  } catch (const base::InputError& error) {
    // Thrown on all ranks alike.
    if (petsc::rank(MPI_COMM_WORLD) == 0) std::fprintf(stderr, "gaiter: %s\n", error.what());
    return studies::wrong_input;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "gaiter, rank %d: %s\n", petsc::rank(MPI_COMM_WORLD), error.what());
    MPI_Abort(MPI_COMM_WORLD, studies::internal_failure);
  }
  return studies::internal_failure;
}
