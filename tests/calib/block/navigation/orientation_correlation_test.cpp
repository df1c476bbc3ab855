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
    for (std::uint32_t j = i - std::min(i, 1u); j <= i; ++j) out.pairs.push_back({i, j, PoseCovariance::Random() * 1e-7});
  for (CovariancePair& p : out.pairs)
    if (p.image == p.other) p.value = p.value * p.value.transpose() * 1e14;
  return out;
}

void write(const std::filesystem::path& file, const OrientationCorrelation& correlation, const std::string& crs) {
  CorrelationFile to(file, crs);
  for (const CovariancePair& p : correlation.pairs) to.add(correlation.images[p.image], correlation.images[p.other], p.value);
  to.commit();
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
  write(folder / "c.csv", written, "EPSG:32632");
  const OrientationCorrelation read = read_correlation(folder / "c.csv");
  EXPECT_EQ(read.images, written.images);
  EXPECT_EQ(read.crs, "EPSG:32632");
  ASSERT_EQ(read.pairs.size(), 5u);
  for (size_t k = 0; k < 5; ++k) {
    EXPECT_EQ(read.pairs[k].image, written.pairs[k].image);
    EXPECT_EQ(read.pairs[k].other, written.pairs[k].other);
    EXPECT_LT((read.pairs[k].value - written.pairs[k].value).norm(), 1e-11 * written.pairs[k].value.norm());
  }
}

/// More rows than are held at a time.
TEST(OrientationCorrelation, LongFilesAreWhole) {
  constexpr std::uint32_t images = 3000;
  OrientationCorrelation written;
  for (std::uint32_t i = 0; i < images; ++i) {
    written.images.push_back("image " + std::to_string(i));
    written.pairs.push_back({i, i, PoseCovariance::Identity() * (1.0 + i)});
  }
  const test::TemporaryFolder folder;
  write(folder / "c.csv", written, "local");
  EXPECT_GT(std::filesystem::file_size(folder / "c.csv"), 1u << 20);
  const OrientationCorrelation read = read_correlation(folder / "c.csv");
  EXPECT_EQ(read.images, written.images);
  for (std::uint32_t i = 0; i < images; ++i) EXPECT_EQ(read.pairs[i].value, written.pairs[i].value) << i;
}

std::string header() {
  std::string out = "image,other";
  for (int k = 0; k < 36; ++k) out += ",c" + std::to_string(k / 6 + 1) + std::to_string(k % 6 + 1);
  return out + "\n";
}

TEST(OrientationCorrelation, OneHalfOfACovarianceIsRefused) {
  const auto row = [](double upper, double lower) {
    std::string out = "b,b";
    for (int k = 0; k < 36; ++k) {
      const int r = k / 6, c = k % 6;
      const double value = r == c ? 1e-4 : r == 1 && c == 3 ? upper : r == 3 && c == 1 ? lower : 0.0;
      out += "," + std::to_string(value * 1e4) + "e-4";
    }
    return out + "\n";
  };
  std::string first = row(0, 0);
  first.replace(0, 3, "a,a");
  EXPECT_EQ(fault_of(header() + first + row(5e-5, 5e-5)), "");
  EXPECT_EQ(fault_of(header() + first + row(5e-5, 0.0)),
            "the covariance of image b with itself is not symmetric: c42 is not c24 at c.csv:3");
  EXPECT_NE(fault_of(header() + row(5e-5, 4.99e-5)), "");
}

TEST(OrientationCorrelation, AnotherGridIsRefused) {
  OrientationCorrelation c;
  const auto fault = [&](const std::string& stated, const std::string& crs) -> std::string {
    c.crs = stated;
    try {
      expect_grid(c, crs, "c.csv");
    } catch (const core::Error& e) {
      return e.what();
    }
    return "";
  };
  EXPECT_EQ(fault("", "EPSG:32632"), "");
  EXPECT_EQ(fault("local", "local"), "");
  EXPECT_EQ(fault("EPSG:25832+ellipsoidal", "EPSG:25832"), "");  // the grid is the same
  EXPECT_EQ(fault("EPSG:32632", "EPSG:32633"), "its covariances are on the grid of EPSG:32632, the block is on that of EPSG:32633");
  EXPECT_NE(fault("EPSG:32632", "local"), "");
  EXPECT_NE(fault("local", "EPSG:32632"), "");
}

TEST(OrientationCorrelation, WhatIsNoTableIsRefused) {
  EXPECT_EQ(fault_of(header()), "no row of data at c.csv");
  EXPECT_EQ(fault_of(header() + "a,a,1\n"), "the line has 3 fields, the header 38 columns at c.csv:2");
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
