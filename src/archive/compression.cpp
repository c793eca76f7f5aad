// SPDX-License-Identifier: BSD-2-Clause
#include "gaiter/archive/compression.hpp"

#include <zlib.h>

#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <cstring>

#include "gaiter/base/error.hpp"

namespace gaiter::archive {
namespace {

static_assert(std::endian::native == std::endian::little, "archives hold little-endian numbers");

// Exchanges the bits of `low` chosen by mask << shift with those of `high` chosen by mask.
void exchange(std::uint64_t& low, std::uint64_t& high, unsigned shift, std::uint64_t mask) {
  const std::uint64_t different = ((low >> shift) ^ high) & mask;
  high ^= different;
  low ^= different << shift;
}

// Transposes 8 x 8 bytes, by halves, quarters and eighths.
void transpose(std::array<std::uint64_t, 8>& rows) {
  for (const std::size_t i : {0, 1, 2, 3}) {
    exchange(rows[i], rows[i + 4], 32, 0x00000000FFFFFFFF);
  }
  for (const std::size_t i : {0, 1, 4, 5}) {
    exchange(rows[i], rows[i + 2], 16, 0x0000FFFF0000FFFF);
  }
  for (const std::size_t i : {0, 2, 4, 6}) {
    exchange(rows[i], rows[i + 1], 8, 0x00FF00FF00FF00FF);
  }
}

// Entropy within short windows, averaged, in bits a byte: 7.2 for noise. Pooling all windows would take
// slowly changing values for noise.
double entropy(std::span<const std::byte> plane) {
  constexpr std::size_t window = 256, windows = 16;
  static const auto weight = [] {
    std::array<double, window + 1> table{};
    for (std::size_t n = 2; n <= window; ++n) {
      table[n] = static_cast<double>(n) * std::log2(static_cast<double>(n));
    }
    return table;
  }();
  double bits = 0;
  for (std::size_t i = 0; i < windows; ++i) {
    std::array<std::uint16_t, 256> count{};
    for (const std::byte byte : plane.subspan((plane.size() - window) / (windows - 1) * i, window)) {
      ++count[std::to_integer<std::size_t>(byte)];
    }
    double sum = 0;
    for (const std::uint16_t n : count) {
      sum += weight[n];
    }
    bits += std::log2(static_cast<double>(window)) - sum / window;
  }
  return bits / windows;
}

bool worth_a_search(std::span<const std::byte> plane) {
  return plane.size() < 4096 || entropy(plane) < 6.9;
}

class Deflate {
 public:
  Deflate() {
    if (deflateInit(&stream_, 1) != Z_OK) {
      throw base::InternalError("zlib does not start");
    }
  }
  ~Deflate() { deflateEnd(&stream_); }
  Deflate(const Deflate&) = delete;
  Deflate& operator=(const Deflate&) = delete;
  z_stream* get() { return &stream_; }

 private:
  z_stream stream_{};
};

void require(bool ok) {
  if (!ok) {
    throw base::InternalError("zlib cannot compress the values");
  }
}

}  // namespace

void shuffle(std::span<const std::byte> values, std::size_t item_bytes, std::byte* out) {
  const std::size_t items = values.size() / item_bytes;
  std::size_t i = 0;
  if (item_bytes == 8) {
    std::array<std::uint64_t, 8> rows;
    for (; i + 8 <= items; i += 8) {
      std::memcpy(rows.data(), values.data() + 8 * i, sizeof rows);
      transpose(rows);
      for (std::size_t j = 0; j < 8; ++j) {
        std::memcpy(out + j * items + i, &rows[j], 8);
      }
    }
  }
  for (; i < items; ++i) {
    for (std::size_t j = 0; j < item_bytes; ++j) {
      out[j * items + i] = values[item_bytes * i + j];
    }
  }
}

std::span<const std::byte> Compressor::compress(std::span<const std::byte> values, std::size_t item_bytes) {
  shuffled_.resize(values.size());
  shuffle(values, item_bytes, shuffled_.data());
  const std::size_t plane = values.size() / item_bytes;

  Deflate deflate;
  z_stream& stream = *deflate.get();
  // Twice zlib's bound: changes of the level end blocks early, which the bound does not know of.
  stream_.resize(2 * deflateBound(&stream, values.size()) + 1024);
  stream.next_out = reinterpret_cast<Bytef*>(stream_.data());
  stream.avail_out = static_cast<uInt>(stream_.size());
  for (std::size_t j = 0; j < item_bytes; ++j) {
    const auto bytes = std::span<const std::byte>(shuffled_).subspan(j * plane, plane);
    require(deflateParams(&stream, worth_a_search(bytes) ? 1 : 0, Z_DEFAULT_STRATEGY) == Z_OK);
    stream.next_in = reinterpret_cast<Bytef*>(const_cast<std::byte*>(bytes.data()));
    stream.avail_in = static_cast<uInt>(plane);
    const bool last = j + 1 == item_bytes;
    require(::deflate(&stream, last ? Z_FINISH : Z_NO_FLUSH) == (last ? Z_STREAM_END : Z_OK) &&
            stream.avail_in == 0);
  }
  return std::span<const std::byte>(stream_).first(stream.total_out);
}

}  // namespace gaiter::archive
