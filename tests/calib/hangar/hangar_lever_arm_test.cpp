// SPDX-License-Identifier: GPL-3.0-or-later
#include "calib/hangar/hangar_lever_arm.h"

#include <gtest/gtest.h>

#include <cmath>

#include "core/config/units.h"

namespace swath::calib {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::Vector3d;

constexpr double deg = core::degree;
constexpr double rounding = 1e-12;

HangarPoints four() { return {{{8, 6, 1.1}, {8.3, 5.1, 2.2}, {10, 9, 1.2}, {5, 2, 1.4}}, MatrixXd::Identity(12, 12) * 1e-6}; }

TEST(HangarLeverArm, SignsInWords) {
  // Level and nose along y (north): x of the hangar is right, up is up.
  HangarPoints p = four();
  p.position[1] = p.position[0] + Vector3d(1, 2, 3);
  const BodyVector north = body_vector(p, {0}, {1}, stated_axes({}, Vector3d::Zero(), 4));
  EXPECT_LT((north.value - Vector3d(2, 1, -3)).norm(), rounding);
  // Nose along x (east): y of the hangar is left.
  const BodyVector east = body_vector(p, {0}, {1}, stated_axes({0, 0, 90 * deg}, Vector3d::Zero(), 4));
  EXPECT_LT((east.value - Vector3d(1, -2, -3)).norm(), rounding);
  // Offsets count in body axes.
  const BodyVector offset = body_vector(p, {0, {0.1, 0, 0}, 0}, {1, {0, 0, -0.5}, 0}, stated_axes({0, 0, 90 * deg}, Vector3d::Zero(), 4));
  EXPECT_LT((offset.value - Vector3d(0.9, -2, -3.5)).norm(), rounding);
  // Marks: the nose is where `fore` is.
  p.position[2] = Vector3d(10, 5, 1);
  p.position[3] = Vector3d(2, 5, 1.5);
  EXPECT_NEAR(axes_of_marks(p, {3}, {2}, 0, {}, Vector3d::Zero()).attitude.heading, 90 * deg, rounding);
  EXPECT_NEAR(axes_of_marks(p, {2}, {3}, 2 * deg, {}, Vector3d::Zero()).attitude.heading, 272 * deg, rounding);
}

TEST(HangarLeverArm, TheVerticalOneOfThePaper) {
  // Roof 50.357, perspective centre 49.672, 0.153172 below its mark, antenna 0.015 above the roof: 0.853 m, not the printed 0.883 m.
  HangarPoints p{{{50.222, 50.255, 49.672}, {50.222, 50.255, 50.357}}, MatrixXd::Zero(6, 6)};
  p.covariance(2, 2) = 0.003 * 0.003;
  p.covariance(5, 5) = 0.002 * 0.002;
  const BodyVector v = body_vector(p, {0, {0, 0, 0.153172}, 0}, {1, {0, 0, -0.015}, 0}, stated_axes({}, Vector3d::Zero(), 2));
  EXPECT_NEAR(-v.value.z(), 0.853172, 1e-12);
  EXPECT_NEAR(std::sqrt(v.covariance(2, 2)), std::hypot(0.003, 0.002), 1e-12);
}

TEST(HangarLeverArm, JacobiansAreThoseOfCentralDifferences) {
  constexpr double h = 1e-6, tolerance = 1e-8;
  const HangarPoints p = four();
  const BodyPoint from{0, {0.1, 0.2, 0.3}, 0.001}, to{1, {-0.1, 0, 0.05}, 0.002};
  const core::Attitude level{2 * deg, -3 * deg, 0};
  const auto axes = [&](const HangarPoints& at, double offset, const core::Attitude& a) {
    return axes_of_marks(at, {3}, {2, 1}, offset, a, Vector3d(0.001, 0.002, 0.003));
  };
  const BodyVector v = body_vector(p, from, to, axes(p, 0.01, level));
  for (Index k = 0; k < 12; ++k) {
    const auto moved = [&](double d) {
      HangarPoints q = p;
      q.position[static_cast<size_t>(k / 3)][k % 3] += d;
      return body_vector(q, from, to, axes(q, 0.01, level)).value;
    };
    EXPECT_LT((v.by_points.col(k) - (moved(h) - moved(-h)) / (2 * h)).norm(), tolerance) << k;
  }
  for (Index k = 0; k < 3; ++k) {
    const auto turned = [&](double d) {
      core::Attitude a = level;
      (k == 0 ? a.roll : a.pitch) += k < 2 ? d : 0;
      return body_vector(p, from, to, axes(p, 0.01 + (k == 2 ? d : 0), a)).value;
    };
    EXPECT_LT((v.by_angles.col(k) - (turned(h) - turned(-h)) / (2 * h)).norm(), tolerance) << k;
  }
}

TEST(HangarLeverArm, ASharedErrorDropsOut) {
  HangarPoints p = four();
  p.covariance = MatrixXd::Zero(12, 12);
  for (Index i = 0; i < 4; ++i)
    for (Index j = 0; j < 4; ++j) p.covariance.block<3, 3>(3 * i, 3 * j) = 1e-4 * Eigen::Matrix3d::Identity();
  const BodyVector v = body_vector(p, {0}, {1}, axes_of_marks(p, {3}, {2}, 0, {}, Vector3d::Zero()));
  EXPECT_LT(v.covariance.norm(), 1e-12);
}

}  // namespace
}  // namespace swath::calib
