// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/records/trajectory_text.h"

#include <cmath>
#include <sstream>

#include "core/error.h"
#include "io/records/trajectory_file.h"
#include "tests/world/support.h"

namespace swath::io {
namespace {

/// Three seconds across the end of a GPS week, which is no end of a UTC day: midnight UTC is 18 s later.
core::TrajectoryData flight(bool rich) {
  core::TrajectoryData t;
  for (int i = 0; i < 300; ++i) {
    const double s = 0.01 * i;
    t.time.push_back(core::from_week(2317, 604798.5) + s);
    t.latitude.push_back(-0.8 + 1e-5 * s);
    t.longitude.push_back(3.1 + 2e-5 * s);
    t.height.push_back(-12.5 + s);
    t.roll.push_back(-0.01);
    t.pitch.push_back(0.02);
    t.heading.push_back(6.2);
    if (!rich) continue;
    t.v_north.push_back(50);
    t.v_east.push_back(-20);
    t.v_down.push_back(1);
    t.sigma_north.push_back(0.01f);
    t.sigma_east.push_back(0.02f);
    t.sigma_down.push_back(0.03f);
    t.sigma_roll.push_back(4e-5f);
    t.sigma_pitch.push_back(5e-5f);
    t.sigma_heading.push_back(1e-4f);
  }
  return t;
}

class TrajectoryText : public ::testing::Test {
 protected:
  /// Reads the text as any survey would.
  core::TrajectoryData read(core::TimeScale scale, const std::string& time, bool rich) {
    Survey survey;
    survey.folder = folder_.path();
    TrajectoryFile f;
    f.file = "t.csv";
    f.angle_unit = AngleUnit::deg;
    f.time.scale = scale;
    f.columns = {};
    f.columns.time = time;
    f.columns.latitude = "latitude_deg";
    f.columns.longitude = "longitude_deg";
    f.columns.height = "height_m";
    f.columns.roll = "roll_deg";
    f.columns.pitch = "pitch_deg";
    f.columns.heading = "heading_deg";
    if (scale == core::TimeScale::gps_week) f.columns.week = "gps_week";
    if (scale == core::TimeScale::utc_day) f.time.date = "2024-06-08";
    if (rich) {
      f.columns.v_north = "v_north_mps";
      f.columns.v_east = "v_east_mps";
      f.columns.v_down = "v_down_mps";
      f.columns.sigma_north = "sigma_north_m";
      f.columns.sigma_east = "sigma_east_m";
      f.columns.sigma_down = "sigma_down_m";
      f.columns.sigma_roll = "sigma_roll_deg";
      f.columns.sigma_pitch = "sigma_pitch_deg";
      f.columns.sigma_heading = "sigma_heading_deg";
    }
    return read_trajectory(survey, f, tally_);
  }
  test::TemporaryFolder folder_;
  const std::filesystem::path file_ = folder_ / "t.csv";
  core::Tally tally_;
};

TEST_F(TrajectoryText, EveryTimeScaleReadsBack) {
  const core::TrajectoryData t = flight(true);
  constexpr double time_tolerance = 3e-7, angle_tolerance = 1e-11;  // the last digits written, and GPS times' own rounding
  for (const auto& [scale, column] : {std::pair{core::TimeScale::gps, "gps_s"},
                                      {core::TimeScale::gps_adjusted, "gps_adjusted_s"},
                                      {core::TimeScale::gps_week, "gps_sow_s"},
                                      {core::TimeScale::unix_utc, "unix_s"},
                                      {core::TimeScale::utc_day, "utc_sod_s"}}) {
    write_trajectory_text(file_, t, scale);
    const core::TrajectoryData back = read(scale, column, true);
    ASSERT_EQ(back.size(), t.size()) << column;
    for (size_t i = 0; i < t.size(); ++i) {
      ASSERT_NEAR(back.time[i], t.time[i], time_tolerance) << column;
      ASSERT_NEAR(back.latitude[i], t.latitude[i], angle_tolerance);
      ASSERT_NEAR(back.longitude[i], t.longitude[i], angle_tolerance);
      ASSERT_NEAR(back.height[i], t.height[i], 1e-6);
      ASSERT_NEAR(back.heading[i], t.heading[i], angle_tolerance);
      ASSERT_NEAR(back.roll[i], t.roll[i], angle_tolerance);
      ASSERT_NEAR(back.v_east[i], t.v_east[i], 1e-6);
      ASSERT_NEAR(back.sigma_east[i], t.sigma_east[i], 1e-8);
      ASSERT_NEAR(back.sigma_heading[i], t.sigma_heading[i], 1e-10);
    }
  }
}

TEST_F(TrajectoryText, WhatATrajectoryLacksHasNoColumn) {
  write_trajectory_text(file_, flight(false), core::TimeScale::gps);
  const std::string text = test::read_bytes(file_);
  EXPECT_EQ(text.substr(0, text.find('\n')), "gps_s,latitude_deg,longitude_deg,height_m,roll_deg,pitch_deg,heading_deg");
  EXPECT_EQ(read(core::TimeScale::gps, "gps_s", false).size(), 300u);
  EXPECT_THROW(write_covariance_text(folder_ / "c.csv", flight(false), core::TimeScale::gps), core::Error);
  EXPECT_THROW(write_trajectory_text(folder_ / "c.csv", flight(false), core::TimeScale::unstated), core::Error);
  EXPECT_FALSE(std::filesystem::exists(folder_ / "c.csv"));
}

TEST_F(TrajectoryText, CovariancesStandAtTheirNodesAsUpperTriangle) {
  core::TrajectoryData t = flight(true);
  core::CovarianceSeries::Matrix9 m;
  for (int i = 0; i < 9; ++i)
    for (int j = 0; j < 9; ++j) m(i, j) = m(j, i) = (i + 1) * 1e-4 + (j + 1) * 1e-7;
  t.covariance.time = {t.time[0], t.time[100]};
  t.covariance.upper = {core::CovarianceSeries::pack(m), core::CovarianceSeries::pack(2.0 * m)};
  write_covariance_text(file_, t, core::TimeScale::gps_week);
  std::istringstream lines(test::read_bytes(file_));
  std::string header, line;
  std::getline(lines, header);
  EXPECT_EQ(header.substr(0, 50), "gps_week,gps_sow_s,north*north,north*east,north*do");
  EXPECT_TRUE(header.ends_with(",pitch*pitch,pitch*heading,heading*heading"));
  for (const double factor : {1.0, 2.0}) {
    ASSERT_TRUE(std::getline(lines, line));
    std::istringstream fields(line);
    std::string field;
    std::getline(fields, field, ',');
    EXPECT_EQ(field, "2317");
    std::getline(fields, field, ',');
    EXPECT_NEAR(std::stod(field), factor == 1.0 ? 604798.5 : 604799.5, 1e-6);
    for (int i = 0; i < 9; ++i)
      for (int j = i; j < 9; ++j) {
        ASSERT_TRUE(std::getline(fields, field, ','));
        EXPECT_NEAR(std::stod(field), factor * m(i, j), 1e-6 * factor * m(i, j));
      }
    EXPECT_FALSE(std::getline(fields, field, ','));
  }
  EXPECT_FALSE(std::getline(lines, line));
}

}  // namespace
}  // namespace swath::io
