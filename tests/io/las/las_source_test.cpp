// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/las/las_source.h"

#include <cmath>
#include <limits>

#include "tests/io/las_sample.h"
#include "tests/world/support.h"

namespace swath::io {
namespace {

/// Reads a file's points with their records, as Blocks of a run, and writes them again.
LasPoints carried(const std::filesystem::path& from, const std::filesystem::path& to, const std::function<void(core::Block&)>& change = {},
                  std::uint64_t* overlap_lost = nullptr) {
  LasReader reader(from, 1);
  core::Block block;
  block.origin = {499000.0, 5401000.0, 0.0};
  reader.read(block, static_cast<std::size_t>(reader.header().point_count), {.keep_unknown = true}, 1);
  if (change) change(block);
  LasWriteOptions o;
  o.threads = 1;
  o.sources = std::make_shared<LasSources>(std::vector<LasSource>{{from, reader.header(), {}, true}});
  o.header = o.sources->header(true);
  o.sources->complete(block);
  LasWriter writer(to, o);
  writer.write(block);
  writer.finish();
  if (overlap_lost) *overlap_lost = writer.overlap_lost();
  return test::read_all(to, 1);
}

/// Points with flags, classes and returns that no stage would make.
LasPoints odd_points(const LasHeader& h) {
  LasPoints p = test::sample_points(h, 500);
  for (std::size_t i = 0; i < 100; ++i) {
    p.return_number[i] = static_cast<std::uint8_t>(i % 8);
    p.return_count[i] = static_cast<std::uint8_t>(i % 3);
  }
  if (!p.gps_time.empty()) p.gps_time[7] = std::nextafter(p.gps_time[7], 1e30), p.gps_time[8] = 0.0, p.gps_time[9] = -1.0;
  return p;
}

/// What a store keeps of points whose other columns no stage but the writer reads.
void without_held(core::Block& b) {
  core::for_each_column([&](core::Column c, std::string_view, auto member) {
    if (held_by_source.has(c)) (b.*member).clear();
  });
}

class LasSourceFormat : public ::testing::TestWithParam<int> {};

TEST_P(LasSourceFormat, EveryFieldComesBack) {
  const test::TemporaryFolder folder;
  for (const char* ending : {".las", ".laz"})
    for (const int minor : {-1, 4}) {
      LasHeader h = test::sample_header(GetParam(), minor, true);
      h.guid.fill(0xA7);
      h.creation_day = 77, h.creation_year = 2019;
      h.vlrs.push_back({"vendor", 4711, "odd", {1, 0, 2, 255}, 0, 4});
      h.vlrs.push_back({"LASF_Projection", 34735, "", std::vector<std::uint8_t>(8, 1), 0, 8});
      h.vlrs.push_back({"vendor", 4711, "again", {}, 0, 0});
      if (h.version_minor == 4) h.evlrs.push_back({"vendor", 9, "long", std::vector<std::uint8_t>(70000, 3), 0, 70000});
      const std::filesystem::path from = folder / ("from" + std::to_string(minor) + ending),
                                  to = folder / ("to" + std::to_string(minor) + ending);
      test::write_sample(from, h, odd_points(h), 1);
      const LasPoints before = test::read_all(from, 1);
      EXPECT_EQ(carried(from, to), before);
      EXPECT_EQ(carried(from, to, without_held), before);
      std::vector<std::string> warnings;
      const LasHeader a = read_las_header(from, warnings), b = read_las_header(to, warnings);
      EXPECT_EQ(b.version_minor, a.version_minor);
      EXPECT_EQ(b.point_format, a.point_format);
      EXPECT_EQ(b.scale, a.scale);
      EXPECT_EQ(b.offset, a.offset);
      EXPECT_EQ(b.guid, a.guid);
      EXPECT_EQ(b.creation_day, a.creation_day);
      EXPECT_EQ(b.creation_year, a.creation_year);
      EXPECT_EQ(b.file_source_id, a.file_source_id);
      EXPECT_EQ(b.global_encoding, a.global_encoding);
      for (const auto list : {&LasHeader::vlrs, &LasHeader::evlrs}) {
        ASSERT_EQ((b.*list).size(), (a.*list).size());
        for (std::size_t k = 0; k < (a.*list).size(); ++k) {
          EXPECT_EQ((b.*list)[k].user_id, (a.*list)[k].user_id);
          EXPECT_EQ((b.*list)[k].record_id, (a.*list)[k].record_id);
          EXPECT_EQ((b.*list)[k].description, (a.*list)[k].description);
          EXPECT_EQ((b.*list)[k].data, (a.*list)[k].data);
        }
      }
    }
}

INSTANTIATE_TEST_SUITE_P(Formats, LasSourceFormat, ::testing::Range(0, 11));

TEST(LasSource, ColumnsThatFollowFromTheRecordsAreAsTheyWereReadAndOthersStay) {
  const test::TemporaryFolder folder;
  for (const int format : {3, 8}) {
    const LasHeader h = test::sample_header(format);
    const std::filesystem::path file = folder / (std::to_string(format) + ".laz");
    test::write_sample(file, h, odd_points(h), 1);
    LasReader reader(file, 1);
    core::Block read;
    reader.read(read, 1000, {.keep_unknown = true}, 1);
    EXPECT_TRUE(std::all_of(read.source.row(3) + 4, read.source.row(3) + 16, [](std::uint8_t byte) { return byte == 0; }));
    core::Block kept = read;
    without_held(kept);
    kept.classification.assign(kept.x.size(), 6);
    const LasSources sources({{file, reader.header(), {}, true}});
    sources.complete(kept);
    EXPECT_EQ(kept.classification, std::vector<std::uint8_t>(read.size(), 6));
    kept.classification = read.classification;
    core::for_each_column([&](core::Column, std::string_view name, auto member) { EXPECT_EQ(kept.*member, read.*member) << name; });
  }
}

TEST(LasSource, ChangedColumnsAreWritten) {
  const test::TemporaryFolder folder;
  const LasHeader h = test::sample_header(8);
  test::write_sample(folder / "a.las", h, test::sample_points(h, 50), 1);
  const LasPoints p = carried(folder / "a.las", folder / "b.las", [](core::Block& b) {
    b.classification[3] = 6;
    b.flags[4] = core::flag::withheld;
    b.scan_angle[5] = 0.0F;
    b.height.assign(b.size(), 2.5F);
    b.height[6] = std::numeric_limits<float>::quiet_NaN();
  });
  LasPoints expected = test::read_all(folder / "a.las", 1);
  expected.classification[3] = 6;
  expected.flags[4] = core::flag::withheld;
  expected.raw_scan_angle[5] = 0;
  EXPECT_EQ(p.classification, expected.classification);
  EXPECT_EQ(p.flags, expected.flags);
  EXPECT_EQ(p.raw_scan_angle, expected.raw_scan_angle);
  EXPECT_EQ(p.channel, expected.channel);
  LasReader r(folder / "b.las", 1);
  const std::vector<double> height = las_extra_values(p, r.header(), las_name::height);
  EXPECT_EQ(height[5], 2.5);
  EXPECT_TRUE(std::isnan(height[6]));
  EXPECT_FALSE(r.header().extras.back().nodata);  // a float is unknown by itself: no number stands for it
}

TEST(LasSource, AFieldOfOursStaysUntilItsColumnChanges) {
  const test::TemporaryFolder folder;
  LasHeader h = test::sample_header(6);
  LasExtra height = test::extra_field(las_name::height, 6);  // as it was written before: whole millimetres with nodata
  height.nodata = {{las_integer_bits(std::numeric_limits<std::int32_t>::min()), 0, 0}};
  height.scale = {{0.001, 0, 0}};
  h.extras = {height};
  LasPoints p = test::sample_points(h, 20);
  std::vector<double> values(20, 1.234);
  values[2] = std::numeric_limits<double>::quiet_NaN();
  set_las_extra_values(p, h, las_name::height, values, "test");
  test::write_sample(folder / "a.las", h, p, 1);
  EXPECT_EQ(carried(folder / "a.las", folder / "same.las").extra, p.extra);
  const LasPoints q = carried(folder / "a.las", folder / "changed.las", [](core::Block& b) { b.height[0] = 7.0F; });
  LasReader r(folder / "changed.las", 1);
  ASSERT_EQ(r.header().extras.size(), 1u);
  EXPECT_EQ(r.header().extras[0].type, 9);
  const std::vector<double> found = las_extra_values(q, r.header(), las_name::height);
  EXPECT_EQ(found[0], 7.0);
  EXPECT_NEAR(found[1], 1.234, 0.0005);
  EXPECT_TRUE(std::isnan(found[2]));
}

TEST(LasSource, FilesThatDifferShareOneHeader) {
  LasHeader a = test::sample_header(1), b = test::sample_header(3);
  a.extras = {test::extra_field("amplitude", 3), test::extra_field("width", 9)};
  b.extras = {test::extra_field("width", 9), test::extra_field("amplitude", 5)};
  b.scale = {0.0001, 0.01, 0.01};
  b.global_encoding = 0;
  las_header_bytes(a, 0, "a"), las_header_bytes(b, 0, "b");
  const LasSources both({{"a", a, {}, true}, {"b", b, {.week = 2000}, true}});
  const LasHeader h = both.header(true);
  EXPECT_EQ(h.point_format, 3);
  EXPECT_EQ(h.scale, Eigen::Vector3d(0.0001, 0.001, 0.0025));
  ASSERT_EQ(h.extras.size(), 3u);
  EXPECT_EQ(h.extras[2].name, "amplitude_2");
  EXPECT_TRUE(h.gps_time_is_adjusted());  // weeks and adjusted times together: all become adjusted
  const LasHeader mixed = LasSources({{"a", a, {}, true}, {"c", test::sample_header(8), {}, true}}).header(true);
  EXPECT_EQ(mixed.point_format, 8);
  EXPECT_EQ(mixed.version_minor, 4);
}

TEST(LasSource, WaveformPacketsGoWithTheirPoints) {
  const test::TemporaryFolder folder;
  LasHeader h = test::sample_header(9);
  h.global_encoding |= las_encoding::waveform_internal;
  h.evlrs.push_back({"vendor", 3, "before", {1, 2, 3}, 0, 3});
  h.evlrs.push_back({"LASF_Spec", 65535, "Waveform data packets", {9, 8, 7, 6}, 0, 4});
  test::write_sample(folder / "a.las", h, test::sample_points(h, 10), 1);
  carried(folder / "a.las", folder / "b.las");
  std::vector<std::string> warnings;
  const LasHeader b = read_las_header(folder / "b.las", warnings);
  EXPECT_TRUE(b.global_encoding & las_encoding::waveform_internal);
  ASSERT_EQ(b.evlrs.size(), 2u);
  EXPECT_EQ(b.waveform_start, b.evlrs[1].offset - las_evlr_head);
  const std::string bytes = test::read_bytes(folder / "b.las");
  EXPECT_EQ(bytes.substr(b.evlrs[1].offset, 4), std::string({9, 8, 7, 6}));
  // Points of two files refer to packets of both: neither goes along, and the report says so.
  const LasHeader a = read_las_header(folder / "a.las", warnings);
  const LasSources two({{folder / "a.las", a, {}, true}, {folder / "b.las", b, {}, true}});
  EXPECT_FALSE(two.header(true).global_encoding & las_encoding::waveform_internal);
  EXPECT_EQ(two.left_out().size(), 2u);
}

TEST(LasSource, RecordsOfAFilesOwnBytesStayBehind) {
  LasHeader h = test::sample_header(6);
  h.vlrs.push_back({"copc", 1, "COPC info", std::vector<std::uint8_t>(160), 0, 160});
  h.vlrs.push_back({"LASF_Projection", 2112, "WKT", {'x', 0}, 0, 2});
  const LasSources one({{"a", h, {}, true}});
  EXPECT_EQ(one.header(true).vlrs.size(), 1u);
  EXPECT_TRUE(one.header(false).vlrs.empty());
  ASSERT_EQ(one.left_out().size(), 1u);
  EXPECT_NE(one.left_out()[0].find("copc 1"), std::string::npos);
}

TEST(LasSource, OverlapThatAFormatCannotHoldIsCounted) {
  const test::TemporaryFolder folder;
  const LasHeader h = test::sample_header(1);
  LasPoints p = test::sample_points(h, 10);
  std::fill(p.classification.begin(), p.classification.end(), std::uint8_t{12});
  test::write_sample(folder / "a.las", h, p, 1);
  std::uint64_t lost = 0;
  const LasPoints q = carried(
      folder / "a.las", folder / "b.las", [](core::Block& b) { b.classification[2] = core::point_class::building; }, &lost);
  EXPECT_EQ(lost, 1u);
  EXPECT_EQ(q.classification[2], core::point_class::building);
  EXPECT_EQ(q.classification[3], 12);
}

}  // namespace
}  // namespace swath::io
