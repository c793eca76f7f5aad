// SPDX-License-Identifier: BSD-2-Clause
#pragma once

#include <exception>
#include <string>
#include <utility>

#include <mpi.h>

namespace gaiter::archive {

// Throws base::InternalError with the lowest failing rank's message, on every rank, if any rank's `failure`
// is not empty. @note Collective.
void throw_if_any_failed(MPI_Comm comm, const std::string& failure);

// Does `work` on this rank and waits for the others: it throws on all ranks or on none, so that no rank
// walks into a collective call alone. Messages begin with `context`. @note Collective.
template <class Work>
void agreed(MPI_Comm comm, const std::string& context, Work&& work) {
  std::string failure;
  try {
    std::forward<Work>(work)();
  } catch (const std::exception& error) {
    failure = context + ": " + error.what();
  }
  throw_if_any_failed(comm, failure);
}

}  // namespace gaiter::archive
