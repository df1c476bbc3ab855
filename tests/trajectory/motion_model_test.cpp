// SPDX-License-Identifier: GPL-3.0-or-later
#include "trajectory/motion_model.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/trajectory/made_flight.h"

namespace swath::trajectory {
namespace {

/// An antenna whose acceleration is the model's own process, in steps of 10 ms, with white and slow errors of its fixes.
struct ProcessFlight {
  PointFixes fixes;
  std::vector<double> acceleration{0.0, 0.0, 0.0};

  void fly(test::MadeFlight& random, size_t n, double rate, const std::array<AxisMotion, 3>& motion, double white, double slow) {
    constexpr double step = 0.01;
    const Eigen::Vector3d offset = slow * Eigen::Vector3d(random.normal(), random.normal(), random.normal());
    const auto every = static_cast<size_t>(std::round(1.0 / (rate * step)));
    for (size_t i = 0; i < n * every; ++i) {
      if (i % every == 0) {
        fixes.time.push_back(now_);
        fixes.position.push_back(p_ + offset + white * Eigen::Vector3d(random.normal(), random.normal(), random.normal()));
        fixes.covariance.push_back((white * white + slow * slow) * Eigen::Matrix3d::Identity());
      }
      for (int k = 0; k < 3; ++k) {
        const AxisMotion& m = motion[static_cast<size_t>(k)];
        const double keep = std::exp(-step / m.time);
        a_[k] = keep * a_[k] + std::sqrt(1.0 - keep * keep) * m.acceleration() * random.normal();
      }
      p_ += step * v_;
      v_ += step * a_;
      now_ += step;
    }
  }

