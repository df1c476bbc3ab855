// SPDX-License-Identifier: GPL-3.0-or-later
#include "calib/report/calibration_report.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "calib/report/delivered.h"
#include "core/config/units.h"
#include "core/error.h"
#include "io/raster/geotiff.h"
#include "io/survey/calibration_file.h"
#include "io/text/value_file.h"
#include "tests/calib/report/made_report.h"
#include "tests/world/support.h"

namespace swath::calib {
namespace {

TEST(CalibrationReport, ItsCalibrationIsReadBackByASurvey) {
  const test::TemporaryFolder folder;
  const CalibrationReport r = made_report();
  write_calibration_report(r, folder / "report");
  core::Calibration c;
  core::SensorSigma s;
  c.lever_arm_scanner[1].value = 99.0;  // replaced
  io::load_calibration(folder / "report/calibration.json", c, s);
  const calib::Adjustment& a = r.adjustment;
  // A config's degrees round the last digit.
  constexpr double rounding = 1e-15;
  EXPECT_NEAR(c.roll.value, a.estimates[calib::boresight_roll].value, rounding);
  EXPECT_NEAR(s.roll.value, a.estimates[calib::boresight_roll].sigma, rounding);
  EXPECT_NEAR(s.heading.value, a.estimates[calib::boresight_heading].sigma, rounding);
  EXPECT_EQ(c.range_offset.value, a.estimates[calib::range_offset].value);
  EXPECT_EQ(c.scan_scale, a.estimates[calib::scan_scale].value);
  EXPECT_EQ(s.scan_scale, a.estimates[calib::scan_scale].sigma);
  EXPECT_EQ(c.lever_arm_scanner[0].value, 0.12);
  EXPECT_EQ(c.lever_arm_scanner[1].value, 0.0);
  EXPECT_EQ(s.lever_arm.value, r.sensor.lever_arm.value);
  EXPECT_EQ(s.range.value, r.sensor.range.value);
}

TEST(CalibrationReport, ARefusedParameterKeepsItsStartAndWhatIsKnownOfIt) {
  const CalibrationReport r = made_report(true);
  const DeliveredCalibration d = delivered(r.adjustment, r.sensor);
  EXPECT_EQ(d.calibration.range_scale, 1.0);
  EXPECT_EQ(d.sigma.range_scale, 50e-6);
  EXPECT_EQ(d.calibration.range_offset.value, r.adjustment.estimates[calib::range_offset].value);
}

TEST(CalibrationReport, TheLeverArmsSigmaIsTheLargestOfTheThree) {
  CalibrationReport r = made_report();
  calib::Estimate& e = r.adjustment.estimates[calib::lever_down];
  e.estimated = true;
  e.value = -0.3;
  e.sigma = 0.002;
  EXPECT_EQ(delivered(r.adjustment, r.sensor).sigma.lever_arm.value, r.sensor.lever_arm.value);
  EXPECT_EQ(delivered(r.adjustment, r.sensor).calibration.lever_arm_scanner[2].value, -0.3);
  for (const int k : {calib::lever_forward, calib::lever_right}) {
    r.adjustment.estimates[static_cast<size_t>(k)].estimated = true;
    r.adjustment.estimates[static_cast<size_t>(k)].sigma = 0.001;
  }
  EXPECT_EQ(delivered(r.adjustment, r.sensor).sigma.lever_arm.value, 0.002);
}

TEST(CalibrationReport, EveryFileIsNamedAndThereAndTheSameEachTime) {
  const test::TemporaryFolder folder;
  const CalibrationReport r = made_report();
  const auto files = write_calibration_report(r, folder / "a"), again = write_calibration_report(r, folder / "b");
  EXPECT_EQ(files, again);
  for (const char* name : {"calibration.json", "report.html", "residuals.csv", "corrections.csv", "planes.csv", "sections.csv",
                           "figures/residuals_angle.png", "differences/1_3_after.tif"})
    EXPECT_NE(std::find(files.begin(), files.end(), name), files.end()) << name;
  size_t found = 0;
  for (const auto& e : std::filesystem::recursive_directory_iterator(folder / "a")) found += e.is_regular_file();
  EXPECT_EQ(found, files.size());
  for (const std::string& file : files) EXPECT_EQ(test::read_bytes((folder / "a") / file), test::read_bytes((folder / "b") / file)) << file;
  const core::Grid back = io::read_grid(folder / "a/differences/1_2_after.tif");
  EXPECT_EQ(back.lattice, r.differences[0].after.lattice);
  const core::Value tree = io::read_value_file(folder / "a/calibration.json");
  EXPECT_TRUE(tree.find("calibrated")->as_bool());
}

TEST(CalibrationReport, DifferencesAreInTheUnitsOfTheirCrs) {
  const test::TemporaryFolder folder;
  CalibrationReport r = made_report();
  r.differences.resize(1);
  r.crs = "EPSG:2263";  // US survey feet
  r.unit = r.vertical_unit = 1200.0 / 3937.0;
  write_calibration_report(r, folder / "report");
  const core::Grid back = io::read_grid(folder / "report/differences/1_2_before.tif");
  const core::Grid& grid = r.differences[0].before;
  EXPECT_NEAR(back.lattice.cell * r.unit, grid.lattice.cell, 1e-9);
  const size_t k = grid.lattice.at(100, 10);
  EXPECT_NEAR(static_cast<double>(back.height[k]) * r.unit, static_cast<double>(grid.height[k]), 1e-6);
  const core::Value tree = io::read_value_file(folder / "report/calibration.json");
  EXPECT_EQ(tree.find("differences")->items()[0].find("before")->find("metres_per_unit")->as_number(), r.unit);
}

TEST(CalibrationReport, AnEmptyReportIsWrittenToo) {
  const test::TemporaryFolder folder;
  write_calibration_report(CalibrationReport{}, folder / "empty");
  EXPECT_FALSE(io::read_value_file(folder / "empty/calibration.json").find("calibrated")->as_bool());
}

TEST(CalibrationReport, AFolderThatCannotBeMadeIsOneError) {
  const test::TemporaryFolder folder;
  test::write_bytes(folder / "file", "in the way");
  EXPECT_THROW(write_calibration_report(CalibrationReport{}, folder / "file"), core::Error);
}

}  // namespace
}  // namespace swath::calib
