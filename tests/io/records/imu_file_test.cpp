// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/records/imu_file.h"

#include <cmath>
#include <functional>
#include <numeric>

#include "core/error.h"
#include "core/geo/frames.h"
#include "core/geo/geodesy.h"
#include "io/gnss/gnss_file.h"
#include "io/text/npy.h"
#include "tests/io/records/imu_case.h"

namespace swath::io {
namespace {

using Eigen::Vector3d;

TEST_F(ImuFiles, RatesThatAreMeansTimesTheStep) {
  const core::ImuData imu = read(made(300, at_100_hz, level));
  ASSERT_EQ(imu.size(), 300u);
  EXPECT_NEAR(imu.time[0], core::from_week(2317, 1000), place);
  for (size_t k = 0; k < imu.size(); ++k) {
    EXPECT_NEAR(imu.step[k], 0.01, place);
    EXPECT_NEAR((imu.angle[k] - imu.step[k] * Vector3d(0.01, 0.02, 0.03 + 1e-6 * static_cast<double>(k))).norm(), 0, 1e-15);
    EXPECT_NEAR((imu.velocity[k] - imu.step[k] * Vector3d(0.1, 0.2, -g - 1e-6 * static_cast<double>(k))).norm(), 0, 1e-12);
    if (k > 0) {
      EXPECT_EQ(imu.time[k] - imu.step[k], imu.time[k - 1]);
    }
  }
  EXPECT_TRUE(tally_.empty()) << example("IMU gaps");
}

TEST_F(ImuFiles, InstantsAreTrapezoidsAndBeginWithoutAnIncrement) {
  ImuFile f = made(300, at_100_hz, [](int k) { return core::format_number(0.001 * k) + ",0,0,0,0,-9.81"; });
  f.sample = ImuSample::instant;
  const core::ImuData imu = read(f);
  ASSERT_EQ(imu.size(), 299u);
  EXPECT_NEAR(imu.time[0], core::from_week(2317, 1000.01), place);
  // The integral of a ramp is exact by trapezoids.
  double sum = 0;
  for (const Vector3d& a : imu.angle) sum += a.x();
  EXPECT_NEAR(sum, 0.5 * 0.1 * 2.99 * 2.99, 0.3 * place);
  EXPECT_EQ(tally_.of("IMU records that only begin a stretch of instants (no increment of their own)"), 1u);
}

TEST_F(ImuFiles, IncrementsUnitsFactorsAxesAndMounting) {
  // A sensor with x back, y right, z up; counts of 1/16 mg s and of 1e-4 gon.
  const double v = -g * 0.01 / 9.80665e-3 * 16;
  ImuFile f = made(300, at_100_hz, [&](int k) { return core::format_number(1 + 1e-3 * k) + ",2,3,0,0," + core::format_number(-v); });
  f.kind = ImuKind::increments;
  f.angle_unit = AngleUnit::gon;
  f.gyro_factor = 1e-4;
  f.acceleration_unit = AccelerationUnit::mg;
  f.accelerometer_factor = 1.0 / 16;
  f.axes = {"-x", "y", "-z"};
  core::ImuData imu = read(f);
  const double unit = 1e-4 * core::pi / 200;
  EXPECT_NEAR((imu.angle[0] - unit * Vector3d(-1, 2, -3)).norm(), 0, 1e-15);
  EXPECT_NEAR((imu.velocity[0] - Vector3d(0, 0, -g * 0.01)).norm(), 0, 1e-12);
  f.roll = core::degrees(5);
  f.pitch = core::degrees(-3);
  f.heading = core::degrees(90);
  imu = read(f);
  const Eigen::Matrix3d R = core::matrix_of({core::degrees(5).value, core::degrees(-3).value, core::degrees(90).value});
  EXPECT_NEAR((imu.angle[0] - unit * (R * Vector3d(-1, 2, -3))).norm(), 0, 1e-15);
}

TEST_F(ImuFiles, StampsAreMovedToTheEnd) {
  ImuFile f = made(300, at_100_hz, level);
  f.stamp = ImuStamp::start;
  EXPECT_NEAR(read(f).time[0], core::from_week(2317, 1000.01), place);
  f.stamp = ImuStamp::middle;
  EXPECT_NEAR(read(f).time[0], core::from_week(2317, 1000.005), place);
}

TEST_F(ImuFiles, AxesMustBeRightHanded) {
  ImuFile f = made(300, at_100_hz, level);
  for (const auto& [axes, words] : {std::pair{std::array<std::string, 3>{"x", "-y", "z"}, "left-handed"},
                                    {{"x", "x", "z"}, "twice"},
                                    {{"x", "w", "z"}, "no axis"},
                                    {{"x", "-", "z"}, "no axis"},
                                    {{"", "y", "z"}, "no axis"}}) {
    f.axes = axes;
    EXPECT_NE(refusal(f).find(words), std::string::npos) << refusal(f);
    EXPECT_NE(refusal(f).find("hint"), std::string::npos);
  }
}

TEST_F(ImuFiles, GapsShowInTheStepsAndAreCounted) {
  for (const ImuKind kind : {ImuKind::rates, ImuKind::increments})
    for (const double gap : {0.001, 0.01, 0.5, 10.0}) {
      if (kind == ImuKind::rates && gap < 0.005) continue;  // a mean since the record before covers it
      tally_ = {};
      const double length = kind == ImuKind::rates ? 1 : 0.01;
      ImuFile f = made(
          600, [&](int k) { return at_100_hz(k) + (k >= 300 ? gap : 0); },
          [&](int k) { return "0.01,0,0," + core::format_number(1e-7 * k) + ",0," + core::format_number(-g * length); });
      f.kind = kind;
      f.angle_unit = AngleUnit::deg;
      f.gyro_factor = kind == ImuKind::rates ? 100 : 1;
      const core::ImuData imu = read(f);
      ASSERT_EQ(imu.size(), 600u);
      for (size_t k = 1; k < imu.size(); ++k) {
        const double missing = imu.time[k] - imu.step[k] - imu.time[k - 1];
        EXPECT_NEAR(missing, k == 300 ? gap : 0.0, k == 300 ? 2 * place : 0.0) << k;
      }
      EXPECT_EQ(tally_.of("IMU gaps"), 1u);
      EXPECT_EQ(example("IMU gaps").find(core::format_number(gap) + " s from 2024-06-02T00:16:2"), 0u) << example("IMU gaps");
    }
}

TEST_F(ImuFiles, RoundedTimesAreSmoothed) {
  const auto rounded = [](int k) { return std::floor((1000 + k / 128.0) * 1e3 + 0.5) * 1e-3; };
  ImuFile f = made(2000, rounded, level);
  core::ImuData imu = read(f);
  for (size_t k = 1; k < imu.size(); ++k) EXPECT_NEAR(imu.step[k], 1 / 128.0, 0.1e-3);
  EXPECT_EQ(tally_.of("IMU files whose times jitter and are smoothed"), 1u);
  EXPECT_NEAR(std::accumulate(imu.step.begin(), imu.step.end(), 0.0), 2000 / 128.0, 0.5e-3);
  f.even_times = false;
  imu = read(f);
  EXPECT_NEAR(imu.step[1], 0.008, place);
}

TEST_F(ImuFiles, TheWeekRollsOver) {
  const auto over = [](int k) { return std::fmod(604799 + 0.01 * k, 604800); };
  const core::ImuData imu = read(made(300, over, level));
  EXPECT_NEAR(imu.time.back(), core::from_week(2318, 1.99), place);
  EXPECT_EQ(tally_.of("IMU gaps"), 0u);
}

TEST_F(ImuFiles, ADeviceThatCountsMilliseconds) {
  ImuFile f = made(
      300, [](int k) { return 261906 + 10 * k; }, level);
  f.time = {core::TimeScale::device, {}, ""};
  f.time.unit = core::Seconds(0.001);
  f.time.origin = "2025-07-08T19:34:21.985 GPS";
  f.time.origin_at = 261906;
  f.time.offset = core::Seconds(-0.125);
  EXPECT_NEAR(read(f).time[1], core::from_week(2374, 243261.985 + 0.01 - 0.125), place);
}

TEST_F(ImuFiles, NumpyIsReadAsText) {
  std::vector<std::vector<double>> columns(7);
  for (int k = 0; k < 300; ++k) {
    const double v[7] = {at_100_hz(k), 0.01, 0.02, 0.03, 0.1, 0.2, -g - 1e-6 * k};
    for (size_t c = 0; c < 7; ++c) columns[c].push_back(v[c]);
  }
  NpyWriter w(folder_ / "imu.npy", {{"t", "f8"}, {"wx", "f8"}, {"wy", "f8"}, {"wz", "f8"}, {"fx", "f8"}, {"fy", "f8"}, {"fz", "f8"}});
  std::vector<const double*> values;
  for (const auto& c : columns) values.push_back(c.data());
  w.append(values, 300);
  w.commit();
  const core::ImuData imu = read(rates_file(folder_ / "imu.npy"));
  ASSERT_EQ(imu.size(), 300u);
  EXPECT_NEAR(imu.velocity[9].z(), -0.01 * (g + 9e-6), g * place);
}

TEST_F(ImuFiles, FilesAreJoinedAndNeverOverlap) {
  const ImuFile b = made(
      300, [](int k) { return at_100_hz(k + 300); }, level, "b.csv");
  const ImuFile a = made(300, at_100_hz, level, "a.csv");
  const ImuFile c = made(
      300, [](int k) { return at_100_hz(k + 700); }, level, "c.csv");
  survey_.imu = {c, b, a};
  const core::ImuData imu = read_imu(survey_, tally_);
  ASSERT_EQ(imu.size(), 900u);
  for (size_t k = 1; k < imu.size(); ++k) EXPECT_NEAR(imu.time[k] - imu.step[k] - imu.time[k - 1], k == 600 ? 1.0 : 0.0, 2 * place) << k;
  EXPECT_EQ(tally_.of("IMU gaps"), 1u);
  survey_.imu = {a, made(
                        300, [](int k) { return at_100_hz(k + 200); }, level, "d.csv")};
  try {
    read_imu(survey_, tally_);
    FAIL();
  } catch (const core::Error& e) {
    EXPECT_NE(std::string(e.what()).find("a.csv and"), std::string::npos);
    EXPECT_NE(std::string(e.what()).find("overlap by 1 s"), std::string::npos) << e.what();
  }
  survey_.imu.clear();
  EXPECT_THROW(read_imu(survey_, tally_), core::Error);
}

TEST(ImuReference, ATacticalFlight) {
  SWATH_SHARED_OR_SKIP(file, "data/tiny_survey/imu.csv");
  ImuFile f = rates_file(file);
  f.kind = ImuKind::increments;
  f.columns = {"gps_sow_s", "", "dtheta_x_rad", "dtheta_y_rad", "dtheta_z_rad", "dv_x_mps", "dv_y_mps", "dv_z_mps"};
  core::Tally tally;
  const core::ImuData imu = read_imu(Survey{}, f, tally);
  ASSERT_EQ(imu.size(), 6180u);
  EXPECT_TRUE(tally.empty()) << tally.value().members()[0].first;
  EXPECT_NEAR(imu.time[0] - imu.step[0], core::from_week(2317, 474006.0017), place);
  // Radians stated as degrees, degrees as radians, m/s2 as g and turned axes are noticed.
  f.angle_unit = AngleUnit::deg;
  read_imu(Survey{}, f, tally);
  EXPECT_EQ(tally.of("IMU files that hardly turn: radians stated as degrees, or it stood still"), 1u);
  f.angle_unit = AngleUnit::rad;
  f.gyro_factor = 180 / core::pi;
  read_imu(Survey{}, f, tally);
  EXPECT_EQ(tally.of("IMU files with implausibly large angular rates: degrees stated as radians?"), 1u);
  f.gyro_factor = 1;
  f.acceleration_unit = AccelerationUnit::g;
  EXPECT_THROW(read_imu(Survey{}, f, tally), core::Error);
  f.acceleration_unit = AccelerationUnit::mps2;
  f.axes = {"z", "x", "y"};
  EXPECT_THROW(read_imu(Survey{}, f, tally), core::Error);
}

/// The car's set-up: the sensor's x points back and its z up; the rest of its mounting as stated with the data.
Survey car(const std::filesystem::path& folder) {
  Survey s;
  s.folder = folder;
  ImuFile& f = s.imu.emplace_back();
  f.file = "imu_1934.csv";
  f.time = {core::TimeScale::device, {}, ""};
  f.time.unit = core::Seconds(0.001);
  f.time.origin = "2025-07-08T19:34:21.985 GPS";
  f.time.origin_at = 261906;
  f.time.offset = core::Seconds(-0.125);
  f.kind = ImuKind::rates;
  f.angle_unit = AngleUnit::deg;
  f.acceleration_unit = AccelerationUnit::g;
  f.axes = {"-x", "y", "-z"};
  f.roll = core::degrees(-0.636);
  f.pitch = core::degrees(-6.760);
  f.heading = core::degrees(5.388);
  f.columns = {"7", "", "4", "5", "6", "1", "2", "3"};
  s.gnss.emplace_back().file = "gnss_1934_sf.pos";
  return s;
}

TEST(ImuReference, ADriveMovesAsItsGnssDoes) {
  SWATH_SHARED_OR_SKIP(folder, "data/car_imu_rtk/drive_0708");
  const Survey survey = car(folder);
  core::Tally tally;
  const core::ImuData imu = read_imu(survey, tally);
  const core::GnssData gnss = read_gnss(survey, tally);
  ASSERT_EQ(imu.size(), 54860u);
  EXPECT_EQ(tally.of("IMU gaps"), 0u);
  EXPECT_EQ(tally.of("IMU files whose times jitter and are smoothed"), 1u);
  EXPECT_EQ(tally.of("IMU records that repeat the values of the one before (kept)"), 1138u);
  // It stands for the first 5 s: specific force straight up.
  Vector3d standing = Vector3d::Zero();
  for (size_t k = 0; k < 500; ++k) standing += imu.velocity[k] / 5.0;
  EXPECT_NEAR(standing.x(), 0, 0.1);
  EXPECT_NEAR(standing.y(), 0, 0.3);  // the street's cross fall
  EXPECT_NEAR(standing.z(), -9.81, 0.15);
  // Over half seconds: the force forward goes with the gain of speed, that to the right with speed times turn, the turn with the course.
  double speed_gain = 0, forward = 0, aside = 0, right = 0, course = 0, turn = 0;
  size_t k = 0, used = 0;
  for (size_t i = 1; i + 1 < gnss.size(); ++i) {
    const Eigen::Matrix3d R = core::ecef_R_ned(core::geodetic_of(gnss.position[i]).latitude, core::geodetic_of(gnss.position[i]).longitude);
    const Vector3d before = R.transpose() * gnss.velocity[i - 1], after = R.transpose() * gnss.velocity[i + 1];
    const double v0 = before.head<2>().norm(), v1 = after.head<2>().norm();
    if (gnss.time[i - 1] < imu.time.front() || gnss.time[i + 1] > imu.time.back() || v0 < 3 || v1 < 3) continue;
    while (imu.time[k] <= gnss.time[i - 1]) ++k;
    Vector3d angle = Vector3d::Zero(), velocity = Vector3d::Zero();
    for (size_t j = k; imu.time[j] <= gnss.time[i + 1]; ++j) {
      angle += imu.angle[j];
      velocity += imu.velocity[j];
    }
    const double d = core::wrap_pi(std::atan2(after.y(), after.x()) - std::atan2(before.y(), before.x()));
    const double s = 0.5 * (v0 + v1) * d;
    speed_gain += (v1 - v0) * (v1 - v0);
    forward += (v1 - v0) * velocity.x();
    aside += s * s;
    right += s * velocity.y();
    course += d * d;
    turn += d * angle.z();
    ++used;
  }
  EXPECT_GT(used, 1500u);
  // Slopes: a tenth for what the car's own nodding and leaning adds.
  EXPECT_NEAR(forward / speed_gain, 1, 0.12);
  EXPECT_NEAR(right / aside, 1, 0.1);
  EXPECT_NEAR(turn / course, 1, 0.02);
}

}  // namespace
}  // namespace swath::io
