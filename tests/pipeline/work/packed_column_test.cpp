// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/work/packed_column.h"

#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <cstring>
#include <limits>
#include <random>
#include <vector>

namespace swath::pipeline {
namespace {

PackedHead head_of(const std::string& packed) {
  PackedHead head;
  std::memcpy(&head, packed.data(), sizeof head);
  return head;
}

template <class T>
void expect_back(const std::vector<T>& values, const std::string& packed) {
  const PackedHead head = head_of(packed);
  ASSERT_EQ(head.bytes + sizeof head, packed.size());
  std::vector<T> back(values.size());
  ASSERT_TRUE(unpack(head, packed.data() + sizeof head, back.data(), back.size(), sizeof(T)));
  EXPECT_TRUE(values.empty() || std::memcmp(values.data(), back.data(), values.size() * sizeof(T)) == 0);
}

template <class T>
std::vector<T> random_values(size_t n) {
  std::mt19937_64 random(3);
  std::vector<T> out(n);
  for (T& v : out) v = std::bit_cast<T>(static_cast<std::conditional_t<sizeof(T) == 8, std::uint64_t, std::uint32_t>>(random()));
  return out;
}

TEST(PackedColumn, EveryBitComesBackWhateverTheValuesAre) {
  for (const size_t n : {0u, 1u, 2u, 1000u, 70000u}) {
    std::string packed;
    const auto doubles = random_values<double>(n);
    pack(doubles.data(), n, 8, packed);
    expect_back(doubles, packed);
    packed.clear();
    const auto floats = random_values<float>(n);
    pack(floats.data(), n, 4, packed);
    expect_back(floats, packed);
    packed.clear();
    pack_coordinates(doubles.data(), n, packed);
    expect_back(doubles, packed);
  }
}

// As a LAS file has them: a whole number times the scale, and its offset less the block's origin.
TEST(PackedColumn, CoordinatesOfAFileTakeFewBytesAndComeBackToTheLastBit) {
  for (const double scale : {0.001, 0.01, 0.0001, 0.00025, 1.0 / 3.0})
    for (const double offset : {0.0, 500000.0, 612000.0, 612345.0}) {
      std::mt19937 random(5);
      std::normal_distribution<double> step(0.0, 0.5);
      std::vector<double> values;
      double at = 612000.0 - 20.0;
      for (int i = 0; i < 50000; ++i) {
        at += step(random);
        values.push_back(static_cast<std::int32_t>(std::lround((at - offset) / scale)) * scale + (offset - 612000.0));
      }
      std::string packed;
      pack_coordinates(values.data(), values.size(), packed);
      expect_back(values, packed);
      if (scale < 0.3 && std::abs(at - offset) / scale < 2e9) {
        EXPECT_LT(packed.size(), 2.7 * static_cast<double>(values.size())) << scale << " " << offset;
      }
    }
}

TEST(PackedColumn, ValuesThatAreNoDecimalsOrNotFiniteComeBack) {
  const std::vector<double> values{0.0, -0.0, 1.0 / 3.0, std::numeric_limits<double>::infinity(), std::nan(""), 1e300, -5e-324};
  std::string packed;
  pack_coordinates(values.data(), values.size(), packed);
  expect_back(values, packed);
}

TEST(PackedColumn, DamagedBytesAreNoticedOrGiveOtherValuesButNeverMoreOfThem) {
  std::vector<std::uint16_t> values(1000);
  for (size_t i = 0; i < values.size(); ++i) values[i] = static_cast<std::uint16_t>(i * i);
  std::string packed;
  pack(values.data(), values.size(), 2, packed);
  std::vector<std::uint16_t> back(values.size());
  PackedHead head = head_of(packed);
  EXPECT_FALSE(unpack(head, packed.data() + sizeof head, back.data(), back.size() - 1, 2));
  head.bytes -= 1;
  EXPECT_FALSE(unpack(head, packed.data() + sizeof head, back.data(), back.size(), 2));
  EXPECT_FALSE(unpack(head_of(packed), packed.data() + sizeof head, back.data(), back.size() / 2, 2));
  head = head_of(packed);
  head.way = 77;
  EXPECT_FALSE(unpack(head, packed.data() + sizeof head, back.data(), back.size(), 2));
}

TEST(PackedColumn, AFirstCoordinateThatNobodyHasWrittenGivesOtherValues) {
  const std::vector<double> values{1.0, 2.0, 3.0};
  std::string packed;
  pack_coordinates(values.data(), values.size(), packed);
  const std::int64_t first = std::numeric_limits<std::int64_t>::max();  // the sanitizers see where it is added to
  std::memcpy(packed.data() + sizeof(PackedHead), &first, sizeof first);
  std::vector<double> back(values.size());
  EXPECT_TRUE(unpack(head_of(packed), packed.data() + sizeof(PackedHead), back.data(), back.size(), 8));
}

}  // namespace
}  // namespace swath::pipeline
