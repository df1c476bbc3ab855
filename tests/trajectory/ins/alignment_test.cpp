// SPDX-License-Identifier: GPL-3.0-or-later
#include "trajectory/ins/alignment.h"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <functional>

#include "core/geo/geodesy.h"
#include "tests/trajectory/ins_problem.h"

namespace swath::trajectory {
namespace {

using core::ImuGrade;
using Eigen::Matrix3d;
using Eigen::Vector3d;
using test::InsProblem;

InsProblem::Setup setup_of(ImuGrade grade, double until, std::uint64_t seed = 1) {
  InsProblem::Setup s;
  s.sensors.until = until;
  s.imu = core::error_model_of(grade);
  s.seed = seed;
  return s;
}

/// Rotation from the alignment to the truth, ecef axes.
Vector3d error_of(const Alignment& a, const test::MotionAt& motion) {
  return core::log_so3(test::truth_at(motion, a.time - test::motion_start).ecef_R_body * a.ecef_R_body.transpose());
}
double normed(const Vector3d& e, const Matrix3d& covariance) { return e.dot(covariance.llt().solve(e)); }

/// An engine at idle: 25 Hz of 0.15 m/s^2 and 0.2 deg/s, and white noise.
core::ImuData idling(core::ImuData imu) {
  test::Dice dice(4);
  for (size_t k = 0; k < imu.size(); ++k) {
    const double dt = imu.step[k], wave = std::sin(2 * core::pi * 25.0 * (imu.time[k] - imu.time[0]) + 0.4);
    imu.velocity[k] += dt * (0.15 * wave * Vector3d(0.5, 0.3, 1) + 0.03 * dice.vector());
    imu.angle[k] += dt * 0.2 * core::degree * (wave * Vector3d(1, 0.5, 0.2) + 0.2 * dice.vector());
  }
  return imu;
}

TEST(Alignment, FindsWhereABodyStandsStill) {
  // Stands for 30 s, drives, stops from 96 s to 120 s, then rolls at 0.3 m/s.
  const test::Drive drive({{30, 1}, {90, 0}, {120, 0.02}});
  for (const ImuGrade grade : {ImuGrade::tactical, ImuGrade::mems, ImuGrade::consumer})
    for (const bool engine : {false, true}) {
      InsProblem::Setup setup = setup_of(grade, 160);
      if (engine) setup.change_imu = idling;
      const InsProblem made(drive, setup);
      const std::vector<Span> found = find_standstills(made.path, made.gnss, setup.imu);
      ASSERT_EQ(found.size(), 2u) << static_cast<int>(grade) << engine;
      // By whole seconds; the first and last of them creep.
      EXPECT_NEAR(found[0].first - test::motion_start, 0.0, 1e-6);
      EXPECT_NEAR(found[0].last - test::motion_start, 30.0, 2.01);
      EXPECT_NEAR(found[1].first - test::motion_start, 96.0, 2.01);
      EXPECT_NEAR(found[1].last - test::motion_start, 120.0, 3.01);
    }
}

TEST(Alignment, AFlightNeverStandsStill) {
  const InsProblem made(test::motion_of(test::straight_flight(2000)), setup_of(ImuGrade::tactical, 40));
  EXPECT_TRUE(find_standstills(made.path, made.gnss, made.setup.imu).empty());
  // Nor does what no fix speaks for.
  InsProblem::Setup silent = setup_of(ImuGrade::tactical, 40);
  silent.change_gnss = [](const core::GnssData& g) { return test::keep_fixes(g, [](size_t k) { return k % 50 == 0; }); };
  const InsProblem quiet(test::Drive({{100, 1}}), silent);
  EXPECT_TRUE(find_standstills(quiet.path, quiet.gnss, silent.imu).empty());
}

TEST(Alignment, StandingANavigationGradeFindsNorth) {
  const test::Drive standing({{200, 1}}, 0.3, 0.05);
  for (const ImuGrade grade : {ImuGrade::navigation, ImuGrade::tactical}) {
    const core::ImuErrorModel model = core::error_model_of(grade);
    double squares = 0;
    constexpr int seeds = 20;
    for (int seed = 1; seed <= seeds; ++seed) {
      const InsProblem made(standing, setup_of(grade, 60, static_cast<std::uint64_t>(seed)));
      const Alignment a = align_still(made.path, {test::motion_start, test::motion_start + 60}, made.gnss.position[0], made.setup.imu);
      EXPECT_NEAR(a.time, test::motion_start + 30, 0.01);
      const Vector3d e = error_of(a, made.motion);
      const Vector3d up = core::ecef_R_ned(0.8378, 0.1833).col(2);
      const double heading_sigma = std::sqrt(up.dot(a.covariance * up));
      EXPECT_LT(std::abs(up.dot(e)), 3.5 * heading_sigma) << seed;
      // East gyro bias and noise over the level part of the Earth's rate, 10 deg/h at 48 deg north.
      const double east = std::hypot(model.gyro_bias.value, model.angular_random_walk.value / std::sqrt(60.0));
      EXPECT_NEAR(heading_sigma, east / (10.06 * core::degree / 3600), 0.1 * heading_sigma);
      EXPECT_NEAR(a.worst_sigma(), heading_sigma, 0.01 * heading_sigma);
      squares += normed(e, a.covariance) / 3;
    }
    // 60 values: sigma of their mean sqrt(2 / 60).
    EXPECT_NEAR(squares / seeds, 1.0, 4 * std::sqrt(2.0 / (3 * seeds))) << static_cast<int>(grade);
  }
}

TEST(Alignment, StandingPoorGyrosSayThatTheyDoNotKnow) {
  const test::Drive standing({{200, 1}});
  const InsProblem made(standing, setup_of(ImuGrade::mems, 60));
  const Alignment a = align_still(made.path, {test::motion_start, test::motion_start + 60}, made.gnss.position[0], made.setup.imu);
  EXPECT_GT(a.worst_sigma(), 40 * core::degree);
  // Level it knows, and what the gyros say at rest is their bias.
  const Vector3d up = core::ecef_R_ned(0.8378, 0.1833).col(2), e = error_of(a, made.motion);
  EXPECT_LT((e - up * up.dot(e)).norm(), 4 * 3000 * 9.8e-6 / 9.8);
  EXPECT_LT(a.gyro_bias.norm(), 4 * std::sqrt(3.0) * made.setup.imu.gyro_bias.value);
}

TEST(Alignment, InMotionOnTurns) {
  const test::MotionAt motion = test::motion_of(test::survey_flight(3));
  for (const ImuGrade grade : {ImuGrade::tactical, ImuGrade::mems})
    for (int seed = 1; seed <= 4; ++seed) {
      InsProblem::Setup setup = setup_of(grade, 100, static_cast<std::uint64_t>(seed));
      setup.sensors.from = 25;
      const InsProblem made(motion, setup);
      const auto a = align_moving(made.path, made.gnss, setup.sensors.lever, setup.imu, Vector3d::Zero());
      ASSERT_TRUE(a) << seed;
      const Vector3d e = error_of(*a, motion);
      std::printf("turns, seed %d: error %.3f deg, worst sigma %.3f deg\n", seed, e.norm() / core::degree, a->worst_sigma() / core::degree);
      EXPECT_LT(a->worst_sigma(), 2.5 * core::degree) << seed;
      // Chi-square of 3 beyond 20: 2e-4.
      EXPECT_LT(normed(e, a->covariance), 20.0) << seed;
    }
}

TEST(Alignment, GapsAndSeldomFixesInTheFirstWindow) {
  const test::MotionAt motion = test::motion_of(test::survey_flight(3));
  const std::vector<std::function<bool(double)>> kept{[](double t) { return t < 15.1 || t > 18.0; },     // s from the first fix
                                                      [](double t) { return t < 15.1 || t > 20.0; },     //
                                                      [](double t) { return t < 15.1 || t > 26.0; },     //
                                                      [](double t) { return std::fmod(t, 4.0) < 0.1; },  // every 4 s
                                                      [](double t) { return std::fmod(t, 5.0) < 0.1; }};
  for (size_t which = 0; which < kept.size(); ++which) {
    InsProblem::Setup setup = setup_of(ImuGrade::tactical, 100);
    setup.sensors.from = 25;
    setup.change_gnss = [&](const core::GnssData& g) {
      return test::keep_fixes(g, [&](size_t k) { return kept[which](g.time[k] - g.time[0] + 0.01); });
    };
    const InsProblem made(motion, setup);
    const auto a = align_moving(made.path, made.gnss, setup.sensors.lever, setup.imu, Vector3d::Zero());
    ASSERT_TRUE(a) << which;
    EXPECT_LT(a->worst_sigma(), 3 * core::degree) << which;
    EXPECT_LT(normed(error_of(*a, motion), a->covariance), 20.0) << which;
  }
}

TEST(Alignment, InMotionOnAStraightLineHeadingIsTheTrack) {
  const test::MotionAt motion = test::motion_of(test::straight_flight(4000));
  for (int seed = 1; seed <= 4; ++seed) {
    const InsProblem made(motion, setup_of(ImuGrade::tactical, 60, static_cast<std::uint64_t>(seed)));
    const auto a = align_moving(made.path, made.gnss, made.setup.sensors.lever, made.setup.imu, Vector3d::Zero());
    ASSERT_TRUE(a);
    const Vector3d e = error_of(*a, motion), up = core::ecef_R_ned(0.8378, 0.1833).col(2);
    std::printf("straight, seed %d: error %.2f deg about up, %.3f deg of tilt, worst sigma %.2f deg\n", seed, up.dot(e) / core::degree,
                (e - up * up.dot(e)).norm() / core::degree, a->worst_sigma() / core::degree);
    EXPECT_GT(a->worst_sigma(), 3 * core::degree);
    EXPECT_LT(a->worst_sigma(), 15.1 * core::degree);
    EXPECT_LT(std::abs(up.dot(e)), 3 * a->worst_sigma());
    EXPECT_LT((e - up * up.dot(e)).norm(), 1 * core::degree);
  }
}

TEST(Alignment, InMotionTheLeverArmCounts) {
  const test::MotionAt motion = test::motion_of(test::survey_flight(3));
  InsProblem::Setup setup = setup_of(ImuGrade::tactical, 80);
  setup.sensors.from = 30;
  setup.sensors.lever = Vector3d(-3, 1, -6);
  const InsProblem made(motion, setup);
  const auto with = align_moving(made.path, made.gnss, setup.sensors.lever, setup.imu, Vector3d::Zero());
  const auto without = align_moving(made.path, made.gnss, Vector3d::Zero(), setup.imu, Vector3d::Zero());
  ASSERT_TRUE(with && without);
  EXPECT_LT(2 * error_of(*with, motion).norm(), error_of(*without, motion).norm());
}

TEST(Alignment, WithoutEnoughThereIsNone) {
  const test::MotionAt motion = test::motion_of(test::survey_flight(3));
  const auto none = [&](const InsProblem::Setup& setup) {
    const InsProblem made(motion, setup);
    return !align_moving(made.path, made.gnss, setup.sensors.lever, setup.imu, Vector3d::Zero());
  };
  InsProblem::Setup setup = setup_of(ImuGrade::tactical, 50);
  setup.change_gnss = [](const core::GnssData& g) { return test::keep_fixes(g, [](size_t k) { return k < 3; }); };
  EXPECT_TRUE(none(setup));
  setup.change_gnss = [](const core::GnssData& g) { return test::keep_fixes(g, [](size_t k) { return k % 100 == 0; }); };
  EXPECT_TRUE(none(setup)) << "20 s between fixes";
  setup.change_gnss = nullptr;
  const auto drop = [](size_t first, size_t last) {
    return [=](core::ImuData imu) {
      const auto erase = [&](auto& v) { v.erase(v.begin() + static_cast<long>(first), v.begin() + static_cast<long>(last)); };
      erase(imu.time), erase(imu.step), erase(imu.angle), erase(imu.velocity);
      return imu;
    };
  };
  setup.change_imu = drop(3000, 3800);
  EXPECT_TRUE(none(setup)) << "a bridge of 8 s in each window of 40 s";
  // A record or two that are missing do no harm.
  setup.change_imu = drop(3000, 3002);
  EXPECT_FALSE(none(setup));
}

TEST(Alignment, TheGyrosCarryIt) {
  const test::MotionAt motion = test::motion_of(test::survey_flight(2));
  InsProblem::Setup setup = setup_of(ImuGrade::perfect, 60);
  const InsProblem made(motion, setup);
  Alignment a;
  a.time = test::motion_start + 20;
  a.ecef_R_body = test::truth_at(motion, 20).ecef_R_body;
  a.covariance = 1e-6 * Matrix3d::Identity();
  a.method = "given";
  const core::ImuErrorModel tactical = core::error_model_of(ImuGrade::tactical);
  for (const double t : {0.0, 20.0, 33.3, 60.0}) {
    const Alignment b = carried(a, test::motion_start + t, made.path, tactical);
    EXPECT_NEAR(b.time, test::motion_start + t, 1e-6);
    EXPECT_LT(error_of(b, motion).norm(), 1e-5) << t;
    EXPECT_EQ(b.method, "given");
    const double dt = std::abs(t - 20),
                 variance = std::pow(tactical.gyro_bias.value * dt, 2) + std::pow(tactical.angular_random_walk.value, 2) * dt;
    EXPECT_NEAR(b.covariance(1, 1), 1e-6 + variance, 1e-12);
  }
  // A known bias of 0.01 rad/s is taken out on the way.
  setup.change_imu = [](core::ImuData imu) {
    for (size_t k = 0; k < imu.size(); ++k) imu.angle[k] += 0.01 * imu.step[k] * Vector3d(1, 2, 3);
    return imu;
  };
  const InsProblem biased(motion, setup);
  a.gyro_bias = 0.01 * Vector3d(1, 2, 3);
  EXPECT_LT(error_of(carried(a, test::motion_start + 60, biased.path, tactical), motion).norm(), 1e-5);
}

}  // namespace
}  // namespace swath::trajectory
