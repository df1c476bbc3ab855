// SPDX-License-Identifier: GPL-3.0-or-later
#include "simulate/scan.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>

namespace swath::simulate {
namespace {

constexpr double tight = 1e-12;

ScannerOptions scanner(Pattern p) {
  ScannerOptions s;
  s.pattern = p;
  return s;
}

TEST(Scan, BeamsAreUnitVectorsWithinTheWidestAngle) {
  for (const Pattern p : {Pattern::triangle, Pattern::sine, Pattern::polygon, Pattern::profile, Pattern::beam, Pattern::multibeam,
                          Pattern::conical, Pattern::palmer}) {
    const ScannerOptions s = scanner(p);
    double widest = 0;
    for (int k = 0; k < 5000; ++k) {
      const ScanState at = scan_at(s, k / s.prf.value);
      const Eigen::Vector3d b = beam_of(s, at.angle, at.forward);
      ASSERT_NEAR(b.norm(), 1.0, tight);
      widest = std::max(widest, std::acos(std::min(1.0, b.z())));
    }
    EXPECT_LE(widest, widest_angle(s) + 1e-4);
    EXPECT_GE(widest, 0.97 * widest_angle(s));
  }
}

TEST(Scan, MirrorFormIsTheConvention) {
  const double a = 0.2;
  EXPECT_TRUE(beam_of(scanner(Pattern::triangle), a, 0).isApprox(Eigen::Vector3d(0, std::sin(a), std::cos(a)), tight));
  const Eigen::Vector3d nod = beam_of(scanner(Pattern::beam), a, 0.1);
  EXPECT_NEAR(nod.x(), 0.1, tight);
  EXPECT_NEAR(std::atan2(nod.y(), nod.z()), a, tight);
}

TEST(Scan, MultibeamFiresItsFanAtEachTurn) {
  ScannerOptions s = scanner(Pattern::multibeam);
  s.beams = 32;
  s.forward_tilt = core::degrees(20.0);
  s.prf = core::Hertz(32000.0);
  for (int k = 0; k < 64; ++k) {
    const ScanState at = scan_at(s, k / s.prf.value);
    EXPECT_NEAR(std::asin(at.forward), s.forward_tilt.value * (2.0 * (k % 32) / 31 - 1), tight) << k;
  }
}

TEST(Scan, PalmerIsAReflection) {
  const ScannerOptions s = scanner(Pattern::palmer);
  const double g = s.shaft_angle.value, t = s.mirror_tilt.value;
  for (double a = 0; a < 6.2; a += 0.3) {
    // Independent: the normal from the shaft by rotation about it, the reflection as a Householder matrix.
    const Eigen::Vector3d shaft(-std::sin(g), 0, std::cos(g));
    const Eigen::Vector3d tilted = Eigen::AngleAxisd(t, -Eigen::Vector3d::UnitY()) * shaft;  // towards ( cos g, 0, sin g )
    const Eigen::Vector3d toward = (tilted - shaft * tilted.dot(shaft)).normalized();
    const double sense = toward.dot(Eigen::Vector3d(std::cos(g), 0, std::sin(g)));
    const Eigen::Vector3d n = Eigen::AngleAxisd(a + (sense > 0 ? 0 : core::pi), shaft) * tilted;
    const Eigen::Matrix3d mirror = Eigen::Matrix3d::Identity() - 2 * n * n.transpose();
    const Eigen::Vector3d incident(std::sin(2 * g), 0, -std::cos(2 * g));
    EXPECT_LT((beam_of(s, a, 0) - mirror * incident).norm(), 1e-12) << a;
  }
  ScannerOptions untilted = s;
  untilted.mirror_tilt = core::Radians(0.0);
  EXPECT_LT((beam_of(untilted, 1.0, 0) - Eigen::Vector3d::UnitZ()).norm(), tight);
}

TEST(Scan, ConicalKeepsItsAngleAndStartsForward) {
  const ScannerOptions s = scanner(Pattern::conical);
  for (double a = 0; a < 6; a += 0.5) EXPECT_NEAR(beam_of(s, a, 0).z(), std::cos(s.half_angle.value), tight);
  EXPECT_GT(beam_of(s, 0, 0).x(), 0.3);
  EXPECT_GT(beam_of(s, core::pi / 2, 0).y(), 0.3);
}

TEST(Scan, EdgesMarkEachTurnOnce) {
  for (const auto& [p, per_scan] : {std::pair{Pattern::triangle, 2}, {Pattern::sine, 2}, {Pattern::polygon, 1}}) {
    const ScannerOptions s = scanner(p);
    int edges = 0;
    const int pulses = static_cast<int>(s.prf.value);
    for (int k = 0; k < pulses; ++k) edges += scan_at(s, (k + 0.37) / s.prf.value).edge;
    EXPECT_NEAR(edges, per_scan * s.frequency.value, 1);
  }
}

}  // namespace
}  // namespace swath::simulate
