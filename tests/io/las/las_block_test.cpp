// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/las/las_block.h"

#include <cmath>
#include <limits>
#include <numbers>

#include "core/error.h"
#include "tests/io/las_sample.h"
#include "tests/world/support.h"

namespace swath::io {
namespace {

constexpr double degree = std::numbers::pi / 180.0;

LasHeader prepared(LasHeader h) {
  las_header_bytes(h, 0, "test");  // sets the record length
  return h;
}

TEST(LasBlock, LegacyClassesAndFlagsBecomeOurs) {
  LasHeader h = prepared(test::sample_header(1));
  LasPoints p;
  resize(p, h, 2);
  p.classification = {12, 2};
  p.flags = {0, core::flag::key_point};
  p.raw_scan_angle = {-10, 20};
  p.gps_time = {100.0, 200.0};
  p.point_source_id = {3, 4};
  core::Block b;
  b.origin = {500000.0, 5400000.0, 0.0};
  LasTimesRead read;
  las_points_to_block(p, h, 40, {}, read, "test", b);
  EXPECT_EQ(b.classification, (std::vector<std::uint8_t>{1, 2}));
  EXPECT_EQ(b.flags, (std::vector<std::uint16_t>{core::flag::overlap, core::flag::key_point}));
  EXPECT_EQ(b.record, (std::vector<std::uint32_t>{40, 41}));
  EXPECT_EQ(b.strip, (std::vector<std::uint16_t>{3, 4}));
  EXPECT_NEAR(b.scan_angle[1], 20.0 * degree, 1e-6);
  EXPECT_EQ(b.time[0], 1.0e9 + 100.0);
  EXPECT_EQ(b.z[0], -100.0);
  EXPECT_TRUE(b.red.empty());
}

TEST(LasBlock, SecondsOfWeekNeedTheirWeek) {
  LasHeader h = prepared(test::sample_header(1));
  h.global_encoding = 0;
  LasPoints p;
  resize(p, h, 3);
  p.gps_time = {604790.0, 604799.0, 5.0};
  core::Block b;
  LasTimesRead read;
  EXPECT_THROW(las_points_to_block(p, h, 0, {}, read, "test", b), core::Error);
  las_points_to_block(p, h, 0, {2000, false}, read, "test", b);
  EXPECT_EQ(b.time[0], 2000 * 604800.0 + 604790.0);
  EXPECT_EQ(b.time[2], 2001 * 604800.0 + 5.0);  // over the end of the week
  las_points_to_block(p, h, 0, {std::nullopt, true}, read, "test", b);
  EXPECT_EQ(b.time[2], 5.0);
  p.gps_time[1] = 3.0e8;
  EXPECT_THROW(las_points_to_block(p, h, 0, {2000, false}, read, "test", b), core::Error);
}

}  // namespace
}  // namespace swath::io
