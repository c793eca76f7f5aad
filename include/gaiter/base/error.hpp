// SPDX-License-Identifier: BSD-2-Clause
#pragma once

#include <stdexcept>

namespace gaiter::base {

// Wrong input by the user: the program ends with exit code 2 and prints this one line; nothing is written.
// The message names the option, the value and what is allowed.
class InputError : public std::runtime_error {
  using std::runtime_error::runtime_error;
};

// A fault of the program or of its surroundings (PETSc, HDF5, a full disk): exit code 70.
class InternalError : public std::runtime_error {
  using std::runtime_error::runtime_error;
};

}  // namespace gaiter::base
