// SPDX-License-Identifier: BSD-2-Clause
#pragma once

#include <exception>
#include <string>
#include <utility>

#include <mpi.h>
#include "gaiter/base/error.hpp"

namespace gaiter::archive {

// What went wrong on one rank, if anything did.
struct Failure {
  std::string message;  // empty: nothing
  bool by_input = false;
};

// Throws the lowest failing rank's failure on every rank, as base::InputError or base::InternalError.
// @note Collective.
void throw_if_any_failed(MPI_Comm comm, const Failure& failure);

// Does `work` on this rank and waits for the others: it throws on all ranks or on none, so that no rank
// walks into a collective call alone. Messages begin with `context`. @note Collective.
template <class Work>
void agreed(MPI_Comm comm, const std::string& context, Work&& work) {
  Failure failure;
  try {
    std::forward<Work>(work)();
  } catch (const base::InputError& error) {
    failure = {context + ": " + error.what(), true};
  } catch (const std::exception& error) {
    failure = {context + ": " + error.what(), false};
  }
  throw_if_any_failed(comm, failure);
}

}  // namespace gaiter::archive