 private:
  Eigen::Vector3d p_ = Eigen::Vector3d::Zero(), v_{60.0, 0.0, 0.0}, a_ = Eigen::Vector3d::Zero();
  double now_ = 0.0;
};

TEST(MotionModel, NoiseAndTransitionAreThoseOfTheProcess) {
  // The sum of many short steps, each of which a fourth-order series gives; and both sides of where the closed form takes over.
  for (const double dt : {0.2, 0.99, 1.01, 3.0, 40.0}) {
    const AxisMotion m = motion_of(0.7, 2.0);
    constexpr int steps = 4000;
    const double h = dt / steps;
    Eigen::Matrix3d f = Eigen::Matrix3d::Identity(), q = Eigen::Matrix3d::Zero(), one = Eigen::Matrix3d::Identity();
    const double keep = std::exp(-h / m.time);
    one << 1.0, h, h * h / 2.0 - h * h * h / (6.0 * m.time), 0.0, 1.0, m.time * (1.0 - keep), 0.0, 0.0, keep;
    Eigen::Matrix3d added;
    added << h * h * h * h * h / 20.0, h * h * h * h / 8.0, h * h * h / 6.0, h * h * h * h / 8.0, h * h * h / 3.0, h * h / 2.0,
        h * h * h / 6.0, h * h / 2.0, h - h * h / m.time;
    for (int k = 0; k < steps; ++k) {
      f = one * f;
      q = one * q * one.transpose() + m.drive * added;
    }
    const Eigen::Matrix3d ours = motion_noise(m, dt);
    EXPECT_LT((motion_transition(m, dt) - f).cwiseAbs().maxCoeff(), 1e-5 * f.cwiseAbs().maxCoeff()) << dt;
    constexpr double series = 1e-3;  // of the short steps' own series at h / time = 0.005
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j) EXPECT_NEAR(ours(i, j), q(i, j), series * std::sqrt(q(i, i) * q(j, j))) << dt << " " << i << j;
  }
  const AxisMotion m = motion_of(1.0, 1.0);
  EXPECT_LT((motion_noise(m, 0.5 - 1e-9) - motion_noise(m, 0.5 + 1e-9)).cwiseAbs().maxCoeff(), 1e-8);
  EXPECT_EQ(motion_noise(m, 0.0), Eigen::Matrix3d::Zero());
  EXPECT_NEAR(motion_of(0.7, 3.0).acceleration(), 0.7, 1e-12);
}

TEST(MotionModel, FindsLevelTimeAndWhiteShare) {
  test::MadeFlight random(3);
  ProcessFlight flight;
  const std::array<AxisMotion, 3> truth{motion_of(0.2, 2.0), motion_of(0.5, 5.0), motion_of(0.3, 1.0)};
  flight.fly(random, 1500, 5.0, truth, 0.012, 0.016);
  const MotionModel m = fit_motion(flight.fixes, {0});
  for (size_t k = 0; k < 3; ++k) {
    EXPECT_NEAR(m.motion[0][k].acceleration() / truth[k].acceleration(), 1.0, 0.25) << k;  // 300 s hold some 60 times its memory
    EXPECT_NEAR(std::log(m.motion[0][k].time / truth[k].time), 0.0, 0.5) << k;
    EXPECT_NEAR(m.white[static_cast<int>(k)], 0.6, 0.05) << k;
    EXPECT_NEAR(m.slow[static_cast<int>(k)], 0.8, 0.05) << k;
  }
  const Eigen::Matrix3d stated = flight.fixes.covariance[0];
  EXPECT_LT((m.white_of(stated) + m.slow_of(stated) - stated).norm(), 0.05 * stated.norm());
}

TEST(MotionModel, EachPieceHasItsLevel) {
  test::MadeFlight random(4);
  ProcessFlight flight;
  constexpr double levels[] = {0.1, 1.5, 0.3};
  for (const double a : levels) flight.fly(random, 150, 1.0, {motion_of(a, 3.0), motion_of(a, 3.0), motion_of(a, 3.0)}, 0.02, 0.0);
  const MotionModel m = fit_motion(flight.fixes, {0, 150, 300});
  for (size_t p = 0; p < 3; ++p)
    for (size_t k = 0; k < 3; ++k) EXPECT_NEAR(std::log(m.motion[p][k].acceleration() / levels[p]), 0.0, 0.5) << p << k;
  EXPECT_EQ(&m.at(-5.0), &m.motion[0]);
  EXPECT_EQ(&m.at(149.5), &m.motion[0]);
  EXPECT_EQ(&m.at(200.0), &m.motion[1]);
  EXPECT_EQ(&m.at(1e6), &m.motion[2]);
}

TEST(MotionModel, LikelihoodIsThatOfTheStackedFixes) {
  // Three fixes and one innovation: by hand from the covariance of the second difference.
  PointFixes fixes;
  const double z[] = {0.0, 1.0, 2.3};
  for (int i = 0; i < 3; ++i) {
    fixes.time.push_back(i);
    fixes.position.emplace_back(z[i], 0.0, 0.0);
    fixes.covariance.push_back(0.01 * Eigen::Matrix3d::Identity());
  }
  const AxisMotion m = motion_of(0.5, 2.0);
  // p2 - 2 p1 + p0 by the acceleration that begins with its stationary variance: stepwise over two seconds.
  const Eigen::Matrix3d f = motion_transition(m, 1.0), q = motion_noise(m, 1.0);
  Eigen::Matrix3d start = Eigen::Matrix3d::Zero();
  start(2, 2) = 0.25;
  const Eigen::Matrix3d p1 = f * start * f.transpose() + q, p2 = f * p1 * f.transpose() + q, p21 = f * p1;
  const double motion = p2(0, 0) - 4.0 * p21(0, 0) + 4.0 * p1(0, 0), variance = motion + 0.01 * (1.0 + 4.0 + 1.0);
  EXPECT_NEAR(log_likelihood(fixes, 0, 3, 0, m, 1.0), -0.5 * (std::log(variance) + 0.09 / variance), 1e-4);
}

TEST(MotionModel, AnAntennaThatStandsGetsTheLeastAcceleration) {
  test::MadeFlight random(5);
  ProcessFlight flight;
  flight.fly(random, 200, 1.0, {motion_of(1e-9, 1.0), motion_of(1e-9, 1.0), motion_of(1e-9, 1.0)}, 0.02, 0.0);
  const MotionModel m = fit_motion(flight.fixes, {0});
  for (size_t k = 0; k < 3; ++k) EXPECT_LT(m.motion[0][k].acceleration(), 2e-3) << k;
  EXPECT_NEAR(m.white[0], 1.0, 0.1);
}

}  // namespace
}  // namespace swath::trajectory
