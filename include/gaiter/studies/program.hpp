// SPDX-License-Identifier: BSD-2-Clause
#pragma once

#include "gaiter/petsc/session.hpp"
#include "gaiter/studies/command_line.hpp"

namespace gaiter::studies {

// Exit codes of the program. A sweep that a signal has ended gives 128 plus the signal's number, as shells
// do.
enum ExitCode { success = 0, wrong_input = 2, untrustworthy = 3, internal_failure = 70 };

// Runs one command on all ranks, prints on rank 0 and writes the archive. Throws base::InputError before
// anything is written, and base::InternalError. @note Collective; the session outlives the call.
int run_program(petsc::Session& session, const CommandLine& line);

}  // namespace gaiter::studies
