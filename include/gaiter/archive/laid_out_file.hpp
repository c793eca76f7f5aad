// SPDX-License-Identifier: BSD-2-Clause
#pragma once

#include <hdf5.h>

#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>

#include "gaiter/archive/hdf5.hpp"

namespace gaiter::archive {

// A new HDF5 file on the disk that holds all but the bytes of its chunks: HDF5 gives each its place, and
// whoever has the bytes, on any rank, writes them there. HDF5 has no call for that; it is done by a driver of
// HDF5's file layer that leaves these writes out. The driver writes on when the disk is full, for HDF5 1.10
// cannot close a file that it fails to complete, and close() tells of it.
class LaidOutFile {
 public:
  explicit LaidOutFile(const std::string& path);
  ~LaidOutFile();
  LaidOutFile(const LaidOutFile&) = delete;
  LaidOutFile& operator=(const LaidOutFile&) = delete;

  hid_t get() const { return file_.get(); }

  // Where in the file the chunk of a variable that begins with this case is to be written, and `bytes` long.
  std::uint64_t place(hid_t variable, std::size_t case_in_file, std::size_t bytes);

  // Closes the file, which must have no open variables left, and takes the blocks for all of it. Throws
  // base::InternalError with the system's reason where there is no room.
  void close();

  // What driver and owner share.
  struct Shared {
    const void* left_out = nullptr;  // a write from here is, without a look at what is there
    std::uint64_t place = 0;         // of the one left out last
    std::uint64_t size = 0;          // of the file
    int error = 0;                   // of the system, the first
  };

 private:
  std::string path_;
  std::unique_ptr<Shared> shared_;
  Id driver_;
  Id file_;
};

}  // namespace gaiter::archive
