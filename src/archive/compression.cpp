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

constexpr std::size_t window = 256, windows = 16;

// The part of a plane's bytes that is looked at to choose how it is compressed: window i of `windows`.
std::span<const std::byte> sample(std::span<const std::byte> plane, std::size_t i) {
  return plane.subspan((plane.size() - window) / (windows - 1) * i, window);
}

// Entropy within short windows, averaged, in bits a byte: 7.2 for noise. Pooling all windows would take
// slowly changing values for noise.
double entropy(std::span<const std::byte> plane) {
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
    for (const std::byte byte : sample(plane, i)) {
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

// The part of all places in the windows whose four bytes were there before in the same window.
double repetition(std::span<const std::byte> plane) {
  std::size_t repeated = 0;
  for (std::size_t i = 0; i < windows; ++i) {
    const auto bytes = sample(plane, i);
    std::array<std::uint32_t, 512> seen{};
    for (std::size_t place = 0; place + 4 <= window; ++place) {
      std::uint32_t four = 0;
      std::memcpy(&four, bytes.data() + place, 4);
      std::uint32_t& last = seen[(four * 2654435761U) >> 23];
      repeated += last == four && place > 0 ? 1 : 0;
      last = four;
    }
  }
  return static_cast<double>(repeated) / static_cast<double>(windows * (window - 3));
}

struct Method {
  int level;  // 0: stored
  int strategy;
};

Method method_for(std::span<const std::byte> plane) {
  if (plane.size() >= 4096) {
    if (entropy(plane) > 7.0) {
      return {0, Z_DEFAULT_STRATEGY};
    }
    if (repetition(plane) < 0.25) {
      return {1, Z_HUFFMAN_ONLY};
    }
  }
  return {1, Z_DEFAULT_STRATEGY};
}

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

// zlib's working memory, 270 kB; to make it anew costs as much as a small chunk's work.
struct Compressor::Zlib {
  z_stream stream{};

  Zlib() { require(deflateInit(&stream, 1) == Z_OK); }
  ~Zlib() { deflateEnd(&stream); }
  Zlib(const Zlib&) = delete;
  Zlib& operator=(const Zlib&) = delete;
};

Compressor::Compressor() : zlib_(std::make_unique<Zlib>()) {}

Compressor::~Compressor() = default;

std::span<const std::byte> Compressor::compress(std::span<const std::byte> values, std::size_t item_bytes) {
  shuffled_.resize(values.size());
  shuffle(values, item_bytes, shuffled_.data());
  const std::size_t plane = values.size() / item_bytes;

  z_stream& stream = zlib_->stream;
  require(deflateReset(&stream) == Z_OK);
  // Twice zlib's bound: changes of the level end blocks early, which the bound does not know of.
  stream_.resize(2 * deflateBound(&stream, values.size()) + 1024);
  stream.next_out = reinterpret_cast<Bytef*>(stream_.data());
  stream.avail_out = static_cast<uInt>(stream_.size());
  for (std::size_t j = 0; j < item_bytes; ++j) {
    const auto bytes = std::span<const std::byte>(shuffled_).subspan(j * plane, plane);
    const Method method = method_for(bytes);
    require(deflateParams(&stream, method.level, method.strategy) == Z_OK);
    stream.next_in = reinterpret_cast<Bytef*>(const_cast<std::byte*>(bytes.data()));
    stream.avail_in = static_cast<uInt>(plane);
    const bool last = j + 1 == item_bytes;
    require(deflate(&stream, last ? Z_FINISH : Z_NO_FLUSH) == (last ? Z_STREAM_END : Z_OK) &&
            stream.avail_in == 0);
  }
  return std::span<const std::byte>(stream_).first(stream.total_out);
}

}  // namespace gaiter::archive
