// SPDX-License-Identifier: BSD-2-Clause
#include "gaiter/archive/compression.hpp"

#include <zlib.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <cstring>

#include "gaiter/base/error.hpp"
#include "gaiter/base/multiversion.hpp"

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

constexpr std::size_t window = 256, windows = 8;

// The part of a plane's bytes that is looked at to choose how it is compressed: window i of `windows`.
std::span<const std::byte> sample(std::span<const std::byte> plane, std::size_t i) {
  return plane.subspan((plane.size() - window) / (windows - 1) * i, window);
}

// How often two bytes of a window are equal, in sum over the windows. Each window for itself: pooling them
// would take slowly changing values for noise.
std::uint32_t equal_pairs(std::span<const std::byte> plane) {
  std::uint32_t sum = 0;
  for (std::size_t i = 0; i < windows; ++i) {
    std::array<std::uint16_t, 256> count{};
    for (const std::byte byte : sample(plane, i)) {
      ++count[std::to_integer<std::size_t>(byte)];
    }
    for (const std::uint32_t n : count) {
      sum += n * n;
    }
  }
  return (sum - windows * window) / 2;
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

enum class Method { store, repeat, count_bytes, search };

Method method_for(std::span<const std::byte> plane) {
  if (plane.size() < 4096) {
    return Method::search;
  }
  if (std::memcmp(plane.data(), plane.data() + 1, plane.size() - 1) == 0) {
    return Method::repeat;
  }
  // Of noise it is one pair in 256. Codes of unequal length are not worth their time before there are very
  // many more: on the second byte of a computed number they save 6 % of an archive and take a seventh of its
  // time.
  constexpr double noise = windows * window * (window - 1) / 2.0 / 256;
  if (equal_pairs(plane) < 30 * noise) {
    return Method::store;
  }
  return repetition(plane) < 0.25 ? Method::count_bytes : Method::search;
}

// Stored blocks, whose length has 16 bits and is followed by its complement.
std::byte* put_stored(std::span<const std::byte> bytes, bool last, std::byte* out) {
  do {
    const auto length = static_cast<std::uint16_t>(std::min<std::size_t>(bytes.size(), 0xFFFF));
    const std::uint16_t lengths[] = {length, static_cast<std::uint16_t>(~length)};
    *out++ = std::byte{last ? std::uint8_t{1} : std::uint8_t{0}};
    std::memcpy(out, lengths, sizeof lengths);
    out += sizeof lengths;
    if (length > 0) {
      std::memcpy(out, bytes.data(), length);
    }
    out += length;
    bytes = bytes.subspan(length);
  } while (!bytes.empty());
  return out;
}

// A block of a plane that is one byte over and over, in the codes of fixed length that RFC 1951 gives
// (3.2.6): the byte, then copies of the one before, 258 or 10 at a time. An empty stored block after it ends
// at a whole byte.
std::byte* put_repeated(std::byte value, std::size_t count, std::byte* out) {
  std::uint64_t bits = 0;
  unsigned used = 0;
  const auto put = [&](std::uint32_t code, unsigned length) {  // first bit lowest
    bits |= std::uint64_t{code} << used;
    for (used += length; used >= 8; used -= 8, bits >>= 8) {
      *out++ = static_cast<std::byte>(bits);
    }
  };
  // Codes stand with their highest bit first.
  const auto literal = std::to_integer<std::uint32_t>(value);
  const unsigned length = literal < 144 ? 8 : 9;
  std::uint32_t byte_code = 0;
  for (std::uint32_t code = literal < 144 ? 0x30 + literal : 0x190 + literal - 144, i = 0; i < length; ++i) {
    byte_code |= (code >> i & 1) << (length - 1 - i);
  }
  put(0b010, 3);
  put(byte_code, length);
  for (--count; count >= 258; count -= 258) {
    put(0b10100011, 8 + 5);  // the length's code and, all zero, that of the distance 1
  }
  for (; count >= 10; count -= 10) {
    put(0b0001000, 7 + 5);
  }
  for (; count > 0; --count) {
    put(byte_code, length);
  }
  put(0, 7);  // end of block
  put(0, 3);
  if (used > 0) {
    *out++ = static_cast<std::byte>(bits);
  }
  for (const unsigned end : {0x00, 0x00, 0xFF, 0xFF}) {
    *out++ = static_cast<std::byte>(end);
  }
  return out;
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

GAITER_MULTIVERSION
std::uint32_t adler32(std::uint32_t before, std::span<const std::byte> bytes) {
  constexpr std::size_t lanes = 64, rows = 256;  // as many as the sums have room for
  constexpr std::uint64_t modulus = 65521;
  std::uint64_t sum = before & 0xFFFF, sum_of_sums = before >> 16;
  while (bytes.size() >= lanes) {
    const std::size_t count = std::min(rows, bytes.size() / lanes);
    std::array<std::uint16_t, lanes> column{};
    std::array<std::uint32_t, lanes> weighted{};  // by the number of rows that follow
    for (std::size_t row = 0; row < count; ++row) {
      for (std::size_t lane = 0; lane < lanes; ++lane) {
        weighted[lane] += column[lane];
        column[lane] =
            static_cast<std::uint16_t>(column[lane] + std::to_integer<unsigned>(bytes[row * lanes + lane]));
      }
    }
    sum_of_sums += count * lanes * sum;
    for (std::size_t lane = 0; lane < lanes; ++lane) {
      sum_of_sums += std::uint64_t{lanes} * (weighted[lane] + column[lane]) - lane * column[lane];
      sum += column[lane];
    }
    sum %= modulus;
    sum_of_sums %= modulus;
    bytes = bytes.subspan(count * lanes);
  }
  for (const std::byte byte : bytes) {
    sum += std::to_integer<unsigned>(byte);
    sum_of_sums += sum;
  }
  return static_cast<std::uint32_t>((sum_of_sums % modulus) << 16 | sum % modulus);
}

// zlib's working memory, 270 kB; to make it anew costs as much as a small chunk's work. It writes deflate
// blocks without a head, of which each run of planes ends at a whole byte and looks back at no other.
struct Compressor::Zlib {
  z_stream stream{};

  Zlib() { require(deflateInit2(&stream, 1, Z_DEFLATED, -MAX_WBITS, 8, Z_DEFAULT_STRATEGY) == Z_OK); }
  ~Zlib() { deflateEnd(&stream); }
  Zlib(const Zlib&) = delete;
  Zlib& operator=(const Zlib&) = delete;

  // Appends at `out`, where there are `room` bytes; returns how many it took.
  std::size_t append(std::span<const std::byte> plane, bool search, bool end_of_run, std::byte* out,
                     std::size_t room) {
    stream.next_out = reinterpret_cast<Bytef*>(out);
    stream.avail_out = static_cast<uInt>(room);
    require(deflateParams(&stream, 1, search ? Z_DEFAULT_STRATEGY : Z_HUFFMAN_ONLY) == Z_OK);
    stream.next_in = reinterpret_cast<Bytef*>(const_cast<std::byte*>(plane.data()));
    stream.avail_in = static_cast<uInt>(plane.size());
    require(deflate(&stream, end_of_run ? Z_FULL_FLUSH : Z_NO_FLUSH) == Z_OK && stream.avail_in == 0 &&
            stream.avail_out > 0);
    return room - stream.avail_out;
  }
};

Compressor::Compressor() : zlib_(std::make_unique<Zlib>()) {}

Compressor::~Compressor() = default;

std::span<const std::byte> Compressor::compress(std::span<const std::byte> values, std::size_t item_bytes) {
  const std::size_t plane = values.size() / item_bytes;
  // Twice zlib's bound: changes of the method end blocks early, which the bound does not know of. Memory is
  // only ever added, for vectors clear what they add.
  const std::size_t bound = 2 * deflateBound(&zlib_->stream, values.size()) + 1024;
  if (shuffled_.size() < values.size()) {
    shuffled_.resize(values.size());
  }
  if (stream_.size() < bound) {
    stream_.resize(bound);
  }
  shuffle(values, item_bytes, shuffled_.data());

  const std::byte* end = stream_.data() + bound;
  std::byte* out = stream_.data();
  *out++ = std::byte{0x78};  // zlib's head: deflate with a window of 32 kB, fast
  *out++ = std::byte{0x01};
  require(deflateReset(&zlib_->stream) == Z_OK);
  const auto bytes_of = [&](std::size_t j) {
    return std::span<const std::byte>(shuffled_).subspan(j * plane, plane);
  };
  Method method = method_for(bytes_of(0));
  for (std::size_t j = 0; j < item_bytes; ++j) {
    const bool last = j + 1 == item_bytes;
    const Method next = last ? Method::store : method_for(bytes_of(j + 1));
    if (method == Method::store) {
      out = put_stored(bytes_of(j), false, out);
    } else if (method == Method::repeat) {
      out = put_repeated(bytes_of(j)[0], plane, out);
    } else {
      const bool end_of_run = next == Method::store || next == Method::repeat;
      out += zlib_->append(bytes_of(j), method == Method::search, end_of_run, out,
                           static_cast<std::size_t>(end - out));
    }
    method = next;
  }
  out = put_stored({}, true, out);
  const std::uint32_t check = adler32(1, std::span<const std::byte>(shuffled_).first(values.size()));
  for (const unsigned shift : {24, 16, 8, 0}) {
    *out++ = static_cast<std::byte>(check >> shift);
  }
  return {stream_.data(), out};
}

}  // namespace gaiter::archive
