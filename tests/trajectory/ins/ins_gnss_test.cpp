// SPDX-License-Identifier: GPL-3.0-or-later
#include "trajectory/ins/ins_gnss.h"

#include "core/records/gnss_columns.h"
#include "tests/trajectory/ins_run.h"

namespace swath::trajectory {
namespace {

using core::ImuGrade;
using Eigen::Vector3d;
using test::lines_and_turns;
using test::Statistics;
using test::Trial;
using test::trial_of;

constexpr double arcsec = core::degree / 3600;
constexpr int seeds = 6;

struct Expected {
  ImuGrade grade;
  const char* name;
  double horizontal, vertical, roll_pitch, heading;  // m, arcsec: rms
};

TEST(InsGnss, ErrorsAreSmallAndWhatTheSigmasSay) {
  // 240 s hold the correlated part of the fixes (1.6 and 2.8 cm, 120 s) whole: the positions cannot be better than that.
  const Expected all[] = {{ImuGrade::navigation, "navigation", 0.03, 0.05, 4, 8},
                          {ImuGrade::tactical, "tactical", 0.03, 0.05, 12, 20},
                          {ImuGrade::mems, "mems", 0.04, 0.05, 150, 200}};
  for (const Expected& x : all) {
    Statistics s;
    double nis = 0;
    for (int seed = 1; seed <= seeds; ++seed) {
      const InsGnssResult r = trial_of(x.grade, static_cast<std::uint64_t>(seed)).on(lines_and_turns());
      EXPECT_EQ(r.trajectory.size(), 24000u);
      s.add(r, lines_and_turns());
      nis += test::number(r, "innovations", "mean_nis") / seeds;
    }
    s.print(x.name);
    const test::Error6 rms = s.rms(), by_sigma = s.by_sigma();
    EXPECT_LT(rms.head<2>().maxCoeff(), x.horizontal) << x.name;
    EXPECT_LT(rms[2], x.vertical) << x.name;
    EXPECT_LT(rms.segment<2>(3).maxCoeff(), x.roll_pitch * arcsec) << x.name;
    EXPECT_LT(rms[5], x.heading * arcsec) << x.name;
    // Some ten independent values each: an rms of 1 within 0.5 and 1.7. White fixes in place of correlated ones would show 3 to 8.
    EXPECT_GT(by_sigma.minCoeff(), 0.5) << x.name;
    EXPECT_LT(by_sigma.maxCoeff(), 1.7) << x.name;
    EXPECT_GT(s.nees / s.count / 6, 0.5) << x.name;
    EXPECT_LT(s.nees / s.count / 6, 1.7) << x.name;
    // 7200 fixes: sigma of the mean sqrt(6 / 7200) = 0.03.
    EXPECT_NEAR(nis, 3.0, 0.12) << x.name;
  }
}

TEST(InsGnss, FixesTakenAsWhiteMakeSigmasTooSmall) {
  Statistics white, correlated;
  for (int seed = 1; seed <= 3; ++seed) {
    Trial run = trial_of(ImuGrade::tactical, static_cast<std::uint64_t>(seed));
    correlated.add(run.on(lines_and_turns()), lines_and_turns());
    run.options.correlated_share = 0;
    white.add(run.on(lines_and_turns()), lines_and_turns());
  }
  white.print("taken as white");
  EXPECT_GT(white.by_sigma().head<3>().cwiseQuotient(correlated.by_sigma().head<3>()).minCoeff(), 1.8);
}

TEST(InsGnss, AnOutageIsBridgedWithATrueSigma) {
  for (const ImuGrade grade : {ImuGrade::tactical, ImuGrade::mems}) {
    Statistics in, all;
    for (int seed = 1; seed <= seeds; ++seed) {
      Trial run = trial_of(grade, static_cast<std::uint64_t>(seed));
      run.change_gnss = [](core::GnssData& g) { g = test::without(g, 110, 130); };
      const InsGnssResult r = run.on(lines_and_turns());
      in.add(r, lines_and_turns(), 110, 130);
      all.add(r, lines_and_turns());
      ASSERT_EQ(r.report.figures.outages.size(), 1u);
      EXPECT_NEAR(r.report.figures.outages[0].length, 20.2, 0.01);
      // The correlated part of the fixes governs both: a tactical IMU carries 20 s with hardly any loss.
      const float least = grade == ImuGrade::mems ? 1.02f : 0.99f;
      EXPECT_GT(r.trajectory.sigma_north[12000], least * r.trajectory.sigma_north[9000]);
      EXPECT_TRUE(r.report.warnings.empty());
    }
    in.print("outage of 20 s");
    EXPECT_LT(in.rms().head<3>().maxCoeff(), grade == ImuGrade::tactical ? 0.05 : 0.12);
    EXPECT_LT(in.by_sigma().maxCoeff(), 2.0);
    EXPECT_GT(in.by_sigma().minCoeff(), 0.3);
    EXPECT_LT(all.by_sigma().maxCoeff(), 1.7);
  }
}

TEST(InsGnss, BeginsAndEndsInTheMiddleOfAnOutage) {
  Statistics first, last, middle;
  for (int seed = 1; seed <= seeds; ++seed) {
    Trial run = trial_of(ImuGrade::tactical, static_cast<std::uint64_t>(seed));
    run.change_gnss = [](core::GnssData& g) { g = test::without(test::without(g, -1, 20), 220, 300); };
    const InsGnssResult r = run.on(lines_and_turns());
    // The trajectory is there all the same, and says how well it is known.
    EXPECT_NEAR(r.trajectory.time.front(), test::motion_start, 0.02);
    EXPECT_NEAR(r.trajectory.time.back(), test::motion_start + 240, 0.02);
    first.add(r, lines_and_turns(), 0, 20);
    last.add(r, lines_and_turns(), 220, 240);
    middle.add(r, lines_and_turns(), 20, 220);
    EXPECT_GT(r.trajectory.sigma_north.front(), 1.3f * r.trajectory.sigma_north[10000]);
    EXPECT_EQ(r.report.figures.outages.size(), 2u);
  }
  first.print("before the first fix");
  last.print("after the last fix");
  EXPECT_LT(first.rms().head<3>().maxCoeff(), 0.25);
  EXPECT_LT(last.rms().head<3>().maxCoeff(), 0.25);
  for (const Statistics& s : {first, last, middle}) EXPECT_LT(s.by_sigma().maxCoeff(), 2.0);
}

TEST(InsGnss, OutliersAreDownWeightedAndCounted) {
  Statistics clean, dirty;
  for (int seed = 1; seed <= 3; ++seed) {
    Trial run = trial_of(ImuGrade::tactical, static_cast<std::uint64_t>(seed));
    clean.add(run.on(lines_and_turns()), lines_and_turns());
    run.fixes.outliers = 0.02;
    const core::GnssData gnss = test::with_errors(lines_and_turns().exact.gnss, run.fixes, run.seed);
    const InsGnssResult r = run.on(lines_and_turns());
    dirty.add(r, lines_and_turns());
    size_t stray = 0, caught = 0, wrongly = 0;
    ASSERT_EQ(r.series.weight.size(), gnss.size());
    for (size_t k = 0; k < gnss.size(); ++k) {
      const bool is = (gnss.position[k] - lines_and_turns().exact.gnss.position[k]).norm() > 0.5;
      stray += is;
      caught += is && r.series.weight[k] < 0.2;
      wrongly += !is && r.series.weight[k] < 1.0;
    }
    EXPECT_GT(stray, 10u);
    EXPECT_EQ(caught, stray);
    EXPECT_LE(wrongly, 4u);
    EXPECT_EQ(r.report.figures.fixes.down_weighted, stray + wrongly);
  }
  clean.print("clean");
  dirty.print("2 % of 1 m");
  EXPECT_LT(dirty.rms().head<3>().maxCoeff(), 1.25 * clean.rms().head<3>().maxCoeff());
  EXPECT_LT(dirty.by_sigma().maxCoeff(), 1.8);
}

TEST(InsGnss, TheLatencyOfTheFixesIsFound) {
  Statistics s;
  for (int seed = 1; seed <= 3; ++seed) {
    Trial run = trial_of(ImuGrade::tactical, static_cast<std::uint64_t>(seed));
    run.options.gnss_latency = true;
    run.change_gnss = [](core::GnssData& g) {
      for (double& t : g.time) t -= 0.005;  // they were taken 5 ms later than they say
    };
    const InsGnssResult r = run.on(lines_and_turns());
    const auto [value, sigma] = r.report.figures.estimates.latency.value();
    std::printf("latency %.3f ms, sigma %.3f ms\n", value * 1e3, sigma * 1e3);
    EXPECT_NEAR(value, 0.005, 3 * sigma);
    EXPECT_LT(sigma, 0.0005);
    s.add(r, lines_and_turns());
  }
  s.print("latency");
  EXPECT_LT(s.by_sigma().maxCoeff(), 2.0);
}

TEST(InsGnss, AlignmentAsItIsTold) {
  Trial run;
  const InsGnssResult moving = run.on(lines_and_turns());
  EXPECT_EQ(moving.report.figures.alignment.method, "moving");
  run.options.alignment = AlignmentMethod::given;
  const simulate::Pose pose = lines_and_turns().motion(0).pose;
  run.options.given.roll = core::Radians(pose.attitude.roll + 0.01);
  run.options.given.pitch = core::Radians(pose.attitude.pitch - 0.01);
  run.options.given.heading = core::Radians(pose.attitude.heading + 0.06);
  const InsGnssResult given = run.on(lines_and_turns());
  EXPECT_EQ(given.report.figures.alignment.method, "given");
  // Repeated about its own trajectory the smoother forgets where it began.
  for (size_t k = 0; k < given.trajectory.size(); k += 1000) {
    EXPECT_NEAR(given.trajectory.heading[k], moving.trajectory.heading[k], 2 * arcsec) << k;
    EXPECT_NEAR(given.trajectory.height[k], moving.trajectory.height[k], 0.002) << k;
  }
  run.options.alignment = AlignmentMethod::still;
  EXPECT_NE(test::error_of_run(run, lines_and_turns()).find("no standstill"), std::string::npos);
}

TEST(InsGnss, StandstillGivesTheHeadingOfANavigationGrade) {
  const test::Course drive(test::Drive({{60, 1}, {110, 0}}), 0, 130);
  Trial run = trial_of(ImuGrade::navigation);
  const InsGnssResult r = run.on(drive);
  EXPECT_EQ(r.report.figures.alignment.method, "still");
  EXPECT_NEAR(r.report.figures.standstill, 74, 5);
  Statistics s;
  s.add(r, drive);
  s.print("drive");
  EXPECT_LT(s.by_sigma().maxCoeff(), 2.5);
  // With poor fixes and sensors the velocity at rest is known by the standstill.
  run = trial_of(ImuGrade::mems);
  run.fixes.horizontal = run.fixes.vertical = 0.5;
  const auto velocity_sigma = [](const InsGnssResult& x) { return std::sqrt(x.trajectory.covariance.at(test::motion_start + 125)(3, 3)); };
  const double with = velocity_sigma(run.on(drive));
  run.options.zero_velocity = false;
  EXPECT_LT(with, 0.3 * velocity_sigma(run.on(drive)));
}

TEST(InsGnss, ScaleFactorsCount) {
  Statistics with, without;
  for (int seed = 1; seed <= 4; ++seed) {
    Trial run = trial_of(ImuGrade::mems, static_cast<std::uint64_t>(seed));
    with.add(run.on(lines_and_turns()), lines_and_turns());
    run.options.scale_factors = false;
    without.add(run.on(lines_and_turns()), lines_and_turns());
  }
  with.print("with scale factors");
  without.print("without");
  EXPECT_GT(without.rms()[5], 1.5 * with.rms()[5]);
  EXPECT_GT(without.by_sigma().maxCoeff(), 3.0);
}

TEST(InsGnss, VelocitiesAreUsedWhenGiven) {
  Statistics with, without;
  for (int seed = 1; seed <= 3; ++seed) {
    Trial run = trial_of(ImuGrade::mems, static_cast<std::uint64_t>(seed));
    run.fixes = {.horizontal = 1.0, .vertical = 2.0, .speed = 0.02, .velocity = true};
    with.add(run.on(lines_and_turns()), lines_and_turns());
    run.options.use_velocity = false;
    without.add(run.on(lines_and_turns()), lines_and_turns());
  }
  with.print("with velocities");
  without.print("without");
  EXPECT_LT(1.5 * with.rms()[5], without.rms()[5]);
  EXPECT_LT(with.by_sigma().maxCoeff(), 2.0);
}

TEST(InsGnss, WheelsHoldACarThroughAnOutage) {
  // The last 30 s without a fix: nothing behind it holds the drift.
  const test::Course drive(test::Drive({{20, 1}, {70, 0.5}, {90, 1.2}}, 0.02, -0.01), 0, 160);
  Statistics with, without;
  for (int seed = 1; seed <= 3; ++seed) {
    Trial run = trial_of(ImuGrade::consumer, static_cast<std::uint64_t>(seed));
    run.change_gnss = [](core::GnssData& g) { g = test::without(g, 130, 170); };
    without.add(run.on(drive), drive, 130, 160);
    run.options.non_holonomic = true;
    run.options.non_holonomic_sigma = core::MetresPerSecond(0.05);
    const InsGnssResult r = run.on(drive);
    with.add(r, drive, 130, 160);
    const VehicleAxis axis = r.report.figures.estimates.axis.value();
    EXPECT_NEAR(axis.azimuth, 0.02, 0.2 * core::degree);
    EXPECT_NEAR(axis.elevation, -0.01, 0.2 * core::degree);
  }
  with.print("with wheels");
  without.print("without");
  EXPECT_LT(with.rms().head<3>().norm(), 0.6 * without.rms().head<3>().norm());
  EXPECT_LT(with.by_sigma().maxCoeff(), 2.5);
}

TEST(InsGnss, AGapOfTheImuIsBridged) {
  Statistics s;
  for (const double gap : {0.01, 0.5, 5.0}) {
    Trial run;
    const auto missing = static_cast<long>(std::lround(gap / 0.01));
    run.change_imu = [&](core::ImuData& imu) {
      const auto erase = [&](auto& v) { v.erase(v.begin() + 9000, v.begin() + 9000 + missing); };
      erase(imu.time), erase(imu.step), erase(imu.angle), erase(imu.velocity);
    };
    const InsGnssResult r = run.on(lines_and_turns());
    EXPECT_EQ(r.trajectory.size(), 24000u - static_cast<size_t>(missing));
    Statistics one;
    one.add(r, lines_and_turns());
    one.print(("gap of " + std::to_string(gap) + " s").c_str());
    EXPECT_LT(one.by_sigma().maxCoeff(), 2.2) << gap;
    EXPECT_LT(one.rms()[5], (gap > 1 ? 60 : 25) * arcsec) << gap;
    // A record that is missing costs next to nothing.
    if (gap == 0.01) {
      EXPECT_LT(r.trajectory.sigma_heading[12000], 20 * arcsec);
    }
  }
}

TEST(InsGnss, OutputRateDecimates) {
  Trial run;
  run.options.output_rate = core::Hertz(10);
  EXPECT_EQ(run.on(lines_and_turns()).trajectory.size(), 2400u);
}

TEST(InsGnss, InstantsFartherApartAreFewerAndMoveNothing) {
  // Fixes at 1 Hz: three instants between each two of them, or one.
  Trial run = trial_of(ImuGrade::tactical, 2);
  run.change_gnss = [](core::GnssData& g) {
    core::for_each_gnss_column([&](auto member) {
      auto& column = g.*member;
      for (size_t k = 0; 5 * k < column.size(); ++k) column[k] = column[5 * k];
      column.resize((column.size() + 4) / 5);
    });
  };
  run.options.error_spacing.value = 0.0;
  const InsGnssResult near = run.on(lines_and_turns());
  run.options.node_spacing.value = 0.5;
  const InsGnssResult far = run.on(lines_and_turns());
  EXPECT_EQ(near.trajectory.covariance.time.size(), 2 * far.trajectory.covariance.time.size() - 1);
  ASSERT_EQ(near.trajectory.size(), far.trajectory.size());
  for (size_t k = 0; k < near.trajectory.size(); ++k) {
    EXPECT_NEAR(near.trajectory.height[k], far.trajectory.height[k], 1e-3);  // sigma 2 cm
    EXPECT_NEAR(near.trajectory.roll[k], far.trajectory.roll[k], 1 * arcsec);
  }
}

TEST(InsGnss, SameRecordsSameBits) {
  const InsGnssResult a = Trial().on(lines_and_turns()), b = Trial().on(lines_and_turns());
  EXPECT_EQ(a.trajectory.latitude, b.trajectory.latitude);
  EXPECT_EQ(a.trajectory.heading, b.trajectory.heading);
  EXPECT_EQ(a.trajectory.covariance.upper, b.trajectory.covariance.upper);
}

// Wrong input: one clear error with numbers and a hint.

void expect_error(const Trial& run, const std::vector<std::string>& parts, const test::Course& course = lines_and_turns()) {
  const std::string text = test::error_of_run(run, course);
  EXPECT_FALSE(text.empty()) << "no error with " << parts.front();
  for (const std::string& p : parts) EXPECT_NE(text.find(p), std::string::npos) << p << " is not in: " << text;
}

TEST(InsGnss, SwappedAxes) {
  Trial run;
  run.change_imu = [](core::ImuData& imu) {
    for (size_t k = 0; k < imu.size(); ++k) {
      imu.angle[k] = Vector3d(imu.angle[k].z(), imu.angle[k].y(), imu.angle[k].x());
      imu.velocity[k] = Vector3d(imu.velocity[k].z(), imu.velocity[k].y(), imu.velocity[k].x());
    }
  };
  expect_error(run, {"gravity lies along (-10.", "(0, 0, -9.8)", "hint", "imu.axes"});
  // Upside down.
  run.change_imu = [](core::ImuData& imu) {
    for (Vector3d& v : imu.velocity) v = -v;
  };
  expect_error(run, {"gravity lies along", "9.", "imu.axes"});
}

TEST(InsGnss, WrongUnits) {
  Trial run;
  run.change_imu = [](core::ImuData& imu) {
    for (Vector3d& a : imu.angle) a /= core::degree;
  };
  expect_error(run, {"rad/s", "degrees", "imu.angle_unit"});
  run.change_imu = [](core::ImuData& imu) {
    for (Vector3d& v : imu.velocity) v /= 9.80665;
  };
  expect_error(run, {"1.0", "m/s2, which is not gravity", "imu.acceleration_unit"});
}

TEST(InsGnss, NoOverlap) {
  Trial run;
  run.change_gnss = [](core::GnssData& g) {
    for (double& t : g.time) t -= 18 + 604800;
  };
  expect_error(run, {"do not overlap", "IMU from 1401", "fixes from 1400", "hint", "1 week apart"});
}

TEST(InsGnss, TooFewRecords) {
  Trial run;
  run.change_gnss = [](core::GnssData& g) { g = test::keep_fixes(g, [](size_t k) { return k < 3; }); };
  expect_error(run, {"too few fixes: 3"});
  run.change_gnss = nullptr;
  run.change_imu = [](core::ImuData& imu) { imu.time.resize(5), imu.step.resize(5), imu.angle.resize(5), imu.velocity.resize(5); };
  expect_error(run, {"too few IMU records: 5"});
}

TEST(InsGnss, NotANumber) {
  Trial run;
  run.change_imu = [](core::ImuData& imu) { imu.angle[100].y() = std::nan(""); };
  expect_error(run, {"IMU record 101", "not finite", "hint"});
  run.change_imu = nullptr;
  run.change_gnss = [](core::GnssData& g) { g.position[7].x() = std::nan(""); };
  expect_error(run, {"fix 8", "not finite", "hint"});
  run.change_gnss = [](core::GnssData& g) { g.covariance[9](1, 1) = std::nan(""); };
  expect_error(run, {"fix 10", "not finite"});
}

TEST(InsGnss, AllFixesContradict) {
  Trial run;
  // The fixes of another flight: thrown about by hundreds of metres.
  run.change_gnss = [](core::GnssData& g) {
    test::Dice dice(8);
    for (Vector3d& p : g.position) p += 200 * dice.vector();
  };
  expect_error(run, {" of 1201 fixes contradict the IMU", "hint", "lever arm"});
}

TEST(InsGnss, AGapLongerThanMaxGap) {
  Trial run;
  run.options.max_gap = core::Seconds(2);
  run.change_imu = [](core::ImuData& imu) {
    const auto erase = [&](auto& v) { v.erase(v.begin() + 9000, v.begin() + 9300); };
    erase(imu.time), erase(imu.step), erase(imu.angle), erase(imu.velocity);
  };
  expect_error(run, {"gap of 3 s, longer than 2 s", "record 9001", "max_gap"});
}

}  // namespace
}  // namespace swath::trajectory
