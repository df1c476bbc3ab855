// SPDX-License-Identifier: GPL-3.0-or-later
#include "trajectory/ins/ins_report.h"

#include "tests/trajectory/ins_run.h"

namespace swath::trajectory {
namespace {

using core::ImuGrade;
using Eigen::Vector3d;
using test::lines_and_turns;
using test::Trial;
using test::trial_of;
using test::warning_with;

/// The warning, or the error, that a wrong statement leads to.
std::string outcry(const Trial& run, const test::Course& course, const std::string& part) {
  try {
    const InsGnssResult r = run.on(course);
    for (const std::string& w : r.report.warnings) std::printf("  %s\n", w.c_str());
    for (const NamedFault& n : r.report.figures.named) std::printf("  %s\n", n.sentence.c_str());
    return warning_with(r, part);
  } catch (const core::Error& e) {
    std::printf("  error: %s\n", e.text().c_str());
    return e.text();
  }
}

TEST(InsReport, ACleanFlightRaisesNoAlarm) {
  for (const ImuGrade grade : {ImuGrade::navigation, ImuGrade::tactical, ImuGrade::mems})
    for (std::uint64_t seed = 11; seed <= 20; ++seed) {
      const InsReport report = trial_of(grade, seed).on(lines_and_turns()).report;
      for (const std::string& w : report.warnings) ADD_FAILURE() << "seed " << seed << ", grade " << static_cast<int>(grade) << ": " << w;
      for (const NamedFault& n : report.figures.named) ADD_FAILURE() << "seed " << seed << ": " << n.sentence;
    }
}

TEST(InsReport, ClocksAndLeverArmThatContradictHaveACode) {
  Trial run;
  EXPECT_TRUE(run.on(lines_and_turns()).report.figures.named.empty());
  run.lever_off = Vector3d(0.1, 0, 0);
  const std::vector<NamedFault> arm = run.on(lines_and_turns()).report.figures.named;
  ASSERT_EQ(arm.size(), 1u);
  EXPECT_EQ(arm[0].code, "trajectory.lever_arm");
  EXPECT_NE(arm[0].sentence.find("lever arm forward"), std::string::npos) << arm[0].sentence;
  run.lever_off.setZero();
  run.change_gnss = [](core::GnssData& g) {
    for (double& t : g.time) t += 0.05;
  };
  const std::vector<NamedFault> clocks = run.on(lines_and_turns()).report.figures.named;
  ASSERT_FALSE(clocks.empty());
  EXPECT_EQ(clocks[0].code, "trajectory.clocks");
  EXPECT_NE(clocks[0].sentence.find("antenna.latency"), std::string::npos) << clocks[0].sentence;
}

TEST(InsReport, AnImuWorseThanStated) {
  for (std::uint64_t seed = 1; seed <= 3; ++seed) {
    Trial run = trial_of(ImuGrade::mems, seed);
    run.stated = core::error_model_of(ImuGrade::tactical);
    EXPECT_NE(outcry(run, lines_and_turns(), "stated"), "") << seed;
    run = trial_of(ImuGrade::tactical, seed);
    run.stated = core::error_model_of(ImuGrade::navigation);
    EXPECT_NE(outcry(run, lines_and_turns(), "stated"), "") << seed;
  }
}

TEST(InsReport, AnImuBetterThanStated) {
  for (std::uint64_t seed = 1; seed <= 3; ++seed) {
    Trial run = trial_of(ImuGrade::tactical, seed);
    run.stated = core::error_model_of(ImuGrade::mems);
    EXPECT_NE(outcry(run, lines_and_turns(), "the IMU is better than stated"), "") << seed;
  }
}

TEST(InsReport, ALeverArmTenCentimetresOff) {
  const char* const axes[] = {"forward", "right", "down"};
  for (int axis = 0; axis < 3; ++axis)
    for (std::uint64_t seed = 1; seed <= 2; ++seed) {
      Trial run = trial_of(ImuGrade::tactical, seed);
      run.lever_off = 0.1 * Vector3d::Unit(axis);
      const std::string w = outcry(run, lines_and_turns(), std::string("lever arm ") + axes[axis]);
      EXPECT_NE(w, "") << axes[axis] << " " << seed;
      EXPECT_NE(w.find("stated as"), std::string::npos);
    }
}

TEST(InsReport, ALeverArmWithTheWrongSign) {
  Trial run;
  run.lever_off = -2 * lines_and_turns().sensors.lever;
  EXPECT_NE(outcry(run, lines_and_turns(), "lever arm"), "");
}

TEST(InsReport, FixesThatContradict) {
  Trial run;
  run.fixes.outliers = 0.05;
  const std::string w = outcry(run, lines_and_turns(), "fixes contradict the trajectory");
  EXPECT_NE(w.find("of 1201"), std::string::npos) << w;
  run.fixes.outliers = 0.01;
  EXPECT_EQ(outcry(run, lines_and_turns(), "fixes contradict"), "");
}

TEST(InsReport, InnovationsThatDoNotFit) {
  // Fixes three times as good, and half as bad, as they say, where their noise is not to be estimated.
  for (const double factor : {9.0, 0.35}) {
    Trial run;
    run.options.correlated_share = 0.4;
    run.change_gnss = [=](core::GnssData& g) {
      for (auto& c : g.covariance) c *= factor;
    };
    const std::string w = outcry(run, lines_and_turns(), "the innovations are");
    EXPECT_NE(w.find(factor > 1 ? "better than stated" : "worse than stated"), std::string::npos) << factor << w;
  }
}

TEST(InsReport, FixesThatScatterMoreThanStated) {
  Trial run;
  run.change_gnss = [](core::GnssData& g) {
    for (auto& c : g.covariance) c *= 0.25;
  };
  EXPECT_NE(outcry(run, lines_and_turns(), "times more than stated"), "");
  const InsGnssResult r = run.on(lines_and_turns());
  EXPECT_NEAR(r.report.figures.fixes.variance_factor, 4.0, 0.5);
}

TEST(InsReport, FixesThatScatterFarLessThanStated) {
  for (const ImuGrade grade : {ImuGrade::navigation, ImuGrade::tactical}) {
    Trial run = trial_of(grade, 2);
    run.change_gnss = [](core::GnssData& g) {
      for (auto& c : g.covariance) c *= 9.0;
    };
    EXPECT_NE(outcry(run, lines_and_turns(), "times too large by their scatter"), "");
    const FixesUsed fixes = run.on(lines_and_turns()).report.figures.fixes;
    ASSERT_TRUE(fixes.overstated);
    EXPECT_GT(*fixes.overstated, 2.0);
    EXPECT_LT(*fixes.overstated, 5.0);
    EXPECT_GT(fixes.correlated, 0.9);
  }
}

TEST(InsReport, FixesMostOfWhoseErrorIsCorrelatedAreNoAlarm) {
  for (std::uint64_t seed = 1; seed <= 3; ++seed) {
    Trial run = trial_of(ImuGrade::tactical, seed);
    run.fixes.share = 0.9;
    const InsGnssResult r = run.on(lines_and_turns());
    EXPECT_GT(r.report.figures.fixes.correlated, 0.8);
    EXPECT_FALSE(r.report.figures.fixes.overstated) << *r.report.figures.fixes.overstated;
    EXPECT_EQ(warning_with(r, "too large"), "");
  }
}

TEST(InsReport, AHeadingThatIsNotKnown) {
  Trial run = trial_of(ImuGrade::mems);
  const std::string w = outcry(run, test::straight_line(), "the heading is known to");
  EXPECT_NE(w, "");
  EXPECT_NE(w.find("deg only"), std::string::npos);
  EXPECT_EQ(run.on(test::straight_line()).report.figures.named.back().code, "trajectory.heading");
}

TEST(InsReport, Gaps) {
  Trial run;
  run.change_imu = [](core::ImuData& imu) {
    const auto erase = [&](auto& v) { v.erase(v.begin() + 9000, v.begin() + 9150), v.erase(v.begin() + 3000, v.begin() + 3004); };
    erase(imu.time), erase(imu.step), erase(imu.angle), erase(imu.velocity);
  };
  const InsGnssResult r = run.on(lines_and_turns());
  EXPECT_NE(warning_with(r, "2 gaps in the IMU records, the longest of 1.5 s"), "");
  const std::vector<Interruption>& gaps = r.report.figures.gaps;
  ASSERT_EQ(gaps.size(), 2u);
  EXPECT_NEAR(gaps[0].start, test::motion_start + 30, 1e-3);
  EXPECT_NEAR(gaps[1].length, 1.5, 1e-3);
}

TEST(InsReport, SeriesAndNumbersAgree) {
  core::ImuErrorModel unscaled = core::error_model_of(ImuGrade::tactical);
  unscaled.gyro_scale.value = unscaled.accelerometer_scale.value = 0.0;
  const core::ImuData exact = lines_and_turns().exact.imu, dirty = test::with_errors(exact, unscaled, 1);
  Trial run;
  run.change_imu = [&](core::ImuData& imu) { imu = dirty; };
  const InsGnssResult r = run.on(lines_and_turns());
  const core::SmootherSeries& s = r.series;
  const size_t nodes = r.report.figures.span.nodes;
  EXPECT_EQ(s.time.size(), nodes);
  for (const size_t n : {s.separation.size(), s.separation_sigma.size(), s.attitude_separation.size(), s.heading_forward.size(),
                         s.gyro_bias.size(), s.gyro_bias_sigma.size(), s.accelerometer_bias.size(), s.accelerometer_bias_sigma.size()})
    EXPECT_EQ(n, nodes);
  EXPECT_EQ(s.fix_time.size(), 1201u);
  for (const size_t n : {s.innovation.size(), s.innovation_sigma.size(), s.residual.size(), s.nis.size(), s.weight.size()})
    EXPECT_EQ(n, 1201u);
  double nis = 0, clean = 0;
  Vector3d squares = Vector3d::Zero();
  for (size_t k = 0; k < s.nis.size(); ++k) {
    squares += s.innovation[k].cwiseAbs2();
    if (s.weight[k] < 1) continue;
    nis += s.nis[k];
    ++clean;
  }
  EXPECT_NEAR(test::number(r, "innovations", "mean_nis"), nis / clean, 1e-12);
  EXPECT_NEAR(r.report.figures.innovations.rms[1], std::sqrt(squares[1] / 1201), 1e-12);
  EXPECT_EQ(r.report.figures.fixes.used, 1201u);
  // The bias that is printed is the one that was put in, within its sigma.
  const core::Value bias = *core::reported(r.report).find("estimates")->find("gyro_bias");
  EXPECT_EQ(bias.find("unit")->as_text(), "deg_per_h");
  EXPECT_NEAR(bias.find("stated_sigma")->as_number(), std::hypot(0.1, 0.03), 1e-9);
  Vector3d sum = Vector3d::Zero();
  for (size_t k = 0; k < exact.size(); ++k) sum += dirty.angle[k] - exact.angle[k];
  for (int i = 0; i < 3; ++i) {
    const double value = bias.find("value")->items()[static_cast<size_t>(i)].as_number(),
                 sigma = bias.find("sigma")->items()[static_cast<size_t>(i)].as_number();
    // The mean error holds white noise of 0.01 deg/sqrt(h) over 240 s, 0.04 deg/h.
    EXPECT_NEAR(value, sum[i] / 240 / core::degree * 3600, 4 * std::hypot(sigma, 0.06)) << i;
  }
  const SeparationFigures separation = r.report.figures.separation.value();
  EXPECT_LT(separation.median, 0.1);
  EXPECT_GE(separation.largest, separation.median);
  const double heading = r.report.figures.sigma.attitude[2];
  double mean = 0;
  for (const auto& c : r.trajectory.covariance.upper) mean += core::CovarianceSeries::unpack(c)(8, 8) / static_cast<double>(nodes);
  EXPECT_NEAR(heading, std::sqrt(mean) / core::degree * 3600, 1e-6 * heading);
}

}  // namespace
}  // namespace swath::trajectory
