// SPDX-License-Identifier: BSD-2-Clause
#pragma once

#include <string>

#include <mpi.h>

namespace gaiter::archive {

// Where an archive comes from; becomes its file attributes.
struct Provenance {
  std::string gaiter_version;
  std::string petsc_version;
  std::string options;  // resolved: defaults included, as text that -options_file reads back
  std::string command;  // as typed
  std::string created;  // ISO 8601, UTC
  int ranks = 1;
};

// Fills in the PETSc version in use, the time and the number of ranks.
Provenance describe_run(MPI_Comm comm, std::string gaiter_version, std::string options, std::string command);

}  // namespace gaiter::archive
