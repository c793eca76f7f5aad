// SPDX-License-Identifier: BSD-2-Clause
#pragma once

#include <stdexcept>
#include <string>
#include <utility>

namespace gaiter::base {

// Wrong input by the user: the program ends with exit code 2 and prints this one line; nothing is written.
// The message names the option, the value and what is allowed.
class InputError : public std::runtime_error {
 public:
  explicit InputError(std::string message) : std::runtime_error(one_line(std::move(message))) {}

 private:
  // A value of the user's that has control characters does not break the line.
  static std::string one_line(std::string text) {
    for (char& letter : text)
      if (static_cast<unsigned char>(letter) < ' ' || letter == 127) letter = '?';
    return text;
  }
};

// A fault of the program or of its surroundings (PETSc, HDF5, a full disk): exit code 70.
class InternalError : public std::runtime_error {
  using std::runtime_error::runtime_error;
};

}  // namespace gaiter::base
