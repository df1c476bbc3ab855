// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/records/laser_file.h"

#include <cmath>
#include <cstring>

#include "core/error.h"
#include "io/las/las_box.h"
#include "tests/io/las_sample.h"
#include "tests/world/support.h"

namespace swath::io {
namespace {

using core::Shots;

Shots read_strip(const Survey& survey, const StripInfo& strip, size_t most, core::Tally& tally, size_t* batches = nullptr) {
  LaserSource source(survey, strip);
  Shots all, batch;
  while (source.next(batch, most)) {
    if (batches) ++*batches;
    const auto add = [](auto& to, const auto& from) { to.insert(to.end(), from.begin(), from.end()); };
    add(all.time, batch.time);
    add(all.angle, batch.angle);
    add(all.forward, batch.forward);
    add(all.range, batch.range);
    add(all.intensity, batch.intensity);
    add(all.return_number, batch.return_number);
    add(all.return_count, batch.return_count);
    add(all.flags, batch.flags);
    add(all.record, batch.record);
  }
  tally.add(source.tally());
  return all;
}

class LaserFiles : public ::testing::Test {
 protected:
  LaserFiles() {
    LaserFile& f = survey_.laser.emplace_back();
    f.file = folder_ / "a.csv";
    f.time = {core::TimeScale::gps, {}, ""};
    f.angle_unit = AngleUnit::deg;
    f.columns.time = "t";
    f.columns.range = "r";
    f.columns.scan_angle = "a";
    f.columns.intensity = "i";
    f.columns.return_number = "n";
    f.columns.return_count = "k";
  }
  void made(const std::string& rows) { test::write_bytes(folder_ / "a.csv", "t,line,r,a,i,n,k\n" + rows); }
  std::vector<StripInfo> strips() { return scan(survey_, tally_); }
  Shots shots(size_t which = 0) { return read_strip(survey_, strips().at(which), 1000, tally_); }
  core::Error error_of(const std::string& rows) {
    made(rows);
    try {
      for (const StripInfo& s : strips()) read_strip(survey_, s, 1000, tally_);
    } catch (const core::Error& e) {
      return e;
    }
    ADD_FAILURE() << "no error for " << rows;
    return core::Error("none");
  }
  test::TemporaryFolder folder_;
  Survey survey_;
  core::Tally tally_;
};

TEST_F(LaserFiles, ReturnsOutsideTheBoxOfTheHeaderAreCounted) {
  LasHeader h = test::sample_header(6);
  h.offset.setZero();
  h.scale.setConstant(0.001);
  LasPoints p;
  resize(p, h, 100);
  for (size_t i = 0; i < p.size(); ++i) {
    p.raw_y[i] = static_cast<int>(i) * 1000 - 50000, p.raw_z[i] = 300000;  // -50 to 49 m to the right, 300 m down
    p.gps_time[i] = 1e6 + 0.01 * static_cast<double>(i), p.point_source_id[i] = 1;
  }
  survey_.laser[0] = {};
  for (const char* name : {"a.las", "a.laz"}) {
    test::write_sample(folder_ / name, h, p);
    survey_.laser[0].file = folder_ / name;
    survey_.laser[0].format = LaserFormat::las;
    tally_ = {};
    EXPECT_EQ(shots().size(), 100u);
    EXPECT_EQ(tally_.of(outside_box), 0u);
    std::string bytes = test::read_bytes(folder_ / name);
    const double largest = 39.5;
    std::memcpy(&bytes[195], &largest, sizeof largest);  // y
    test::write_bytes(folder_ / name, bytes);
    EXPECT_EQ(shots().size(), 100u);
    EXPECT_EQ(tally_.of(outside_box), 10u) << name;
    EXPECT_EQ(tally_.of(wrong_box), 1u) << name;
  }
}

TEST_F(LaserFiles, ReturnsOutsideTheBoxAreCountedForTheirOwnLineAlone) {
  LasHeader h = test::sample_header(6);
  h.offset.setZero();
  h.scale.setConstant(0.001);
  LasPoints p;
  resize(p, h, 100);
  for (size_t i = 0; i < p.size(); ++i) {
    p.raw_y[i] = static_cast<int>(i) * 1000 - 50000, p.raw_z[i] = 300000;  // -50 to 49 m to the right, 300 m down
    p.gps_time[i] = 1e6 + 0.01 * static_cast<double>(i), p.point_source_id[i] = static_cast<std::uint16_t>(i % 2 ? 8 : 5);
  }
  survey_.laser[0] = {};
  for (const char* name : {"a.las", "a.laz"}) {
    test::write_sample(folder_ / name, h, p);
    std::string bytes = test::read_bytes(folder_ / name);
    const double largest = 39.5;
    std::memcpy(&bytes[195], &largest, sizeof largest);  // y: rows 90 to 99 lie outside, five of each line
    test::write_bytes(folder_ / name, bytes);
    survey_.laser[0].file = folder_ / name;
    survey_.laser[0].format = LaserFormat::las;
    tally_ = {};
    const auto s = strips();
    ASSERT_EQ(s.size(), 2u);
    for (const auto& strip : s) {
      core::Tally tally;
      EXPECT_EQ(read_strip(survey_, strip, 7, tally).size(), 50u);
      EXPECT_EQ(tally.of(outside_box), 5u) << name << " line " << strip.line;
      EXPECT_EQ(tally.of(wrong_box), 1u) << name << " line " << strip.line;
      const std::string said = tally.value().find(wrong_box)->find("examples")->items().front().as_text();
      EXPECT_NE(said.find("line " + std::to_string(strip.line) + ": 5 of 50 points (10 %)"), std::string::npos) << said;
      EXPECT_NE(said.find(strip.line == 5 ? "records 90, 92, 94" : "records 91, 93, 95"), std::string::npos) << said;
    }
  }
}

TEST_F(LaserFiles, AColumnOfLinesMakesStripsEvenInterleaved) {
  survey_.laser[0].columns.line = "line";
  made("1,5,100,0,9,1,1\n2,6,200,0,9,1,1\n3,5,101,0,9,1,1\n4,6,201,0,9,1,1\n4,6,202,0,9,1,1\n");
  const auto s = strips();
  ASSERT_EQ(s.size(), 2u);
  EXPECT_EQ(s[0].line, 5);
  EXPECT_EQ(s[0].first, 0u);
  EXPECT_EQ(s[0].last, 3u);
  EXPECT_EQ(s[0].records, 2u);
  EXPECT_EQ(s[1].first_time, 2);
  EXPECT_EQ(s[1].last_time, 4);
  EXPECT_EQ(s[1].name(survey_), "line 6 of a.csv");
  EXPECT_EQ(read_strip(survey_, s[0], 10, tally_).range, (std::vector<double>{100, 101}));
  EXPECT_EQ(read_strip(survey_, s[1], 10, tally_).record, (std::vector<std::uint32_t>{1, 3, 4}));
  EXPECT_TRUE(tally_.empty());
}

TEST_F(LaserFiles, TimeWindowsMakeStripsAndLeaveTheTurnsOut) {
  survey_.line_time.scale = core::TimeScale::gps;
  survey_.lines = {{9, "", core::Seconds(20), core::Seconds(30)}, {3, "", core::Seconds(10), core::Seconds(20)}};
  std::string rows;
  for (int t = 5; t < 40; ++t) rows += std::to_string(t) + ",0,100,0,9,1,1\n";
  made(rows);
  const auto s = strips();
  ASSERT_EQ(s.size(), 2u);
  EXPECT_EQ(s[0].line, 3);
  EXPECT_EQ(s[0].records, 10u);  // 10 to 19; 20 begins the next line
  EXPECT_EQ(s[1].line, 9);
  EXPECT_EQ(s[1].records, 11u);
  EXPECT_EQ(tally_.of("records outside every line, left out"), 14u);
  const core::Value tally = tally_.value();
  const core::Value* files = tally.find("records outside every line, left out")->find("files");
  ASSERT_TRUE(files);
  EXPECT_EQ(files->items().at(0).find("count")->as_int(), 14);
  EXPECT_EQ(files->items().at(0).find("first_s")->as_number(), 5.0);
  EXPECT_EQ(files->items().at(0).find("last_s")->as_number(), 39.0);
  EXPECT_EQ(read_strip(survey_, s[1], 3, tally_).time.front(), 20);
  survey_.laser[0].line = 9;  // a stated line keeps to its window
  EXPECT_EQ(strips().at(0).records, 11u);
}

TEST_F(LaserFiles, RecordsAWeekFromAllLinesAreRefusedWithTheGap) {
  survey_.line_time.scale = core::TimeScale::gps;
  survey_.lines = {{1, "", core::Seconds(604810), core::Seconds(604830)}};
  const core::Error e = error_of("10,0,100,0,9,1,1\n20,0,100,0,9,1,1\n");
  EXPECT_NE(std::string(e.what()).find("no laser return to work on: records from"), std::string::npos) << e.what();
  EXPECT_NE(e.hint().find("1 week apart"), std::string::npos) << e.hint();
}

TEST_F(LaserFiles, UnitsAndSigns) {
  LaserFile& f = survey_.laser[0];
  f.angle_unit = AngleUnit::gon;
  f.angle_to_port = true;
  f.range_unit = core::Metres(0.3048);
  made("1,0,1000,100,70000,2,300\n");
  const Shots s = shots();
  EXPECT_DOUBLE_EQ(s.angle[0], -core::pi / 2);
  EXPECT_DOUBLE_EQ(s.range[0], 304.8);
  EXPECT_EQ(s.intensity[0], 65535);
  EXPECT_EQ(s.return_number[0], 2);
  EXPECT_EQ(s.return_count[0], 0);
  EXPECT_EQ(tally_.of("intensities cut to 0 to 65535"), 1u);
  EXPECT_EQ(tally_.of("return counts that are none, set to unknown"), 1u);
  EXPECT_EQ(strips()[0].line, 1);
}

TEST_F(LaserFiles, BeamsBecomeRangeAngleAndForward) {
  LaserFile& f = survey_.laser[0];
  f.columns = {};
  f.angle_unit = AngleUnit::unstated;
  f.columns.time = "t";
  f.columns.x = "line";
  f.columns.y = "r";
  f.columns.z = "a";
  made("1,2,3,6,0,0,0\n2,0,0,0,0,0,0\n");
  const Shots s = shots();
  ASSERT_EQ(s.size(), 1u);
  EXPECT_DOUBLE_EQ(s.range[0], 7);
  EXPECT_DOUBLE_EQ(s.forward[0], 2.0 / 7);
  EXPECT_DOUBLE_EQ(s.angle[0], std::atan2(3, 6));
  EXPECT_EQ(tally_.of("records with a range not positive, left out"), 1u);
}

TEST_F(LaserFiles, BadRecordsAreCountedAndKeptOut) {
  made("1,0,100,0,9,1,1\n4,0,-5,0,9,1,1\n7,0,0,0,9,1,1\n8,0,8,0,9,1,1\n9,0,1e30,0,9,1,1\n");
  const Shots s = shots();
  EXPECT_EQ(s.record, (std::vector<std::uint32_t>{0, 3}));
  EXPECT_EQ(tally_.of("records with a range over 100 km, left out"), 1u);
  EXPECT_EQ(tally_.of("records with a range not positive, left out"), 2u);
}

TEST_F(LaserFiles, NumbersThatAreNoneAreErrorsWithTheirRecord) {
  for (const char* row :
       {"nan,0,100,0,9,1,1", "inf,0,100,0,9,1,1", "2,0,nan,0,9,1,1", "2,0,-inf,0,9,1,1", "2,0,,0,9,1,1", "2,0,100,nan,9,1,1"}) {
    const core::Error e = error_of("1,0,100,0,9,1,1\n" + std::string(row) + "\n3,0,8,0,9,1,1\n");
    EXPECT_NE(e.where().find("record 1"), std::string::npos) << row;
    EXPECT_NE(std::string(e.what()).find("not finite"), std::string::npos) << row;
  }
}

TEST_F(LaserFiles, FaultsNameTheRecord) {
  EXPECT_NE(error_of("2,0,100,0,9,1,1\n3,0,100,0,9,1,1\n2.5,0,100,0,9,1,1\n").where().find("record 2"), std::string::npos);
  EXPECT_NE(error_of("2,0,100,0,9,1,1\n3,0,1x0,0,9,1,1\n").where().find("a.csv:3"), std::string::npos);
  survey_.laser[0].columns.line = "line";
  EXPECT_NE(error_of("2,0,100,0,9,1,1\n3,0.5,100,0,9,1,1\n").where().find("record 1"), std::string::npos);
  EXPECT_NE(error_of("2,0,100,0,9,1,1\n3,nan,100,0,9,1,1\n").where().find("record 1"), std::string::npos);
  survey_.laser[0].time = {core::TimeScale::gps_week, 2000, ""};
  EXPECT_NE(error_of("2,0,100,0,9,1,1\n1e9,0,100,0,9,1,1\n").where().find("record 1"), std::string::npos);
  survey_.laser[0].time = {};
  error_of("2,0,100,0,9,1,1\n");
  survey_.laser[0].time = {core::TimeScale::gps, {}, ""};
  survey_.laser[0].angle_unit = AngleUnit::unstated;
  error_of("2,0,100,0,9,1,1\n");
}

TEST_F(LaserFiles, TheWeeksEndIsFollowedFromAnyStrip) {
  survey_.laser[0].time = {core::TimeScale::gps_week, 2000, ""};
  survey_.laser[0].columns.line = "line";
  made("604799,1,100,0,9,1,1\n0.5,1,100,0,9,1,1\n1,2,100,0,9,1,1\n2,2,100,0,9,1,1\n");
  const auto s = strips();
  EXPECT_EQ(read_strip(survey_, s[0], 9, tally_).time[1], 2001 * 604800.0 + 0.5);
  EXPECT_EQ(read_strip(survey_, s[1], 9, tally_).time, (std::vector<double>{2001 * 604800.0 + 1, 2001 * 604800.0 + 2}));
}

TEST_F(LaserFiles, BatchesNeverPartAPulseAndDoNotChangeTheShots) {
  std::string rows;
  for (int i = 0; i < 50000; ++i) rows += std::to_string(i / 3) + ",0," + std::to_string(100 + i % 7) + ",1,9,1,1\n";
  made(rows);
  const auto s = strips();
  const Shots whole = read_strip(survey_, s[0], 1u << 20, tally_);
  for (const size_t most : {1, 7, 1000, 32768}) {
    size_t batches = 0;
    const Shots parts = read_strip(survey_, s[0], most, tally_, &batches);
    EXPECT_EQ(parts.time, whole.time);
    EXPECT_EQ(parts.range, whole.range);
    EXPECT_EQ(parts.record, whole.record);
    if (most == 1) {
      EXPECT_EQ(batches, 16667u);
    }
  }
  LaserSource source(survey_, s[0]);
  Shots batch;
  while (source.next(batch, 100)) EXPECT_EQ(batch.record[0] % 3, 0u);
}

TEST_F(LaserFiles, EveryTruncationIsReadOrRefused) {
  const std::string rows = "1,0,100,0,9,1,1\n2,0,100,0,9,1,1\n";
  for (size_t n = 0; n <= rows.size(); ++n) {
    made(rows.substr(0, n));
    try {
      EXPECT_LE(shots().size(), 2u);
    } catch (const core::Error& e) {
      EXPECT_NE(e.where().find("a.csv"), std::string::npos);
    }
  }
}

/// The three files of one recording.
struct Tiny {
  explicit Tiny(const std::filesystem::path& data) {
    const TimeTags week{core::TimeScale::gps_week, 2317, ""};
    for (const char* name : {"laser.csv", "laser.npy", "laser_socs.las"}) {
      LaserFile& f = survey.laser.emplace_back();
      f.file = data / name;
      f.time = week;
      f.angle_unit = AngleUnit::deg;
    }
    survey.laser[0].columns = {"gps_sow_s", "", "line", "scan_angle_deg", "range_m", "intensity", "return_number", "number_of_returns",
                               "",          "", ""};
    survey.laser[1].columns = {"t", "", "line", "angle_deg", "range", "intensity", "rn", "nr", "", "", ""};
    survey.laser[2].time = {};
    survey.laser[2].angle_unit = AngleUnit::unstated;
  }
  Survey survey;
};

TEST(LaserReference, ThreeFormatsHoldTheSameShots) {
  SWATH_SHARED_OR_SKIP(data, "data/tiny_survey");
  const Tiny tiny(data);
  core::Tally tally;
  const auto strips = scan(tiny.survey, tally);
  ASSERT_EQ(strips.size(), 3u);
  std::vector<Shots> s;
  for (const StripInfo& strip : strips) {
    EXPECT_EQ(strip.line, 1);
    EXPECT_EQ(strip.records, 108430u);
    s.push_back(read_strip(tiny.survey, strip, 10000, tally));
    ASSERT_EQ(s.back().size(), 108430u);
  }
  EXPECT_TRUE(tally.empty());
  // The text writes times to 1 ns (a double holds 0.24 us here), angles to 1e-6 deg; LAS coordinates are rounded to its scale, 1 mm or
  // less, that is half of it in range and half of it over 500 m in angle.
  constexpr double time_step = 3e-7, text_angle = 2e-8, las_range = 1e-3, las_angle = 2e-6;
  for (size_t i = 0; i < s[0].size(); ++i) {
    ASSERT_NEAR(s[0].time[i], s[1].time[i], time_step) << i;
    ASSERT_NEAR(s[0].time[i], s[2].time[i], time_step) << i;
    ASSERT_NEAR(s[0].angle[i], s[1].angle[i], text_angle) << i;
    ASSERT_NEAR(s[0].angle[i], s[2].angle[i], las_angle) << i;
    ASSERT_NEAR(s[0].range[i], s[1].range[i], 1e-9) << i;
    ASSERT_NEAR(s[0].range[i], s[2].range[i], las_range) << i;
    ASSERT_NEAR(s[2].forward[i], 0, 1e-9) << i;
  }
  for (const int k : {1, 2}) {
    EXPECT_EQ(s[0].intensity, s[k].intensity);
    EXPECT_EQ(s[0].return_number, s[k].return_number);
    EXPECT_EQ(s[0].return_count, s[k].return_count);
    EXPECT_EQ(s[0].record, s[k].record);
  }
  EXPECT_EQ(s[0].time[0], 2317 * 604800.0 + 474009.0);
}

TEST(LaserReference, CsdPulses) {
  SWATH_SHARED_OR_SKIP(file, "data/optech_csd/sample.csd");
  Survey survey;
  survey.laser.emplace_back().file = file;
  core::Tally tally;
  const auto strips = scan(survey, tally);
  ASSERT_EQ(strips.size(), 1u);
  const Shots s = read_strip(survey, strips[0], 100, tally);
  ASSERT_EQ(s.size(), 1000u);
  EXPECT_NEAR(s.range[0], 827.3567, 1e-4);
  EXPECT_NEAR(core::to_degrees(s.angle[0]), -14.555, 1e-3);
  EXPECT_NEAR(s.time[0], 1660 * 604800.0 + 575644.74484563898, 1e-6);
  EXPECT_EQ(s.intensity[0], 384);
  EXPECT_EQ(s.record[999], 999u);
}

TEST_F(LaserFiles, DegreesStatedAsRadiansAreRefusedByTheReader) {
  survey_.laser[0].angle_unit = AngleUnit::rad;
  const core::Error e = error_of("1,1,500,-20,9,1,1\n2,1,500,3,9,1,1\n");
  EXPECT_NE(e.text().find("a.csv: record 0"), std::string::npos) << e.text();
  EXPECT_NE(e.text().find("more than a full turn"), std::string::npos) << e.text();
  EXPECT_NE(e.hint().find("angle_unit = \"deg\""), std::string::npos) << e.text();
}

TEST_F(LaserFiles, AProfileLineBesideAMirrorHasNoAngle) {
  survey_.laser[0].model = core::ScannerModel::profile;
  made("1,1,500,20,9,1,1\n2,1,500,3,9,1,1\n");
  EXPECT_EQ(shots().angle, (std::vector<double>{0, 0}));
  survey_.laser[0].columns.scan_angle.clear();
  EXPECT_EQ(shots().angle, (std::vector<double>{0, 0}));
  survey_.laser[0].columns.scan_angle = "a";
  survey_.laser[0].model.reset();
  EXPECT_NEAR(shots().angle[0], 20 * core::degree, 1e-12);
}

}  // namespace
}  // namespace swath::io
