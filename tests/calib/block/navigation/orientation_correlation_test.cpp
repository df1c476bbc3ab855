// SPDX-License-Identifier: GPL-3.0-or-later
#include "calib/block/navigation/orientation_correlation.h"

#include <gtest/gtest.h>

#include <fstream>

#include "core/error.h"
#include "tests/world/support.h"

namespace swath::calib {
namespace {

OrientationCorrelation made() {
  OrientationCorrelation out;
  out.images = {"a,1", "b", "c"};
  for (std::uint32_t i = 0; i < 3; ++i)
    for (std::uint32_t j = i - std::min(i, 1u); j <= i; ++j) out.pairs.push_back({i, j, PoseCovariance::Random() * (i == j ? 1.0 : 1e-7)});
  return out;
}

std::string fault_of(const std::string& text) {
  const test::TemporaryFolder folder;
  std::ofstream(folder / "c.csv") << text;
  try {
    read_correlation(folder / "c.csv");
  } catch (const core::Error& e) {
    return std::string(e.what()) + " at " + e.where().substr(e.where().rfind('/') + 1);
  }
  return "";
}

TEST(OrientationCorrelation, ReadsWhatItWrites) {
  const OrientationCorrelation written = made();
  const test::TemporaryFolder folder;
  std::ofstream(folder / "c.csv") << correlation_csv(written, "EPSG:32632");
  const OrientationCorrelation read = read_correlation(folder / "c.csv");
  EXPECT_EQ(read.images, written.images);
  ASSERT_EQ(read.pairs.size(), 5u);
  for (size_t k = 0; k < 5; ++k) {
    EXPECT_EQ(read.pairs[k].image, written.pairs[k].image);
    EXPECT_EQ(read.pairs[k].other, written.pairs[k].other);
    EXPECT_LT((read.pairs[k].value - written.pairs[k].value).norm(), 1e-11 * written.pairs[k].value.norm());
  }
}

TEST(OrientationCorrelation, RowsOutOfOrderAreRefused) {
  std::string header = "image,other", numbers;
  for (int k = 0; k < 36; ++k) header += ",c" + std::to_string(k / 6 + 1) + std::to_string(k % 6 + 1), numbers += ",0";
  const auto table = [&](std::initializer_list<const char*> pairs) {
    std::string out = header + "\n";
    for (const char* p : pairs) out += p + numbers + "\n";
    return out;
  };
  EXPECT_EQ(fault_of(table({"a,a", "b,a", "b,b"})), "");
  EXPECT_EQ(fault_of(table({"a,b", "b,b"})), "image a is paired with b, which comes later or not at all at c.csv:2");
  EXPECT_EQ(fault_of(table({"a,a", "b,a", "c,c"})), "image b has no row with itself at c.csv:4");
  EXPECT_EQ(fault_of(table({"a,a", "b,a"})), "image b has no row with itself at c.csv");
  EXPECT_EQ(fault_of(table({"a,a", "b,a", "b,a"})), "this pair of images is there twice at c.csv:4");
  EXPECT_EQ(fault_of(table({"a,a", "b,b", "b,a"})), "rows of image b do not follow one another, that with itself last at c.csv:4");
  EXPECT_NE(fault_of("image,other\na,a\n").find("c11"), std::string::npos);
}

}  // namespace
}  // namespace swath::calib
