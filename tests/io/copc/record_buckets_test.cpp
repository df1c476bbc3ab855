// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/copc/record_buckets.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstring>
#include <random>

#include "core/error.h"
#include "tests/world/support.h"

namespace swath::io {
namespace {

constexpr std::size_t length = 12;

/// Records that are their code and a number.
std::vector<std::uint8_t> made_records(std::size_t n) {
  std::mt19937_64 random(7);
  std::vector<std::uint8_t> out(n * length);
  for (std::uint32_t i = 0; i < n; ++i) {
    const std::uint64_t code = random() >> 1 >> (i % 3 == 0 ? 5 : 0);  // a third of them in the first octants
    std::memcpy(&out[i * length], &code, 8);
    std::memcpy(&out[i * length + 8], &i, 4);
  }
  return out;
}
std::uint64_t code_of(const std::uint8_t* r) {
  std::uint64_t code = 0;
  std::memcpy(&code, r, 8);
  return code;
}

TEST(RecordBuckets, AllRecordsAreInTheirBucketOnceInTheOrderOfTheCurve) {
  const std::vector<std::uint8_t> all = made_records(30000);
  const RecordStream stream = [&](const auto& f) {
    for (std::size_t at = 0; at < all.size(); at += 1000 * length) f(std::span(all).subspan(at, 1000 * length));
  };
  for (const double memory : {1e4, 1e9}) {
    const test::TemporaryFolder folder;
    std::vector<char> seen(30000);
    {
      const RecordBuckets buckets(folder.path(), length, 900, memory, stream, code_of);
      EXPECT_GT(buckets.buckets().size(), 30u);
      std::uint64_t before = 0;
      std::vector<std::uint8_t> records;
      for (const RecordBucket& b : buckets.buckets()) {
        EXPECT_LE(b.points, 900u);
        buckets.read(b, records);
        ASSERT_EQ(records.size(), b.points * length);
        std::uint64_t lowest = ~std::uint64_t{0}, highest = 0;
        for (std::size_t at = 0; at < records.size(); at += length) {
          EXPECT_EQ(octree_key(code_of(&records[at]), b.key.level), b.key);
          lowest = std::min(lowest, code_of(&records[at])), highest = std::max(highest, code_of(&records[at]));
          std::uint32_t number = 0;
          std::memcpy(&number, &records[at + 8], 4);
          ++seen[number];
        }
        EXPECT_GE(lowest, before);
        before = highest;
      }
    }
    EXPECT_TRUE(std::all_of(seen.begin(), seen.end(), [](char n) { return n == 1; }));
    EXPECT_TRUE(std::filesystem::is_empty(folder.path())) << "the temporary file goes with the object";
  }
}

TEST(RecordBuckets, ACubeOfTheDeepestLevelIsNotDividedAndAFolderThatIsMissingIsAnError) {
  const test::TemporaryFolder folder;
  const std::vector<std::uint8_t> all(500 * length);
  const RecordStream stream = [&](const auto& f) { f(std::span(all)); };
  const RecordBuckets buckets(folder.path(), length, 100, 1e6, stream, code_of);
  ASSERT_EQ(buckets.buckets().size(), 1u);
  EXPECT_EQ(buckets.buckets()[0].key.level, octree::cell_bits);
  EXPECT_EQ(buckets.buckets()[0].points, 500u);
  EXPECT_THROW(RecordBuckets(folder / "missing", length, 100, 1e6, stream, code_of), core::Error);
}

}  // namespace
}  // namespace swath::io
