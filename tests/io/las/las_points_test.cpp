// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/las/las_points.h"

#include <cmath>
#include <limits>

#include "core/error.h"
#include "tests/io/las_sample.h"
#include "tests/world/support.h"

namespace swath::io {
namespace {

LasHeader prepared(LasHeader h) {
  las_header_bytes(h, 0, "test");  // sets the record length
  return h;
}

TEST(LasPoints, EveryFormatEncodesAndDecodes) {
  for (int format = 0; format <= 10; ++format) {
    const LasHeader h = prepared(test::sample_header(format, -1, true));
    const LasPoints p = test::sample_points(h, 300);
    std::vector<std::uint8_t> records(300u * h.record_length);
    encode_las_points(p, 0, 300, h, records, "test");
    LasPoints r;
    decode_las_points(records, h, r);
    EXPECT_TRUE(r == p) << format;
  }
}

TEST(LasPoints, BitsStandWhereTheSpecificationPutsThem) {
  const LasHeader old = prepared(test::sample_header(1)), now = prepared(test::sample_header(6));
  LasPoints p;
  resize(p, old, 1);
  p.return_number = {5};
  p.return_count = {6};
  p.scan_direction = {1};
  p.classification = {2};
  p.flags = {core::flag::withheld};
  p.raw_scan_angle = {-7};
  std::vector<std::uint8_t> b(old.record_length);
  encode_las_points(p, 0, 1, old, b, "test");
  EXPECT_EQ(b[14], 5 | 6 << 3 | 1 << 6);
  EXPECT_EQ(b[15], 2 | 1 << 7);
  EXPECT_EQ(b[16], 256 - 7);
  resize(p, now, 1);
  p.flags = {core::flag::overlap};
  p.channel = {2};
  p.edge_of_line = {1};
  p.classification = {200};
  p.raw_scan_angle = {-30000};
  b.assign(now.record_length, 0);
  encode_las_points(p, 0, 1, now, b, "test");
  EXPECT_EQ(b[14], 5 | 6 << 4);
  EXPECT_EQ(b[15], 8 | 2 << 4 | 1 << 6 | 1 << 7);
  EXPECT_EQ(b[16], 200);
  decode_las_points(b, now, p);
  EXPECT_FLOAT_EQ(p.scan_angle[0], -180.0f);
}

TEST(LasPoints, ValuesThatDoNotFitAreRefused) {
  const LasHeader h = prepared(test::sample_header(1));
  std::vector<std::uint8_t> b(h.record_length);
  const auto refused = [&](auto change) {
    LasPoints p;
    resize(p, h, 1);
    change(p);
    EXPECT_THROW(encode_las_points(p, 0, 1, h, b, "test"), core::Error);
  };
  refused([](LasPoints& p) { p.return_number = {8}; });
  refused([](LasPoints& p) { p.return_count = {8}; });
  refused([](LasPoints& p) { p.classification = {32}; });
  refused([](LasPoints& p) { p.flags = {core::flag::overlap}; });
  refused([](LasPoints& p) { p.raw_scan_angle = {128}; });
}

TEST(LasPoints, ExtraFieldsAreNumbersWithScaleOffsetAndNodata) {
  const LasHeader h = prepared(test::sample_header(6, -1, true));
  LasPoints p;
  resize(p, h, 3);
  const std::vector<double> values{1.25, -3.0, 100.0};
  for (const char* name : {"type2", "type6", "type8", "type9", "type10"}) {
    const std::vector<double> whole{1.0, -3.0, 100.0};
    set_las_extra_values(p, h, name, whole, "test");
    EXPECT_EQ(las_extra_values(p, h, name), whole) << name;
  }
  set_las_extra_values(p, h, "type10", values, "test");
  EXPECT_EQ(las_extra_values(p, h, "type10"), values);
  const std::vector<double> with_gap{1.25, std::numeric_limits<double>::quiet_NaN(), -320.0};
  set_las_extra_values(p, h, "type4", with_gap, "test");
  const std::vector<double> read = las_extra_values(p, h, "type4");
  EXPECT_NEAR(read[0], 1.25, 1e-12);
  EXPECT_TRUE(std::isnan(read[1]));
  EXPECT_NEAR(read[2], -320.0, 1e-12);
  EXPECT_TRUE(las_extra_values(p, h, "none").empty());
  const auto set = [&](const char* name, double v) { set_las_extra_values(p, h, name, std::vector<double>{v, 0.0, 0.0}, "test"); };
  EXPECT_THROW(set("type1", 256.0), core::Error);
  EXPECT_THROW(set("type3", -1.0), core::Error);
  EXPECT_THROW(set("type4", 5.0 - 327.68), core::Error);  // its nodata
  EXPECT_THROW(set("type5", std::numeric_limits<double>::quiet_NaN()), core::Error);
  EXPECT_THROW(set("type7", 18446744073709551616.0), core::Error);
  EXPECT_THROW(set("none", 0.0), core::Error);
}

}  // namespace
}  // namespace swath::io
