// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/records/trajectory_file.h"

#include <cmath>

#include "core/error.h"
#include "core/geo/geodesy.h"
#include "io/records/csd.h"
#include "io/records/sbet.h"
#include "tests/world/support.h"

namespace swath::io {
namespace {

using core::TrajectoryData;

TrajectoryFile text_file(const std::filesystem::path& path) {
  TrajectoryFile f;
  f.file = path;
  f.format = TrajectoryFormat::text;
  f.time = {core::TimeScale::gps_week, 2000, ""};
  f.angle_unit = AngleUnit::deg;
  f.columns.time = "t";
  f.columns.latitude = "lat";
  f.columns.longitude = "lon";
  f.columns.height = "h";
  f.columns.roll = "roll";
  f.columns.pitch = "pitch";
  f.columns.heading = "heading";
  return f;
}

class TrajectoryFiles : public ::testing::Test {
 protected:
  std::filesystem::path made(const std::string& rows, const std::string& name = "a.csv") {
    test::write_bytes(folder_ / name, "t,lat,lon,h,roll,pitch,heading,sn\n" + rows);
    return folder_ / name;
  }
  TrajectoryData read(const std::string& rows) { return read_trajectory(survey_, text_file(made(rows)), tally_); }
  std::string where_of(const std::string& rows) {
    try {
      read(rows);
    } catch (const core::Error& e) {
      return e.where();
    }
    return "no error";
  }
  test::TemporaryFolder folder_;
  Survey survey_;
  core::Tally tally_;
};

TEST_F(TrajectoryFiles, TextInDegreesWithStatedSigmas) {
  TrajectoryFile f = text_file(made("10,48,11,500,1,-2,-90,0.5\n11,48.1,11.1,501,1,-2,450,0.25\n"));
  f.columns.sigma_north = "sn";
  f.sigma_heading = core::degrees(0.01);
  const TrajectoryData t = read_trajectory(survey_, f, tally_);
  EXPECT_EQ(t.time[1], 2000 * 604800.0 + 11);
  EXPECT_DOUBLE_EQ(t.latitude[0], core::degrees(48).value);
  EXPECT_DOUBLE_EQ(t.pitch[0], core::degrees(-2).value);
  EXPECT_NEAR(t.heading[0], core::degrees(270).value, 1e-12);
  EXPECT_NEAR(t.heading[1], core::degrees(90).value, 1e-12);
  EXPECT_EQ(t.sigma_north, (std::vector<float>{0.5f, 0.25f}));
  EXPECT_FLOAT_EQ(t.sigma_east[0], 0.03f);
  EXPECT_FLOAT_EQ(t.sigma_heading[0], static_cast<float>(core::degrees(0.01).value));
  EXPECT_FALSE(t.has_velocity());
}

TEST_F(TrajectoryFiles, FaultsNameTheirPlace) {
  EXPECT_NE(where_of("10,48,11,500,1,2,3,0\n11,48,nan,500,1,2,3,0\n").find("record 1"), std::string::npos);
  EXPECT_NE(where_of("10,48,11,500,1,2,3,0\n9,48,11,500,1,2,3,0\n").find("record 1"), std::string::npos);
  EXPECT_NE(where_of("10,98,11,500,1,2,3,0\n").find("record 0"), std::string::npos);
  EXPECT_NE(where_of("10,48,11,500,1,x,3,0\n").find("a.csv:2"), std::string::npos);
  TrajectoryFile f = text_file(made("10,48,11,500,1,2,3,0\n"));
  f.angle_unit = AngleUnit::unstated;
  EXPECT_THROW(read_trajectory(survey_, f, tally_), core::Error);
  f = text_file(folder_ / "a.csv");
  f.time.scale = core::TimeScale::unstated;
  EXPECT_THROW(read_trajectory(survey_, f, tally_), core::Error);
  f = text_file(folder_ / "a.csv");
  f.columns.roll = "rol";
  try {
    read_trajectory(survey_, f, tally_);
    FAIL();
  } catch (const core::Error& e) {
    EXPECT_NE(e.hint().find("'roll'"), std::string::npos);
  }
}

TEST_F(TrajectoryFiles, RepeatedTimesAndGapsAreCounted) {
  std::string rows;
  for (int i = 0; i < 20; ++i)
    rows += std::to_string(100.0 + 0.1 * i + (i > 10 ? 3 : 0)) + ",48,11," + std::to_string(i) + ",1,2,3,0\n" +
            (i == 4 ? std::to_string(100.4) + ",48,11,99,1,2,3,0\n" : "");
  const TrajectoryData t = read(rows);
  ASSERT_EQ(t.size(), 20u);
  EXPECT_EQ(t.height[5], 5);
  EXPECT_EQ(t.sigma_roll.size(), 20u);
  EXPECT_EQ(tally_.of("trajectory records at a repeated time, left out"), 1u);
  EXPECT_EQ(tally_.of("trajectory gaps"), 1u);
}

TEST_F(TrajectoryFiles, FilesAreJoinedInTimeOrderAndNeverOverlap) {
  survey_.trajectory = {text_file(made("20,48,11,2,1,2,3,0\n21,48,11,3,1,2,3,0\n", "b.csv")),
                        text_file(made("10,48,11,0,1,2,3,0\n20,48,11,1,1,2,3,0\n", "a.csv"))};
  const TrajectoryData t = read_trajectory(survey_, tally_);
  EXPECT_EQ(t.height, (std::vector<double>{0, 1, 3}));
  survey_.trajectory[1] = text_file(made("10,48,11,0,1,2,3,0\n20.5,48,11,1,1,2,3,0\n", "a.csv"));
  try {
    read_trajectory(survey_, tally_);
    FAIL();
  } catch (const core::Error& e) {
    EXPECT_NE(std::string(e.what()).find("a.csv and"), std::string::npos) << e.text();
    EXPECT_NE(std::string(e.what()).find("0.5 s"), std::string::npos) << e.text();
  }
}

TEST_F(TrajectoryFiles, AWeekColumnCarriesOverTheWeeksEnd) {
  test::write_bytes(folder_ / "w.csv", "w,t,lat,lon,h,roll,pitch,heading\n2000,604799.5,48,11,0,1,2,3\n2001,0.5,48,11,0,1,2,3\n");
  TrajectoryFile f = text_file(folder_ / "w.csv");
  f.columns.week = "w";
  f.time.week.reset();
  const TrajectoryData t = read_trajectory(survey_, f, tally_);
  EXPECT_DOUBLE_EQ(t.time[1] - t.time[0], 1.0);
}

TEST(TrajectoryReference, ProjectedTextOfARealFlight) {
  SWATH_SHARED_OR_SKIP(data, "data/sbet_houston");
  TrajectoryFile f = text_file(data / "sbet_047_IGS08-UTM15N-Ellipsoid-trim.txt");
  f.columns = {};
  f.columns.time = "GpsTime";
  f.columns.latitude = "Y";
  f.columns.longitude = "X";
  f.columns.height = "Z";
  f.columns.roll = "Roll";
  f.columns.pitch = "Pitch";
  f.columns.heading = "Azimuth";
  f.crs = "EPSG:32615";
  core::Tally tally;
  const TrajectoryData t = read_trajectory(Survey{}, f, tally);
  ASSERT_EQ(t.size(), 14600u);
  EXPECT_NEAR(core::to_degrees(t.latitude[0]), 29.71, 0.05);
  EXPECT_NEAR(core::to_degrees(t.longitude[0]), -95.31, 0.05);
  EXPECT_NEAR(t.height[0], 538.873527, 1e-6);
  // 67 m/s over ground by the ellipsoid, although the grid's scale is 0.9996 there: a check of the projection.
  const size_t n = t.size() - 1;
  const double ground =
      (core::ecef_of({t.latitude[n], t.longitude[n], t.height[n]}) - core::ecef_of({t.latitude[0], t.longitude[0], t.height[0]})).norm();
  EXPECT_NEAR(ground / (t.time[n] - t.time[0]), 67, 1);
  EXPECT_NEAR(core::to_degrees(t.heading[0]), 360 - 90.494178, 1e-9);
}

TEST(TrajectoryReference, CsdCarriesItsOwn) {
  SWATH_SHARED_OR_SKIP(file, "data/optech_csd/sample.csd");
  Survey survey;
  survey.laser.emplace_back().file = file;
  core::Tally tally;
  const TrajectoryData t = read_trajectory(survey, tally);
  EXPECT_EQ(t.size(), 15u);  // 14 ms at 1 ms
  EXPECT_NEAR(t.time[0], 1660 * 604800.0 + 575644.744845639, 1e-6);
  EXPECT_TRUE(t.has_sigma());
}

}  // namespace
}  // namespace swath::io
