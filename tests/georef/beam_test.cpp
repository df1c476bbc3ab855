// SPDX-License-Identifier: GPL-3.0-or-later
#include "georef/beam.h"

#include <gtest/gtest.h>

#include <cmath>
#include <string>

namespace swath::georef {
namespace {

using core::ScannerModel;
using Eigen::Vector3d;
constexpr double deg = core::degree;

core::Scanner scanner(ScannerModel m) {
  core::Scanner s;
  s.model = m;
  return s;
}

constexpr ScannerModel models[] = {ScannerModel::mirror, ScannerModel::polygon, ScannerModel::profile,
                                   ScannerModel::beam,   ScannerModel::conical, ScannerModel::palmer};

TEST(Beam, IsAUnitVectorAndItsDerivativeIsTheDifference) {
  constexpr double h = 1e-6;
  for (const ScannerModel m : models) {
    const BeamModel beam(scanner(m));
    for (const double a : {0.0, 1e-7, -0.3, 0.6, 1.4, 3.0, -2.9})
      for (const double forward : {0.0, 0.2, -0.5}) {
        const Beam b = beam(a, forward);
        EXPECT_NEAR(b.direction.norm(), 1.0, 1e-15);
        const Vector3d difference = (beam(a + h, forward).direction - beam(a - h, forward).direction) / (2.0 * h);
        EXPECT_LT((b.by_angle - difference).norm(), 1e-9) << static_cast<int>(m) << " at " << a;
      }
  }
}

TEST(Beam, AcrossScannerLooksToStarboardAtPositiveAngles) {
  for (const ScannerModel m : {ScannerModel::mirror, ScannerModel::polygon, ScannerModel::beam}) {
    const Vector3d r = BeamModel(scanner(m))(30.0 * deg, 0.0).direction;
    EXPECT_LT((r - Vector3d(0.0, 0.5, std::sqrt(0.75))).norm(), 1e-15);
  }
  const Vector3d r = BeamModel(scanner(ScannerModel::beam))(0.0, 0.6).direction;
  EXPECT_LT((r - Vector3d(0.6, 0.0, 0.8)).norm(), 1e-15);
}

TEST(Beam, ConeKeepsItsAngle) {
  core::Scanner s = scanner(ScannerModel::conical);
  s.cone_angle = core::degrees(15.0);
  for (double a = -4.0; a < 4.0; a += 0.1) EXPECT_NEAR(std::acos(BeamModel(s)(a, 0.0).direction.z()), 15.0 * deg, 1e-14);
  EXPECT_NEAR(BeamModel(s)(0.0, 0.0).direction.x(), std::sin(15.0 * deg), 1e-15);
  EXPECT_NEAR(BeamModel(s)(90.0 * deg, 0.0).direction.y(), std::sin(15.0 * deg), 1e-15);
}

TEST(Beam, PalmerReflectsAndMakesAnEllipse) {
  core::Scanner s = scanner(ScannerModel::palmer);
  s.shaft_angle = core::degrees(45.0);
  s.mirror_tilt = core::degrees(7.0);
  const BeamModel beam(s);
  // In the plane of the shaft the beam turns by twice the tilt: forward at 0, aft at 180 deg, exactly.
  EXPECT_NEAR(std::atan2(beam(0.0, 0.0).direction.x(), beam(0.0, 0.0).direction.z()), 14.0 * deg, 1e-14);
  EXPECT_NEAR(std::atan2(beam(core::pi, 0.0).direction.x(), beam(core::pi, 0.0).direction.z()), -14.0 * deg, 1e-14);
  // Across the angle is about 2 t cos g.
  const Vector3d across = beam(90.0 * deg, 0.0).direction;
  EXPECT_NEAR(std::atan2(across.y(), across.z()), 14.0 * deg * std::cos(45.0 * deg), 0.2 * deg);
  EXPECT_NEAR(beam(90.0 * deg, 0.0).direction.y(), -beam(-90.0 * deg, 0.0).direction.y(), 1e-15);
  // A mirror square to its shaft sends the beam to the nadir, whatever the shaft's angle.
  s.mirror_tilt = core::Radians(0.0);
  s.shaft_angle = core::degrees(38.0);
  for (double a = 0.0; a < 6.0; a += 0.7) EXPECT_LT((BeamModel(s)(a, 0.0).direction - Vector3d::UnitZ()).norm(), 1e-15);
}

TEST(Beam, OnlyTheProfileIgnoresTheRecord) {
  for (const ScannerModel m : models) EXPECT_EQ(BeamModel(scanner(m)).ignores_record(), m == ScannerModel::profile);
}

}  // namespace
}  // namespace swath::georef
