// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/text/byte_planes.h"

#include <gtest/gtest.h>

#include <cstdint>
#include <vector>

namespace swath::io {
namespace {

/// Bytes in memory that is aligned as numbers are.
struct Bytes {
  explicit Bytes(size_t n) : words((n + 7) / 8 + 1) {}
  std::uint8_t* data() { return reinterpret_cast<std::uint8_t*>(words.data()); }
  std::vector<std::uint64_t> words;
};

TEST(BytePlanes, TheBytesOfEqualPlaceLieTogetherAndComeBack) {
  for (const size_t width : {1u, 2u, 3u, 4u, 5u, 8u, 30u})
    for (const size_t n : {0u, 1u, 7u, 255u, 256u, 257u, 1000u}) {
      Bytes values(n * width), planes(n * width), back(n * width);
      for (size_t i = 0; i < n * width; ++i) values.data()[i] = static_cast<std::uint8_t>(i * 41 + i / 256);
      to_planes(values.data(), n, width, planes.data());
      for (size_t k = 0; k < width; ++k)
        for (size_t i = 0; i < n; ++i) ASSERT_EQ(planes.data()[k * n + i], values.data()[i * width + k]) << width << " " << n;
      from_planes(planes.data(), n, width, back.data());
      for (size_t i = 0; i < n * width; ++i) ASSERT_EQ(back.data()[i], values.data()[i]) << width << " " << n;
    }
}

TEST(BytePlanes, NothingIsWrittenBeyondTheLastValue) {
  for (const size_t width : {1u, 2u, 4u, 8u}) {
    constexpr size_t n = 13;
    Bytes from(n * width), to(n * width + 1);
    to.data()[n * width] = 77;
    to_planes(from.data(), n, width, to.data());
    EXPECT_EQ(to.data()[n * width], 77);
    from_planes(from.data(), n, width, to.data());
    EXPECT_EQ(to.data()[n * width], 77);
  }
}

}  // namespace
}  // namespace swath::io
