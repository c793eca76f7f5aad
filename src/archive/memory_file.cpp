// SPDX-License-Identifier: BSD-2-Clause
#include "gaiter/archive/memory_file.hpp"

#include <algorithm>
#include <cstdlib>
#include <cstring>
#include <utility>

#include "gaiter/base/error.hpp"

namespace gaiter::archive {

// HDF5 grows the memory by these functions and leaves it to the buffer when it closes the file.
// H5Fget_file_image would be simpler, but until 2.0 the bytes it gives of newer formats have a checksum that
// does not fit (https://github.com/HDFGroup/hdf5/pull/5489).
struct MemoryFile::Buffer {
  SpareMemory* spare = nullptr;
  void* memory = nullptr;
  std::size_t room = 0;  // at first, what it is expected to need

  ~Buffer() {
    if (spare != nullptr && memory != nullptr) {
      spare->give(memory, room);
    } else {
      std::free(memory);
    }
  }

  static void* allocate(std::size_t bytes, H5FD_file_image_op_t, void* buffer) noexcept {
    return grow(nullptr, bytes, H5FD_FILE_IMAGE_OP_FILE_RESIZE, buffer);
  }
  static void* copy(void* to, const void* from, std::size_t bytes, H5FD_file_image_op_t, void*) noexcept {
    return std::memcpy(to, from, bytes);
  }
  static void* grow(void* memory, std::size_t bytes, H5FD_file_image_op_t, void* buffer) noexcept {
    auto& self = *static_cast<Buffer*>(buffer);
    if (memory != nullptr && bytes <= self.room) {
      return memory;
    }
    self.room = std::max(bytes, memory == nullptr ? self.room : self.room + self.room / 2);
    void* const used = memory == nullptr && self.spare != nullptr ? self.spare->take(self.room) : nullptr;
    return used != nullptr ? used : std::realloc(memory, self.room);
  }
  static herr_t release(void* memory, H5FD_file_image_op_t operation, void* buffer) noexcept {
    if (operation == H5FD_FILE_IMAGE_OP_FILE_CLOSE) {
      static_cast<Buffer*>(buffer)->memory = memory;
    } else {
      std::free(memory);
    }
    return 0;
  }
  static void* keep(void* buffer) noexcept { return buffer; }
  static herr_t drop(void*) noexcept { return 0; }
};

SpareMemory::~SpareMemory() {
  for (const Piece& piece : pieces_) {
    std::free(piece.memory);
  }
}

void* SpareMemory::take(std::size_t bytes) {
  for (Piece& piece : pieces_) {
    if (piece.memory != nullptr && piece.bytes >= bytes) {
      return std::exchange(piece, {}).memory;
    }
  }
  return nullptr;
}

// The smallest goes, so that what is kept will do for the next file.
void SpareMemory::give(void* memory, std::size_t bytes) {
  Piece& least = pieces_[0].bytes < pieces_[1].bytes ? pieces_[0] : pieces_[1];
  if (least.bytes <= bytes) {
    memory = std::exchange(least, {memory, bytes}).memory;
  }
  std::free(memory);
}

MemoryFile::MemoryFile(bool newest_format, std::size_t expected, SpareMemory* spare)
    : buffer_(std::make_unique<Buffer>()) {
  buffer_->spare = spare;
  buffer_->room = expected;
  const std::string action = "make a file in memory";
  const Id access = own(H5Pcreate(H5P_FILE_ACCESS), action);
  // HDF5 clears memory in pieces of this size: so small that they are still at hand when they are filled.
  constexpr std::size_t piece = std::size_t{1} << 16;
  check(H5Pset_fapl_core(access.get(), piece, false), action);
  H5FD_file_image_callbacks_t callbacks{&Buffer::allocate, &Buffer::copy, &Buffer::grow, &Buffer::release,
                                        &Buffer::keep,     &Buffer::drop, buffer_.get()};
  check(H5Pset_file_image_callbacks(access.get(), &callbacks), action);
  if (newest_format) {
    check(H5Pset_libver_bounds(access.get(), H5F_LIBVER_V110, H5F_LIBVER_V110), action);
  }
  file_ = own(H5Fcreate("memory", H5F_ACC_TRUNC, H5P_DEFAULT, access.get()), action);
}

MemoryFile::~MemoryFile() = default;

std::span<const std::byte> MemoryFile::close() {
  const std::string action = "complete a file in memory";
  check(H5Fflush(file_.get(), H5F_SCOPE_GLOBAL), action);
  const ssize_t size = H5Fget_file_image(file_.get(), nullptr, 0);
  check(size < 0 ? -1 : 0, action);
  if (!file_.reset() || buffer_->memory == nullptr) {
    throw base::InternalError("cannot " + action + ": " + last_error());
  }
  return {static_cast<const std::byte*>(buffer_->memory), static_cast<std::size_t>(size)};
}

}  // namespace gaiter::archive
