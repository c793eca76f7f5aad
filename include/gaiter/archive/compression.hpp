// SPDX-License-Identifier: BSD-2-Clause
#pragma once

#include <cstddef>
#include <span>
#include <vector>

namespace gaiter::archive {

// What HDF5's filters `shuffle` and `deflate` make of the values of one chunk, several times faster: the
// bytes of a value that look like noise, most of the mantissa of a computed number, are stored as they are
// within the stream instead of being searched for patterns. Any HDF5 reads it.
// Source: RFC 1950, RFC 1951 (stored blocks); HDF5's H5Zshuffle.c. Tested in tests/archive_compression.cpp.
class Compressor {
 public:
  // `values`: whole items of `item_bytes` each, little-endian. The result holds until the next call.
  std::span<const std::byte> compress(std::span<const std::byte> values, std::size_t item_bytes);

 private:
  std::vector<std::byte> shuffled_;
  std::vector<std::byte> stream_;
};

// Byte j of item i to place j * items + i.
void shuffle(std::span<const std::byte> values, std::size_t item_bytes, std::byte* out);

}  // namespace gaiter::archive
