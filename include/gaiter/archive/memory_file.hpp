// SPDX-License-Identifier: BSD-2-Clause
#pragma once

#include <hdf5.h>

#include <array>
#include <cstddef>
#include <memory>
#include <span>

#include "gaiter/archive/hdf5.hpp"

namespace gaiter::archive {

// Memory of files that are gone, for the next ones: fresh pages cost more than what is written to them.
class SpareMemory {
 public:
  SpareMemory() = default;
  ~SpareMemory();
  SpareMemory(const SpareMemory&) = delete;
  SpareMemory& operator=(const SpareMemory&) = delete;

  void* take(std::size_t bytes);  // from malloc; null: none is as large
  void give(void* memory, std::size_t bytes);

 private:
  struct Piece {
    void* memory = nullptr;
    std::size_t bytes = 0;
  };
  std::array<Piece, 2> pieces_;
};

// A new HDF5 file in memory, and its bytes once it is closed. What HDF5 makes so never meets a full disk,
// which HDF5 1.10 does not survive: it cannot close a file that it fails to complete.
class MemoryFile {
 public:
  // The newest format takes less room, 27 kB instead of 90 kB for one case; the oldest is read everywhere.
  // `expected`: about as many bytes as it will have, for which it takes memory at once. `spare`, if given,
  // outlives it.
  explicit MemoryFile(bool newest_format, std::size_t expected = std::size_t{1} << 20,
                      SpareMemory* spare = nullptr);
  ~MemoryFile();
  MemoryFile(const MemoryFile&) = delete;
  MemoryFile& operator=(const MemoryFile&) = delete;

  hid_t get() const { return file_.get(); }

  // Closes the file, which must have no open variables left; the bytes live as long as this.
  std::span<const std::byte> close();

 private:
  struct Buffer;
  std::unique_ptr<Buffer> buffer_;
  Id file_;
};

}  // namespace gaiter::archive
