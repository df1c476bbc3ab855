// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/geo/frames.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>

namespace swath::core {
namespace {

constexpr double pi = std::numbers::pi;
constexpr double rounding = 1e-14;        // a few last places of numbers near 1
constexpr double angle_rounding = 1e-13;  // rad: the same through divisions by cos(pitch) >= 0.1

Eigen::Matrix3d about(int axis, double angle) { return Eigen::AngleAxisd(angle, Eigen::Vector3d::Unit(axis)).toRotationMatrix(); }

TEST(Frames, MatrixIsHeadingAfterPitchAfterRoll) {
  const Attitude a{0.1, -0.2, 2.5};
  EXPECT_LT((matrix_of(a) - about(2, 2.5) * about(1, -0.2) * about(0, 0.1)).norm(), rounding);
}

// By hand: heading east, nose up 30 deg, right wing down 90 deg. Forward points east and up, the right wing down and (square to the nose)
// east, the belly to the left of the flight, north.
TEST(Frames, MatrixMatchesAnAttitudeComposedByHand) {
  const Eigen::Matrix3d R = matrix_of({pi / 2, pi / 6, pi / 2});
  const double s = 0.5, c = std::sqrt(3.0) / 2.0;
  EXPECT_LT((R.col(0) - Eigen::Vector3d(0, c, -s)).norm(), rounding);  // forward: east, up
  EXPECT_LT((R.col(1) - Eigen::Vector3d(0, s, c)).norm(), rounding);   // right wing: down, leaning east
  EXPECT_LT((R.col(2) - Eigen::Vector3d(1, 0, 0)).norm(), rounding);   // belly: north, to the left of flight
}

TEST(Frames, SignsOfRollPitchHeading) {
  EXPECT_GT((matrix_of({0.1, 0, 0}) * Eigen::Vector3d::UnitY()).z(), 0.0);  // right wing down
  EXPECT_LT((matrix_of({0, 0.1, 0}) * Eigen::Vector3d::UnitX()).z(), 0.0);  // nose up
  EXPECT_GT((matrix_of({0, 0, 0.1}) * Eigen::Vector3d::UnitX()).y(), 0.0);  // clockwise: towards east
}

TEST(Frames, AttitudeComesBack) {
  std::mt19937 random(1);
  std::uniform_real_distribution<double> roll(-3.1, 3.1), pitch(-1.47, 1.47), heading(0.0, 2.0 * pi);
  for (int i = 0; i < 1000; ++i) {
    const Attitude a{roll(random), pitch(random), heading(random)};
    const Attitude b = attitude_of(matrix_of(a));
    EXPECT_NEAR(b.roll, a.roll, angle_rounding);
    EXPECT_NEAR(b.pitch, a.pitch, angle_rounding);
    EXPECT_NEAR(wrap_pi(b.heading - a.heading), 0.0, angle_rounding);
    EXPECT_GE(b.heading, 0.0);
    EXPECT_LT(b.heading, 2.0 * pi);
  }
}

TEST(Frames, StraightUpHasNoRollAndKeepsTheMatrix) {
  for (const double pitch : {pi / 2, -pi / 2}) {
    const Eigen::Matrix3d R = matrix_of({0.3, pitch, 1.1});
    const Attitude a = attitude_of(R);
    EXPECT_EQ(a.roll, 0.0);
    EXPECT_NEAR(a.pitch, pitch, rounding);
    EXPECT_LT((matrix_of(a) - R).norm(), rounding);
  }
  // Nearly straight up, where roll and heading are ill determined, the matrix must still come back.
  constexpr double lock = 1e-9;  // the size of cos(pitch) taken as locked, with its margin
  for (const double off : {1e-3, 1e-6, 1e-9, 1e-11, 1e-13}) {
    const Eigen::Matrix3d R = matrix_of({0.3, pi / 2 - off, 1.1});
    EXPECT_LT((matrix_of(attitude_of(R)) - R).norm(), off < lock ? lock : rounding) << off;
  }
}

TEST(Frames, SkewIsTheCrossProduct) {
  const Eigen::Vector3d v(1, -2, 3), w(0.5, 4, -1);
  EXPECT_EQ(skew(v) * w, v.cross(w));
}

TEST(Frames, ExpIsTheRotationAboutItsVector) {
  std::mt19937 random(2);
  std::normal_distribution<double> unit;
  for (const double angle : {1e-12, 1e-8, 9.9e-5, 1.01e-4, 1e-2, 1.0, 3.0, pi - 1e-9, pi}) {
    const Eigen::Vector3d axis = Eigen::Vector3d(unit(random), unit(random), unit(random)).normalized();
    const Eigen::Matrix3d R = exp_so3(angle * axis);
    EXPECT_LT((R - Eigen::AngleAxisd(angle, axis).toRotationMatrix()).norm(), rounding) << angle;
    EXPECT_LT((R * R.transpose() - Eigen::Matrix3d::Identity()).norm(), rounding) << angle;
  }
  EXPECT_EQ(exp_so3(Eigen::Vector3d::Zero()), Eigen::Matrix3d::Identity());
}

TEST(Frames, LogIsTheInverseOfExpFromZeroToPi) {
  std::mt19937 random(3);
  std::normal_distribution<double> unit;
  for (const double angle : {0.0, 1e-300, 1e-12, 1e-8, 1e-5, 1.9e-4, 2.1e-4, 1e-2, 1.0, 2.0, 3.0, pi - 1e-4, pi - 1e-8, pi - 1e-12})
    for (int i = 0; i < 50; ++i) {
      const Eigen::Vector3d v = angle * Eigen::Vector3d(unit(random), unit(random), unit(random)).normalized();
      // Relative near zero: a small rotation must keep all its digits beside the last place of the matrix's ones.
      EXPECT_LT((log_so3(exp_so3(v)) - v).norm(), rounding * angle + rounding) << angle;
    }
  // At pi the axis has no sign; the length and the rotation stay.
  const Eigen::Vector3d axis = Eigen::Vector3d(1, 2, -2) / 3.0;
  const Eigen::Vector3d half_turn = log_so3(exp_so3(pi * axis));
  EXPECT_NEAR(half_turn.norm(), pi, rounding);
  EXPECT_NEAR(std::abs(half_turn.dot(axis)), pi, rounding);
}

// d/dt exp(v + t w) at v = 0 is skew(w): central differences.
TEST(Frames, ExpHasTheSkewMatrixAsItsSlopeAtZero) {
  constexpr double h = 1e-5;
  constexpr double cut = h * h;  // of central differences
  const Eigen::Vector3d w(0.3, -0.7, 0.6);
  EXPECT_LT(((exp_so3(h * w) - exp_so3(-h * w)) / (2 * h) - skew(w)).norm(), cut);
}

TEST(Frames, AnglesWrap) {
  EXPECT_NEAR(wrap_pi(3.0 * pi / 2), -pi / 2, rounding);
  EXPECT_EQ(wrap_pi(pi), pi);
  EXPECT_EQ(wrap_pi(-pi), pi);
  EXPECT_NEAR(wrap_pi(-7.0), -7.0 + 2 * pi, rounding);
  EXPECT_EQ(wrap_two_pi(0.0), 0.0);
  EXPECT_EQ(wrap_two_pi(2 * pi), 0.0);
  EXPECT_NEAR(wrap_two_pi(-0.5), 2 * pi - 0.5, rounding);
  EXPECT_EQ(wrap_two_pi(-1e-300), 0.0);  // 2 pi - tiny rounds to 2 pi, which is outside
}

}  // namespace
}  // namespace swath::core
