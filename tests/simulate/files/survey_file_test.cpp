// SPDX-License-Identifier: GPL-3.0-or-later
#include "simulate/files/survey_file.h"

#include <gtest/gtest.h>

#include "core/config/option_visitors.h"
#include "io/text/value_file.h"

namespace swath::simulate {
namespace {

TEST(SurveyFile, LeavesOutDefaultsAndStatesCalibrationInFull) {
  io::Survey s;
  s.crs = "EPSG:32632";
  s.laser.resize(1);
  s.laser[0].file = "laser.npy";
  const std::string text = survey_toml(s, "# note\n");
  EXPECT_EQ(text.rfind("# note\n", 0), 0u);
  EXPECT_NE(text.find("[calibration]\nroll = \"0 deg\""), std::string::npos) << text;
  EXPECT_NE(text.find("[sigma]"), std::string::npos);
  EXPECT_NE(text.find("model = \"mirror\""), std::string::npos);
  EXPECT_EQ(text.find("wavelength"), std::string::npos);
  EXPECT_EQ(text.find("delimiter"), std::string::npos);
}

TEST(SurveyFile, EveryListOfTablesLosesItsOwnDefaultsOnly) {
  io::Survey s;
  s.crs = "EPSG:32632";
  s.imu.resize(1);
  s.imu[0].file = "imu.csv";
  s.imu[0].kind = io::ImuKind::rates;
  s.imu[0].columns.gyro_z = "wz";
  s.gnss.resize(2);
  s.gnss[0].file = "a.pos";
  s.gnss[1].file = "b.csv";
  s.gnss[1].angle_unit = io::AngleUnit::rad;
  s.gnss[1].columns.cov_xy = "cxy";
  s.clock = {{"loopstats", io::ClockFormat::loopstats}, {"pps.log", io::ClockFormat::pps}};
  s.events.resize(1);
  s.events[0].file = "events.csv";
  s.events[0].computer_clock = true;
  s.points.resize(1);
  s.points[0].file = "points.las";
  s.imu_spec.grade = core::ImuGrade::mems;
  s.imu_spec.gyro_scale = core::Ratio(2e-3);
  const std::string text = survey_toml(s, "");
  io::Survey back;
  std::vector<core::Fault> faults;
  core::read_options(core::described(back), io::parse_toml(text, "made"), "", faults);
  EXPECT_TRUE(faults.empty()) << faults.front().text() << "\n" << text;
  EXPECT_EQ(core::fingerprint_of(core::described(back)), core::fingerprint_of(core::described(s))) << text;
  EXPECT_EQ(back.gnss[1].columns.cov_xy, "cxy");
  EXPECT_EQ(back.clock[1].format, io::ClockFormat::pps);
  EXPECT_NE(text.find("format = \"loopstats\""), std::string::npos) << text;   // nothing in the name tells it
  EXPECT_NE(text.find("[antenna]\nlever_arm = "), std::string::npos) << text;  // stated in full beside GNSS
  for (const char* left_out : {"sample", "sigma_velocity", "latency = \"0 s\"\n\n[[event", "spacing", "height_unit"})
    EXPECT_EQ(text.find(left_out), std::string::npos) << left_out << "\n" << text;
}

TEST(SurveyFile, ACameraHasWhatASurveyNeverGuesses) {
  io::Survey s;
  s.crs = "EPSG:32632";
  s.cameras.emplace_back();
  const std::string text = survey_toml(s, "");
  for (const char* stated : {"\nf = \"0.1 m\"", "\nmount = \"0 deg\"", "\nlever_arm = [\"0 m\", \"0 m\", \"0 m\"]"})
    EXPECT_NE(text.find(stated), std::string::npos) << stated << "\n" << text;
  EXPECT_EQ(text.find("boresight"), std::string::npos);
}

}  // namespace
}  // namespace swath::simulate
