// SPDX-License-Identifier: BSD-2-Clause
#include "gaiter/archive/hdf5.hpp"

#include "gaiter/base/error.hpp"

namespace gaiter::archive {
namespace {

// The innermost entry names the cause (a file system's answer, say); those above it only pass it on.
herr_t keep_innermost(unsigned position, const H5E_error2_t* entry, void* text) noexcept {
  if (position == 0 && entry->desc != nullptr) {
    try {
      *static_cast<std::string*>(text) = entry->desc;
    } catch (...) {
      return -1;
    }
  }
  return 0;
}

}  // namespace

std::string last_error() {
  std::string text;
  H5Ewalk2(H5E_DEFAULT, H5E_WALK_UPWARD, keep_innermost, &text);
  return text.empty() ? "HDF5 gives no reason" : text;
}

Id own(hid_t id, const std::string& action) {
  if (id < 0) {
    throw base::InternalError("cannot " + action + ": " + last_error());
  }
  return Id(id);
}

void check(herr_t status, const std::string& action) {
  if (status < 0) {
    throw base::InternalError("cannot " + action + ": " + last_error());
  }
}

}  // namespace gaiter::archive
