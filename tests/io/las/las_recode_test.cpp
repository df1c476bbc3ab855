// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/las/las_recode.h"

#include <gtest/gtest.h>

#include <cmath>

#include "core/error.h"
#include "io/las/las_block.h"
#include "tests/io/las_sample.h"
#include "tests/world/support.h"

namespace swath::io {
namespace {

std::vector<std::uint8_t> records_as(const LasPoints& p, LasHeader h) {
  h.record_length = static_cast<std::uint16_t>(las_layout(h.point_format)->size + h.extra_bytes());
  std::vector<std::uint8_t> out(p.size() * h.record_length);
  encode_las_points(p, 0, p.size(), h, out, "test");
  return out;
}

TEST(LasRecode, ScaledFieldsBecomeFloatsAndAllOthersStayByteForByte) {
  LasHeader h = test::sample_header(7, 4, true);
  h.record_length = static_cast<std::uint16_t>(las_layout(7)->size + h.extra_bytes());
  h.extras[4].scale = {{0.001, 0, 0}};  // 32 bits: a float does not hold them
  const LasPoints p = test::sample_points(h, 500);
  LasHeader to = h;
  to.extras = float_extras(h.extras);
  EXPECT_EQ(to.extras[3].type, 9);
  EXPECT_EQ(to.extras[4].type, 10);
  for (const std::size_t k : {0u, 1u, 2u, 5u, 6u, 7u, 8u, 9u, 10u}) EXPECT_TRUE(is_same_field(h.extras[k], to.extras[k])) << k;
  LasRecoder recode(h, to, "test");
  to.record_length = static_cast<std::uint16_t>(las_layout(7)->size + to.extra_bytes());
  LasPoints back;
  decode_las_points(recode(records_as(p, h)), to, back);
  EXPECT_EQ(back.raw_x, p.raw_x);
  EXPECT_EQ(back.gps_time, p.gps_time);
  EXPECT_EQ(back.red, p.red);
  for (const LasExtra& e : h.extras) {
    if (e.type == 0) continue;
    const std::vector<double> was = las_extra_values(p, h, e.name), is = las_extra_values(back, to, e.name);
    const double step = e.name == "type4" ? 400.0 * 1.2e-7 : 0.0;  // of a float, for 16 bits in steps of 0.01
    ASSERT_EQ(was.size(), is.size());
    for (std::size_t i = 0; i < was.size(); ++i) {
      EXPECT_EQ(std::isnan(was[i]), std::isnan(is[i])) << e.name;
      if (!std::isnan(was[i])) {
        EXPECT_NEAR(was[i], is[i], step) << e.name;
      }
    }
  }
}

TEST(LasRecode, FieldsThatTilesDefineOtherwiseAreOurs) {
  LasHeader a = test::sample_header(6), b = a;
  a.extras = las_extras_of({core::Column::range, core::Column::sigma_v});
  b.extras = a.extras;
  b.extras[1] = test::extra_field("sigma_v", 9);  // as a cloud had it
  const std::vector<LasExtra> common = common_extras({b, a});
  EXPECT_TRUE(is_same_field(common[1], a.extras[1]));
  EXPECT_TRUE(is_same_field(common_extras({b, b})[1], b.extras[1])) << "where all agree it stays";
  EXPECT_TRUE(is_same_field(float_extras(a.extras)[0], test::extra_field("range", 9))) << "ours fit a float";
  b.extras.pop_back();
  EXPECT_THROW(common_extras({a, b}), core::Error);
  b.extras.push_back(test::extra_field("other", 9));
  EXPECT_THROW(common_extras({a, b}), core::Error);
}

TEST(LasRecode, RecordsOfAFileComeWholeAndACutFileIsAnError) {
  const test::TemporaryFolder folder;
  const LasHeader h = test::sample_header(6, 4, true);
  const LasPoints p = test::sample_points(h, 70000);
  test::write_sample(folder / "a.las", h, p);
  std::vector<std::string> warnings;
  const LasHeader read = read_las_header(folder / "a.las", warnings);
  std::vector<std::uint8_t> all;
  each_las_records(folder / "a.las", read, [&](std::span<const std::uint8_t> some) { all.insert(all.end(), some.begin(), some.end()); });
  EXPECT_EQ(all, records_as(p, h));
  std::filesystem::resize_file(folder / "a.las", 100000);
  EXPECT_THROW(each_las_records(folder / "a.las", read, [](std::span<const std::uint8_t>) {}), core::Error);
}

}  // namespace
}  // namespace swath::io
