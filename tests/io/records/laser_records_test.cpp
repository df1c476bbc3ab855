// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/records/laser_records.h"

#include "core/error.h"
#include "io/text/npy.h"
#include "tests/world/support.h"

namespace swath::io {
namespace {

class Records : public ::testing::Test {
 protected:
  LaserFile file(const std::string& name) {
    LaserFile f;
    f.file = folder_ / name;
    f.columns.time = "t";
    f.columns.line = "line";
    f.columns.range = "r";
    f.columns.scan_angle = "a";
    return f;
  }
  test::TemporaryFolder folder_;
  Survey survey_;
};

TEST_F(Records, TextGivesPlacesToStartFrom) {
  test::write_bytes(folder_ / "a.csv", "t,line,r,a\n1,7,10,0.1\n\n# remark\n2,7,20,0.2\n3,8,30,0.3\n");
  LaserRecords r;
  ASSERT_TRUE(open_laser_records(survey_, file("a.csv"), Wanted::plan)->next(r, 10));
  EXPECT_EQ(r.record, (std::vector<std::uint64_t>{0, 1, 2}));
  EXPECT_EQ(r.text_line, (std::vector<std::uint64_t>{2, 5, 6}));
  EXPECT_EQ(r.line, (std::vector<double>{7, 7, 8}));
  EXPECT_TRUE(r.range.empty());
  const auto part = open_laser_records(survey_, file("a.csv"), Wanted::all, {1, r.byte[1], r.text_line[1]}, 2);
  ASSERT_TRUE(part->next(r, 10));
  EXPECT_EQ(r.record, (std::vector<std::uint64_t>{1}));
  EXPECT_EQ(r.range, (std::vector<double>{20}));
  EXPECT_FALSE(part->next(r, 10));
}

TEST_F(Records, NumpyStartsAnywhere) {
  const std::vector<double> t{1, 2, 3}, line{7, 7, 8}, range{10, 20, 30}, angle{0.1, 0.2, 0.3};
  NpyWriter w(folder_ / "a.npy", {{"a", "f4"}, {"t", "f8"}, {"line", "u1"}, {"r", "f8"}});
  w.append({angle.data(), t.data(), line.data(), range.data()}, 3);
  w.commit();
  LaserRecords r;
  const auto reader = open_laser_records(survey_, file("a.npy"), Wanted::all, {1, 0, 0});
  ASSERT_TRUE(reader->next(r, 1));
  EXPECT_EQ(r.record, (std::vector<std::uint64_t>{1}));
  EXPECT_EQ(r.range, (std::vector<double>{20}));
  ASSERT_TRUE(reader->next(r, 5));
  EXPECT_EQ(r.line, (std::vector<double>{8}));
  EXPECT_FALSE(reader->next(r, 5));
}

TEST_F(Records, MissingColumnsAndUnknownFormatsAreErrors) {
  test::write_bytes(folder_ / "a.csv", "t,lines,r,a\n1,7,10,0.1\n");
  try {
    open_laser_records(survey_, file("a.csv"), Wanted::plan);
    FAIL();
  } catch (const core::Error& e) {
    EXPECT_NE(e.hint().find("'lines'"), std::string::npos) << e.text();
  }
  EXPECT_THROW(open_laser_records(survey_, file("a.dat"), Wanted::plan), core::Error);
  test::write_bytes(folder_ / "a.las", "LASF");
  EXPECT_THROW(open_laser_records(survey_, file("a.las"), Wanted::plan), core::Error);
}

TEST(RecordsReference, LasAndCsdStateTheirTime) {
  SWATH_SHARED_OR_SKIP(data, "data");
  const Survey survey;
  LaserFile f;
  f.file = data / "tiny_survey/laser_socs.las";
  EXPECT_EQ(time_of(survey, f).scale, core::TimeScale::gps_adjusted);
  f.file = data / "optech_csd/sample.csd";
  EXPECT_EQ(time_of(survey, f).week, 1660);
  LaserRecords r;
  const auto reader = open_laser_records(survey, f, Wanted::all, {990, 0, 0});
  ASSERT_TRUE(reader->next(r, 1000));
  EXPECT_EQ(r.size(), 10u);
  EXPECT_EQ(r.return_count[0], 1);
  f.file = data / "als_leeward/points.las";
  EXPECT_THROW(time_of(survey, f), core::Error);  // seconds of week, week not stated
}

}  // namespace
}  // namespace swath::io
