// SPDX-License-Identifier: GPL-3.0-or-later
#include "trajectory/clock/clock_offset.h"

#include <gtest/gtest.h>

#include <cmath>

#include "core/config/result_visitors.h"
#include "core/statistics.h"
#include "core/time.h"
#include "io/gnss/gnss_file.h"
#include "io/records/imu_file.h"
#include "tests/trajectory/ins_run.h"
#include "tests/world/support.h"

namespace swath::trajectory {
namespace {

using core::ImuGrade;
using test::lines_and_turns;
using test::straight_line;
using test::Trial;
using test::trial_of;

constexpr double goal = 0.010;  // s

core::ImuData late(core::ImuData imu, double by) {
  for (double& t : imu.time) t += by;
  return imu;
}

/// The offset found in records whose IMU clock is ahead by `by`.
TimeOffset found(const test::Course& course, ImuGrade grade, std::uint64_t seed, double by, double search = 2.0) {
  const core::ImuErrorModel spec = core::error_model_of(grade);
  const core::ImuData imu = late(test::with_errors(course.exact.imu, spec, seed), by);
  const core::GnssData gnss = test::with_errors(course.exact.gnss, {}, seed);
  return imu_clock_offset(make_path(imu, 10), gnss, spec, course.sensors.lever, 0.02, search);
}

const test::Course& figure_of_eight() {
  static const test::Course course(test::Drive({{0, 1}, {60, 0.6}, {90, 1}, {150, 0}, {170, 1}}), 0, 240);
  return course;
}

TEST(ClockOffset, IsFoundInFlightsWithItsSignAndSigma) {
  for (const ImuGrade grade : {ImuGrade::tactical, ImuGrade::mems, ImuGrade::consumer}) {
    double squares = 0, n = 0;
    for (const double by : {-1.0, -0.3, -0.05, 0.0, 0.05, 0.2, 0.56, 1.0}) {
      const TimeOffset r = found(lines_and_turns(), grade, static_cast<std::uint64_t>(50 + 10 * by), by);
      EXPECT_TRUE(r.determinable) << by << ": " << r.reason;
      if (!r.determinable) continue;
      EXPECT_NEAR(r.value, by, goal);
      EXPECT_EQ(r.is_significant(0.002), by != 0) << by;
      std::printf("  %+.2f s: off by %+.4f s, sigma %.4f s, contrast %.2f\n", by, r.value - by, r.sigma, r.contrast);
      squares += std::pow((r.value - by) / r.sigma, 2);
      ++n;
    }
    std::printf("grade %d: error/sigma %.2f\n", static_cast<int>(grade), std::sqrt(squares / n));
    // Eight answers: an rms of 1 within 0.45 and 1.6; the lever arm's and the least sigma are not in the errors.
    EXPECT_LT(std::sqrt(squares / n), 1.6);
    EXPECT_GT(std::sqrt(squares / n), 0.25);
  }
}

TEST(ClockOffset, IsFoundInADrive) {
  for (const double by : {-0.7, 0.0, 0.05, 0.3, 1.0}) {
    const TimeOffset r = found(figure_of_eight(), ImuGrade::mems, 7, by);
    ASSERT_TRUE(r.determinable) << by << ": " << r.reason;
    EXPECT_NEAR(r.value, by, goal);
    EXPECT_NEAR(r.value, by, 4 * r.sigma);
  }
}

/// A slow craft turns far within one second difference, and its accelerometers' biases with it.
TEST(ClockOffset, OfSlowCraftHasATrueSigma) {
  constexpr std::int64_t seeds = 24;
  constexpr double shortest = 20e-3;  // s: what must be found
  for (const double speed : {6.0, 12.0}) {
    std::vector<test::Course> courses;
    for (std::int64_t seed = 1; seed <= seeds; ++seed) {
      const simulate::PlannedFlight flight = test::craft_flight(speed, seed);
      const double until = std::min(240.0, flight.duration());
      courses.emplace_back(test::motion_of(flight), 0, until);
    }
    for (const ImuGrade grade : {ImuGrade::tactical, ImuGrade::mems, ImuGrade::consumer}) {
      double squares = 0, with_offset = 0, n = 0;
      for (std::int64_t seed = 1; seed <= seeds; ++seed) {
        const double by = seed % 2 == 0 ? shortest * static_cast<double>(seed) / 2 : 0.0;
        const test::Course& course = courses[static_cast<size_t>(seed - 1)];
        const core::ImuErrorModel spec = core::error_model_of(grade);
        const core::GnssData exact = test::keep_fixes(course.exact.gnss, [](size_t k) { return k % 5 == 0; });  // once a second
        const core::ImuData imu = late(test::with_errors(course.exact.imu, spec, static_cast<std::uint64_t>(seed)), by);
        const core::GnssData gnss = test::with_errors(exact, {}, static_cast<std::uint64_t>(seed));
        const TimeOffset r = imu_clock_offset(make_path(imu, 10), gnss, spec, course.sensors.lever, 0.0, 2);
        if (!r.determinable) continue;
        const double z = (r.value - by) / r.sigma;
        squares += z * z, ++n;
        with_offset += by > 0 && r.is_significant(0.002);
        EXPECT_TRUE(by > 0 || !r.is_significant(0.002)) << speed << " m/s, seed " << seed << ": " << r.value << " sigma " << r.sigma;
      }
      const double rms = std::sqrt(squares / n);
      std::printf("%g m/s, grade %d: error/sigma %.2f, %g of %d offsets found\n", speed, static_cast<int>(grade), rms, with_offset,
                  static_cast<int>(seeds / 2));
      EXPECT_GE(n, seeds - 4.0);
      EXPECT_GT(rms, 0.6);  // of 24: 1 within 0.15
      EXPECT_LT(rms, 1.4);
      EXPECT_GE(with_offset, seeds / 2 - (grade == ImuGrade::consumer ? 4.0 : 1.0));  // the shortest, 20 ms, is 4 sigma at 6 m/s
    }
  }
}

TEST(ClockOffset, IsNotDeterminableWithoutChangesOfMotion) {
  const TimeOffset straight = found(straight_line(), ImuGrade::mems, 3, 0.3);
  // Turbulence is all that there is: either it suffices, or it is said that it does not.
  if (straight.determinable) {
    EXPECT_NEAR(straight.value, 0.3, 4 * straight.sigma);
  }

  const test::Course standing(test::Drive({{0, 0}}), 0, 120);
  const TimeOffset still = found(standing, ImuGrade::mems, 3, 0.3);
  EXPECT_FALSE(still.determinable);
  EXPECT_NE(still.reason, "");
  EXPECT_EQ(still.sigma, 0.0);
  EXPECT_FALSE(still.is_significant(0.0));
}

TEST(ClockOffset, BeyondTheSearchIsNotNamed) {
  const TimeOffset r = found(lines_and_turns(), ImuGrade::tactical, 1, 1.0, 0.4);
  EXPECT_FALSE(r.determinable) << r.value;
  const TimeOffset wide = found(lines_and_turns(), ImuGrade::tactical, 1, 8.0, 10.0);
  ASSERT_TRUE(wide.determinable) << wide.reason;
  EXPECT_NEAR(wide.value, 8.0, goal);
}

TEST(ClockOffset, FixesFarApartOrTooFewShowNone) {
  const test::Course& c = lines_and_turns();
  const core::ImuErrorModel spec = core::error_model_of(ImuGrade::tactical);
  const core::GnssData rare = test::keep_fixes(c.exact.gnss, [](size_t k) { return k % 25 == 0; });
  EXPECT_NE(imu_clock_offset(make_path(c.exact.imu, 10), rare, spec, c.sensors.lever, 0.02, 2).reason.find("3 s apart"), std::string::npos);
  const core::GnssData few = test::keep_fixes(c.exact.gnss, [](size_t k) { return k < 20; });
  EXPECT_FALSE(imu_clock_offset(make_path(c.exact.imu, 10), few, spec, c.sensors.lever, 0.02, 2).determinable);
  const core::GnssData slow = test::keep_fixes(c.exact.gnss, [](size_t k) { return k % 5 == 0; });
  const TimeOffset once_a_second = imu_clock_offset(make_path(late(c.exact.imu, 0.2), 10), slow, spec, c.sensors.lever, 0.02, 2);
  ASSERT_TRUE(once_a_second.determinable) << once_a_second.reason;
  EXPECT_NEAR(once_a_second.value, 0.2, goal);
}

/// Velocities of a record that are those of `by` seconds before.
void delay_velocities(core::GnssData& g, const test::Course& course, double by) {
  for (size_t k = 0; k < g.size(); ++k) {
    const double t = g.time[k] - test::motion_start - by;
    const test::Truth now = test::truth_at(course.motion, t + by), then = test::truth_at(course.motion, t);
    g.velocity[k] += then.velocity - now.velocity;
  }
}

TEST(VelocityLag, OfAReceiverIsFound) {
  test::FixErrors errors;
  errors.velocity = true;
  for (const double by : {0.0, 0.05, 0.13, 0.4}) {
    core::GnssData g = test::with_errors(lines_and_turns().exact.gnss, errors, 5);
    delay_velocities(g, lines_and_turns(), by);
    const TimeOffset r = velocity_lag(g);
    ASSERT_TRUE(r.determinable) << r.reason;
    EXPECT_NEAR(r.value, by, goal) << by;
    EXPECT_EQ(r.is_significant(0.02), by > 0) << by;
  }
  EXPECT_FALSE(velocity_lag(test::with_errors(lines_and_turns().exact.gnss, {}, 5)).determinable);  // without velocities
}

TEST(ClockFindings, NameTheValueToState) {
  ClockFindings f;
  f.imu = {true, "", 0.56, 0.003, 100, 0.5, {0, 0, 0}};
  f.stated = {-0.125, 0.0};
  EXPECT_NE(f.advice().find("0.560 s apart"), std::string::npos) << f.advice();
  EXPECT_NE(f.advice().find("offset = \"-0.685 s\" in the time of [[imu]]"), std::string::npos) << f.advice();
  EXPECT_NE(f.advice().find("antenna.latency = \"0.560 s\""), std::string::npos) << f.advice();
  EXPECT_TRUE(f.apart());
  EXPECT_NEAR(core::reported(f).find("imu_ahead_of_gnss")->find("imu_time_offset_to_state_s")->as_number(), -0.685, 1e-12);
  f.stated = {};
  EXPECT_NE(f.advice().find("by \"-0.560 s\""), std::string::npos) << f.advice();
}

TEST(ClockOffset, NamedByTheSmootherAndInItsRefusal) {
  Trial run = trial_of(ImuGrade::tactical, 4);
  run.change_imu = [](core::ImuData& imu) { imu = late(imu, 0.56); };
  std::string said;
  try {
    said = test::warning_with(run.on(lines_and_turns()), "clocks of IMU and GNSS");
  } catch (const core::Error& e) {
    said = e.text();
  }
  std::printf("%s\n", said.c_str());
  EXPECT_NE(said.find("clocks of IMU and GNSS are 0.5"), std::string::npos) << said;
  run.change_imu = nullptr;
  EXPECT_EQ(test::warning_with(run.on(lines_and_turns()), "clocks"), "");
}

TEST(ClockOffset, LeapSecondsAreNamed) {
  const test::Course& course = lines_and_turns();
  for (const ImuGrade grade : {ImuGrade::navigation, ImuGrade::tactical}) {
    const core::ImuErrorModel spec = core::error_model_of(grade);
    constexpr double since_1980 = 1.4e9;  // s: a day with leap seconds
    const core::ImuData imu = late(test::with_errors(course.exact.imu, spec, 3), since_1980);
    core::GnssData gnss = test::with_errors(course.exact.gnss, {}, 3);
    for (double& time : gnss.time) time += since_1980;
    const double leap = core::gps_minus_utc_at_gps(gnss.time.front());
    const auto named = [&](double imu_late, double gnss_late) {
      core::GnssData moved = gnss;
      for (double& t : moved.time) t += gnss_late;
      return leap_seconds_between(make_path(late(imu, imu_late), 10), moved, spec, course.sensors.lever, 0.02);
    };
    EXPECT_NE(named(0, -leap).find("GNSS records UTC"), std::string::npos) << named(0, -leap);
    EXPECT_NE(named(-leap, 0).find("IMU records UTC"), std::string::npos) << named(-leap, 0);
    EXPECT_EQ(named(0, 0), "");
    EXPECT_EQ(named(0, 5.0), "");
  }
}

TEST(VelocityLag, LeavesTheVelocitiesOutAndSaysSo) {
  Trial run = trial_of(ImuGrade::mems, 4);
  run.fixes.velocity = true;
  EXPECT_EQ(test::warning_with(run.on(lines_and_turns()), "velocities"), "");
  run.change_gnss = [](core::GnssData& g) { delay_velocities(g, lines_and_turns(), 0.2); };
  const InsGnssResult r = run.on(lines_and_turns());
  EXPECT_NE(test::warning_with(r, "velocities are 0.2"), "") << "not named";
  test::Statistics s;
  s.add(r, lines_and_turns());
  s.print("velocities 0.2 s late");
  EXPECT_LT(s.by_sigma().maxCoeff(), 2.0);  // as without velocities
}

/// The car's set-up as tests/io has it, without an offset of its clock.
TEST(ClockOffset, IsFoundInARealDrive) {
  SWATH_SHARED_OR_SKIP(folder, "data/car_imu_rtk/drive_0708");
  io::Survey s;
  s.folder = folder;
  io::ImuFile& f = s.imu.emplace_back();
  f.file = "imu_1934.csv";
  f.time = {core::TimeScale::device, {}, ""};
  f.time.unit = core::Seconds(0.001);
  f.time.origin = "2025-07-08T19:34:21.985 GPS";
  f.time.origin_at = 261906;
  f.kind = io::ImuKind::rates;
  f.angle_unit = io::AngleUnit::deg;
  f.acceleration_unit = io::AccelerationUnit::g;
  f.axes = {"-x", "y", "-z"};
  f.roll = core::degrees(-0.636);
  f.pitch = core::degrees(-6.760);
  f.heading = core::degrees(5.388);
  f.columns = {"7", "", "4", "5", "6", "1", "2", "3"};
  s.gnss.emplace_back().file = "gnss_1934_sf.pos";
  core::Tally tally;
  const core::ImuData imu = io::read_imu(s, tally);
  const core::GnssData gnss = io::read_gnss(s, tally);
  const Eigen::Vector3d lever(0, -0.05, 0);
  const core::ImuErrorModel spec = core::error_model_of(ImuGrade::consumer);
  const TimeOffset own = imu_clock_offset(make_path(imu, 10), gnss, spec, lever, 0.05, 2);
  std::printf("the drive's own offset %.4f s, sigma %.4f s\n", own.value, own.sigma);
  ASSERT_TRUE(own.determinable) << own.reason;
  EXPECT_NEAR(own.value, 0.25, 0.02);  // turn rates against those of the positions: 0.245 to 0.255
  EXPECT_LT(own.sigma, goal);
  for (const double by : {-0.6, 0.05, 0.56, 1.0}) {
    const TimeOffset r = imu_clock_offset(make_path(late(imu, by), 10), gnss, spec, lever, 0.05, 2);
    ASSERT_TRUE(r.determinable) << by << ": " << r.reason;
    EXPECT_NEAR(r.value - own.value, by, goal);
  }
  const TimeOffset lag = velocity_lag(gnss);
  std::printf("its velocities %.4f s late, sigma %.4f s\n", lag.value, lag.sigma);
  ASSERT_TRUE(lag.determinable) << lag.reason;
  EXPECT_NEAR(lag.value, 0.13, 0.02);
}

}  // namespace
}  // namespace swath::trajectory
