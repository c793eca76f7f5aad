// SPDX-License-Identifier: BSD-2-Clause
// Compressed values come back bit by bit through zlib and HDF5's order of bytes, and are as small as they
// should be.
#include <gtest/gtest.h>
#include <zlib.h>

#include <cmath>
#include <cstdint>
#include <cstring>
#include <limits>
#include <random>
#include <vector>

#include "gaiter/archive/compression.hpp"

namespace gaiter::archive {
namespace {

using Bytes = std::vector<std::byte>;

template <class Value>
Bytes bytes_of(const std::vector<Value>& values) {
  Bytes bytes(values.size() * sizeof(Value));
  std::memcpy(bytes.data(), values.data(), bytes.size());
  return bytes;
}

// What HDF5 does when it reads.
Bytes restored(std::span<const std::byte> stream, std::size_t bytes, std::size_t item) {
  Bytes shuffled(bytes), values(bytes);
  uLongf size = bytes;
  EXPECT_EQ(uncompress(reinterpret_cast<Bytef*>(shuffled.data()), &size,
                       reinterpret_cast<const Bytef*>(stream.data()), stream.size()),
            Z_OK);
  EXPECT_EQ(size, bytes);
  const std::size_t items = bytes / item;
  for (std::size_t i = 0; i < items; ++i) {
    for (std::size_t j = 0; j < item; ++j) {
      values[i * item + j] = shuffled[j * items + i];
    }
  }
  return values;
}

std::size_t plain_zlib(const Bytes& values, std::size_t item) {
  Bytes shuffled(values.size());
  shuffle(values, item, shuffled.data());
  uLongf size = compressBound(values.size());
  Bytes stream(size);
  compress2(reinterpret_cast<Bytef*>(stream.data()), &size, reinterpret_cast<const Bytef*>(shuffled.data()),
            shuffled.size(), 1);
  return size;
}

// Pressures that hang smoothly on the number of the case: sign, exponent and first digits repeat.
std::vector<double> pressures(std::size_t count) {
  std::vector<double> values(count);
  for (std::size_t i = 0; i < count; ++i) {
    values[i] = 3000 + 500 * std::sin(1e-3 * static_cast<double>(i)) + 40 * static_cast<double>(i % 6);
  }
  return values;
}

TEST(Compression, GivesBackEveryBit) {
  std::mt19937_64 random(1);
  Compressor compressor;
  for (const std::size_t item : {1u, 4u, 8u}) {
    for (const std::size_t items : {1u, 2u, 7u, 8u, 9u, 255u, 4095u, 4096u, 4099u, 100003u}) {
      for (const int kind : {0, 1, 2, 3}) {
        Bytes values(item * items);
        for (std::size_t i = 0; i < values.size(); ++i) {
          const bool noise =
              kind == 0 || (kind == 1 && i % item < item / 2) || (kind == 2 && i > values.size() / 2);
          values[i] = noise ? static_cast<std::byte>(random()) : static_cast<std::byte>(i / 1000);
        }
        ASSERT_TRUE(restored(compressor.compress(values, item), values.size(), item) == values)
            << item << " " << items << " " << kind;
      }
    }
  }
  std::vector<double> extremes(5000, std::numeric_limits<double>::quiet_NaN());
  extremes[1] = -0.0;
  extremes[4321] = std::numeric_limits<double>::denorm_min();
  const Bytes values = bytes_of(extremes);
  EXPECT_TRUE(restored(compressor.compress(values, 8), values.size(), 8) == values);
}

// Planes that are one byte over and over, beside noise and beside one another.
TEST(Compression, GivesBackRepeatedBytes) {
  std::mt19937_64 random(3);
  Compressor compressor;
  for (unsigned byte = 0; byte < 256; ++byte) {
    const std::size_t items = 4096 + byte * 37;
    Bytes values(8 * items);
    for (std::size_t i = 0; i < values.size(); ++i) {
      const bool noise = (byte >> (i % 8) & 1) != 0;
      values[i] = noise ? static_cast<std::byte>(random()) : static_cast<std::byte>(byte + i % 8 / 4);
    }
    ASSERT_TRUE(restored(compressor.compress(values, 8), values.size(), 8) == values) << byte;
  }
}

TEST(Compression, ChecksumIsZlibs) {
  std::mt19937_64 random(3);
  Bytes bytes(100003, std::byte{255});  // the largest sums first
  for (std::size_t i = bytes.size() / 2; i < bytes.size(); ++i) {
    bytes[i] = static_cast<std::byte>(random());
  }
  for (const std::size_t count : {0u, 1u, 15u, 16u, 17u, 4095u, 4096u, 4097u, 50000u, 100003u}) {
    const auto some = std::span<const std::byte>(bytes).first(count);
    EXPECT_EQ(adler32(77, some), ::adler32_z(77, reinterpret_cast<const Bytef*>(some.data()), some.size()));
  }
}

TEST(Compression, IsNearlyAsSmallAsASearchEverywhere) {
  Compressor compressor;
  for (const auto& values :
       {bytes_of(pressures(60000)), bytes_of(std::vector<double>(60000, 1.4)),
        bytes_of(std::vector<std::int32_t>(60000, 3)), bytes_of(std::vector<std::int8_t>(60000, 1))}) {
    const std::size_t item = values.size() / 60000;
    // Bytes that only repeat take 13 bits for 258 of them, where zlib would find shorter codes.
    EXPECT_LE(
        static_cast<double>(compressor.compress(values, item).size()),
        1.15 * static_cast<double>(plain_zlib(values, item)) + static_cast<double>(values.size()) / 400);
  }
  const Bytes smooth = bytes_of(pressures(60000));
  EXPECT_LT(compressor.compress(smooth, 8).size(), smooth.size() * 8 / 10);
}

TEST(Compression, OfNoiseCostsNextToNothing) {
  std::mt19937_64 random(2);
  std::vector<std::uint64_t> noise(60000);
  for (std::uint64_t& value : noise) {
    value = random();
  }
  const Bytes values = bytes_of(noise);
  Compressor compressor;
  EXPECT_LT(static_cast<double>(compressor.compress(values, 8).size()),
            1.001 * static_cast<double>(values.size()));
}

}  // namespace
}  // namespace gaiter::archive
