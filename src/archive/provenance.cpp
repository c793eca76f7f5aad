// SPDX-License-Identifier: BSD-2-Clause
#include "gaiter/archive/provenance.hpp"

#include <petscsys.h>

#include <ctime>
#include <utility>

#include "gaiter/base/error.hpp"

namespace gaiter::archive {
namespace {

std::string petsc_in_use() {
  PetscInt major = 0, minor = 0, subminor = 0, release = 0;
  if (PetscGetVersionNumber(&major, &minor, &subminor, &release) != 0) {
    throw base::InternalError("PETSc does not tell its version");
  }
  return std::to_string(major) + "." + std::to_string(minor) + "." + std::to_string(subminor) +
         (release != 0 ? "" : " (development)");
}

std::string now_in_utc() {
  const std::time_t now = std::time(nullptr);
  std::tm utc{};
  gmtime_r(&now, &utc);
  char text[32];
  std::strftime(text, sizeof text, "%Y-%m-%dT%H:%M:%SZ", &utc);
  return text;
}

}  // namespace

Provenance describe_run(MPI_Comm comm, std::string gaiter_version, std::string options, std::string command) {
  Provenance run;
  run.gaiter_version = std::move(gaiter_version);
  run.petsc_version = petsc_in_use();
  run.options = std::move(options);
  run.command = std::move(command);
  run.created = now_in_utc();
  MPI_Comm_size(comm, &run.ranks);
  return run;
}

}  // namespace gaiter::archive
