// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/text/packed_column.h"

#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <cstring>
#include <limits>
#include <random>
#include <vector>

namespace swath::io {
namespace {

PackedHead head_of(const std::string& packed) {
  PackedHead head;
  std::memcpy(&head, packed.data(), sizeof head);
  return head;
}

template <class T>
void expect_back(const std::vector<T>& values, const std::string& packed, size_t width = sizeof(T)) {
  const PackedHead head = head_of(packed);
  ASSERT_EQ(head.bytes + sizeof head, packed.size());
  std::vector<T> back(values.size());
  ASSERT_TRUE(unpack(head, packed.data() + sizeof head, back.data(), back.size() * sizeof(T) / width, width));
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

// A foot CRS: what the file has is converted to metres.
TEST(PackedColumn, CoordinatesInFeetTakeFewBytes) {
  for (const double unit : {0.3048, 1200.0 / 3937.0}) {
    std::vector<double> values;
    for (int i = 0; i < 50000; ++i) values.push_back(((4000000 + i % 7000 * 13) * 0.01 - 30000.0) * unit);
    std::string packed;
    pack_coordinates(values.data(), values.size(), packed);
    expect_back(values, packed);
    EXPECT_LT(packed.size(), 4 * values.size()) << unit;
  }
}

struct Row {
  std::uint16_t low = 0;
  std::uint8_t bits = 0;
  std::uint8_t time[8]{};  // where no number of 8 bytes would be aligned
  std::uint8_t level = 0;
};

std::vector<Row> rows_of(size_t n) {
  std::mt19937 random(11);
  std::vector<Row> out(n);
  for (size_t i = 0; i < n; ++i) {
    out[i].low = static_cast<std::uint16_t>(random());
    out[i].bits = static_cast<std::uint8_t>(i % 5 == 0);
    const double t = 3e8 + 1e-5 * static_cast<double>(i / 2);
    std::memcpy(out[i].time, &t, sizeof t);
    out[i].level = static_cast<std::uint8_t>(i / 1000);
  }
  return out;
}

TEST(PackedColumn, RowsComeBackWhateverTheirFieldsAre) {
  for (const size_t n : {0u, 1u, 2u, 1000u, 70000u}) {
    const std::vector<Row> rows = rows_of(n);
    const auto* bytes = reinterpret_cast<const std::uint8_t*>(rows.data());
    const std::vector<std::uint8_t> found = fields_of_rows(bytes, n, sizeof(Row)), ones(sizeof(Row), 1), odd{1, 8, 2, 1}, short_of_it{8};
    for (const auto& fields : {found, ones, odd, short_of_it, {}}) {
      std::string packed;
      pack_rows(bytes, n, sizeof(Row), fields, packed);
      expect_back(rows, packed);
    }
  }
  const auto noise = random_values<std::uint32_t>(3 * 5000);
  std::string packed;
  const auto* bytes = reinterpret_cast<const std::uint8_t*>(noise.data());
  pack_rows(bytes, 5000, 12, fields_of_rows(bytes, 5000, 12), packed);
  expect_back(noise, packed, 12);
}

TEST(PackedColumn, RowsTakeFewerBytesByTheirFields) {
  const std::vector<Row> rows = rows_of(50000);
  const auto* bytes = reinterpret_cast<const std::uint8_t*>(rows.data());
  std::string whole, by_fields;
  pack_rows(bytes, rows.size(), sizeof(Row), {}, whole);
  pack_rows(bytes, rows.size(), sizeof(Row), fields_of_rows(bytes, rows.size(), sizeof(Row)), by_fields);
  EXPECT_LT(2 * by_fields.size(), whole.size() + 2 * rows.size());  // beside two bytes that nothing makes smaller
}

TEST(PackedColumn, RowsOfDamagedFieldsAreNoticed) {
  const std::vector<Row> rows = rows_of(300);
  const auto* bytes = reinterpret_cast<const std::uint8_t*>(rows.data());
  std::string packed;
  pack_rows(bytes, rows.size(), sizeof(Row), {2, 1, 8, 1}, packed);
  std::vector<Row> back(rows.size());
  const auto is_back = [&](const std::string& of, std::uint32_t size) {
    PackedHead head = head_of(of);
    head.bytes = size;
    return unpack(head, of.data() + sizeof head, back.data(), back.size(), sizeof(Row));
  };
  const std::uint32_t whole = head_of(packed).bytes;
  EXPECT_TRUE(is_back(packed, whole));
  for (std::uint32_t n = 0; n < whole; ++n) EXPECT_FALSE(is_back(packed, n)) << n;
  for (const size_t at : {sizeof(PackedHead), sizeof(PackedHead) + 4, sizeof(PackedHead) + 6}) {
    std::string damaged = packed;
    damaged[at] = '\x40';  // the number of fields, the width of one
    EXPECT_FALSE(is_back(damaged, whole)) << at;
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
}  // namespace swath::io
