// SPDX-License-Identifier: BSD-2-Clause
#pragma once

#include <hdf5.h>

#include <string>
#include <utility>

namespace gaiter::archive {

// Owns one reference to an HDF5 object of any kind: file, dataset, dataspace, datatype, property list.
class Id {
 public:
  Id() = default;
  explicit Id(hid_t id) : id_(id) {}
  Id(Id&& other) noexcept : id_(std::exchange(other.id_, H5I_INVALID_HID)) {}
  Id& operator=(Id&& other) noexcept {
    if (this != &other) {
      reset();
      id_ = std::exchange(other.id_, H5I_INVALID_HID);
    }
    return *this;
  }
  ~Id() { reset(); }

  hid_t get() const { return id_; }
  // False if HDF5 could not close the object properly (of a file: could not write out the rest).
  bool reset() noexcept {
    const hid_t id = std::exchange(id_, H5I_INVALID_HID);
    return id < 0 || H5Idec_ref(id) >= 0;
  }

 private:
  hid_t id_ = H5I_INVALID_HID;
};

// While it lives HDF5 prints no error stacks; what went wrong is in the exceptions instead.
class QuietErrors {
 public:
  QuietErrors() {
    H5Eget_auto2(H5E_DEFAULT, &printer_, &data_);
    H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);
  }
  ~QuietErrors() { H5Eset_auto2(H5E_DEFAULT, printer_, data_); }
  QuietErrors(const QuietErrors&) = delete;
  QuietErrors& operator=(const QuietErrors&) = delete;

 private:
  H5E_auto2_t printer_ = nullptr;
  void* data_ = nullptr;
};

// The cause HDF5 gives for the call that failed just now.
std::string last_error();

// Throw base::InternalError "cannot ACTION: CAUSE" if the call failed.
Id own(hid_t id, const std::string& action);
void check(herr_t status, const std::string& action);

}  // namespace gaiter::archive
