// SPDX-License-Identifier: BSD-2-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

namespace gaiter::archive {

// What HDF5's filters `shuffle` and `deflate` make of the values of one chunk, several times faster: bytes of
// a value that look like noise, most of the mantissa of a computed number, are stored as they are within the
// stream; bytes in which nothing repeats are not searched for what repeats. Any HDF5 reads it.
// Source: RFC 1950, RFC 1951 (stored blocks); HDF5's H5Zshuffle.c. Tested in tests/archive_compression.cpp.
class Compressor {
 public:
  Compressor();
  ~Compressor();
  Compressor(const Compressor&) = delete;
  Compressor& operator=(const Compressor&) = delete;

  // `values`: whole items of `item_bytes` each, little-endian. The result holds until the next call.
  std::span<const std::byte> compress(std::span<const std::byte> values, std::size_t item_bytes);

 private:
  struct Zlib;
  std::unique_ptr<Zlib> zlib_;
  std::vector<std::byte> shuffled_;
  std::vector<std::byte> stream_;
};

// Adler-32 (RFC 1950) of what came before and these bytes; of nothing it is 1. Three times as fast as zlib's.
std::uint32_t adler32(std::uint32_t before, std::span<const std::byte> bytes);

// Byte j of item i to place j * items + i.
void shuffle(std::span<const std::byte> values, std::size_t item_bytes, std::byte* out);

}  // namespace gaiter::archive
