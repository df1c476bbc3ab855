// SPDX-License-Identifier: GPL-3.0-or-later
// What the corrected sensor data (CSD) of the ALTM mean in our terms, against the approximate positioning of a return in the CSD reader of
// PDAL (readers.optech), whose test states the position of a file's first return.
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <random>

#include "core/geo/frames.h"
#include "core/geo/geodesy.h"
#include "core/records/sensor.h"
#include "georef/shot_geometry.h"
#include "io/records/csd.h"
#include "tests/calib/survey_support.h"
#include "tests/world/support.h"

namespace swath::test {}
namespace swath::georef {
namespace test {
using namespace swath::calib::test;
using namespace swath::test;
}  // namespace test
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;
using test::deg;

/// One return of a CSD record, in the file's units (rad, m). `longitude` may lie below -2 pi.
struct CsdReturn {
  double range = 0.0, scan_angle = 0.0;
  double roll = 0.0, pitch = 0.0, heading = 0.0;
  double latitude = 0.0, longitude = 0.0, height = 0.0;  ///< of the scanner, WGS84
};

/// The file header's angles, in its order: roll, pitch, heading; rad.
struct CsdAlignment {
  core::Attitude misalignment, imu_offsets;
};

// R3(heading) R1(-pitch) R2(-roll), rotations of the axes (not of the vector).
Matrix3d csd_matrix(const core::Attitude& a) {
  const double sr = std::sin(a.roll), cr = std::cos(a.roll);
  const double sp = std::sin(a.pitch), cp = std::cos(a.pitch);
  const double sh = std::sin(a.heading), ch = std::cos(a.heading);
  Matrix3d R3, R1, R2;
  R3 << ch, sh, 0.0, -sh, ch, 0.0, 0.0, 0.0, 1.0;
  R1 << 1.0, 0.0, 0.0, 0.0, cp, -sp, 0.0, sp, cp;
  R2 << cr, 0.0, sr, 0.0, 1.0, 0.0, -sr, 0.0, cr;
  return R3 * R1 * R2;
}

core::Attitude sum(const core::Attitude& a, const core::Attitude& b) { return {a.roll + b.roll, a.pitch + b.pitch, a.heading + b.heading}; }

/// East, north, up from the scanner to the point, m. The file's frames are x right, y forward, z up:
///   M(heading, pitch, roll) M(alignment) range (sin a, 0, -cos a),  M = R3(heading) R1(-pitch) R2(-roll),
/// the alignment being the sum, angle by angle, of misalignment and IMU offsets.
Vector3d csd_local_vector(const CsdReturn& r, const CsdAlignment& alignment) {
  const Vector3d beam(std::sin(r.scan_angle), 0.0, -std::cos(r.scan_angle));
  return csd_matrix({r.roll, r.pitch, r.heading}) * csd_matrix(sum(alignment.misalignment, alignment.imu_offsets)) * (r.range * beam);
}

/// The point by the local linearisation that the format's readers use:
///   longitude + east / (N cos latitude), latitude + north / M, height + up
/// with the radii of curvature N, M of WGS84 at the scanner and without its height. Against the rigorous chain it is wrong by
/// (height above the ellipsoid / Earth's radius) of the horizontal vector and by its square / (2 radii) in height: 1.4 cm and 4 mm for
/// 230 m across at 1100 m. Longitude in (-pi, pi].
core::Geodetic csd_point(const CsdReturn& r, const CsdAlignment& alignment) {
  const Vector3d enu = csd_local_vector(r, alignment);
  core::Geodetic g;
  g.longitude = core::wrap_pi(r.longitude + enu.x() / (core::prime_vertical_radius(r.latitude) * std::cos(r.latitude)));
  g.latitude = r.latitude + enu.y() / core::meridian_radius(r.latitude);
  g.height = r.height + enu.z();
  return g;
}

core::Calibration our_calibration(const CsdAlignment& a) {
  io::CsdHeader h;
  h.misalignment = {a.misalignment.roll, a.misalignment.pitch, a.misalignment.heading};
  h.imu_offset = {a.imu_offsets.roll, a.imu_offsets.pitch, a.imu_offsets.heading};
  return io::calibration_of(h);
}

template <class T>
T at(const std::string& bytes, size_t offset) {
  T v;
  std::memcpy(&v, bytes.data() + offset, sizeof v);
  return v;
}

// East, north, up of our own chain.
Vector3d our_vector(const CsdReturn& r, const CsdAlignment& alignment) {
  const trajectory::Pose pose =
      test::pose_of({r.latitude, r.longitude, r.height}, {r.roll, r.pitch, r.heading}, Vector3d::Zero(), Vector3d::Zero());
  const ShotGeometry g(test::scanner_of(core::ScannerModel::mirror, false), our_calibration(alignment));
  const Vector3d ned = ecef_R_ned_at(pose).transpose() * (g.ecef_point(pose, {r.scan_angle, 0.0, r.range}) - pose.position);
  return {ned.y(), ned.x(), -ned.z()};
}

TEST(Optech, CalibrationOfCsdIsExact) {
  std::mt19937_64 random(3);
  std::uniform_real_distribution<double> unit(-1.0, 1.0);
  for (int i = 0; i < 200; ++i) {
    const CsdReturn r{1000.0 + 900.0 * unit(random),
                      0.6 * unit(random),
                      0.4 * unit(random),
                      0.4 * unit(random),
                      3.1 * unit(random),
                      1.5 * unit(random),
                      3.0 * unit(random),
                      1500.0};
    const CsdAlignment a{{0.3 * unit(random), 0.3 * unit(random), 0.3 * unit(random)},
                         {0.1 * unit(random), 0.1 * unit(random), 0.1 * unit(random)}};
    EXPECT_LT((our_vector(r, a) - csd_local_vector(r, a)).norm(), 5e-9);  // rounding of earth-centred coordinates
  }
}

TEST(Optech, FirstReturnOfTheSampleFile) {
  SWATH_SHARED_OR_SKIP(folder, "data/optech_csd");
  const std::string bytes = swath::test::read_bytes(folder / "sample.csd");
  constexpr size_t header = 2048, angles = 1154, record = 69;
  ASSERT_EQ(bytes.size(), header + 1000 * record);
  const auto angle = [&](size_t i) { return at<double>(bytes, angles + 8 * i); };
  const CsdAlignment alignment{{angle(0), angle(1), angle(2)}, {angle(3), angle(4), angle(5)}};
  const auto f = [&](size_t offset) { return static_cast<double>(at<float>(bytes, header + offset)); };
  const CsdReturn r{f(9), f(33), f(37), f(41), f(45), at<double>(bytes, header + 49), at<double>(bytes, header + 57), f(65)};
  EXPECT_NEAR(r.range, 827.3567, 1e-4);
  EXPECT_NEAR(r.scan_angle / deg, -14.555, 1e-3);

  const core::Geodetic g = csd_point(r, alignment);
  EXPECT_NEAR(g.longitude / deg, -82.554028877408555, 1e-9);
  EXPECT_NEAR(g.latitude / deg, 36.534611447321907, 1e-9);
  EXPECT_NEAR(g.height, 344.80889224602356, 1e-4);

  // The rigorous chain: what the linearisation leaves out.
  const trajectory::Pose pose =
      test::pose_of({r.latitude, r.longitude, r.height}, {r.roll, r.pitch, r.heading}, Vector3d::Zero(), Vector3d::Zero());
  const ShotGeometry ours(test::scanner_of(core::ScannerModel::mirror, false), our_calibration(alignment));
  const core::Geodetic rigorous = core::geodetic_of(ours.ecef_point(pose, {r.scan_angle, 0.0, r.range}));
  const double north = (g.latitude - rigorous.latitude) * core::meridian_radius(g.latitude);
  const double east = (g.longitude - rigorous.longitude) * core::prime_vertical_radius(g.latitude) * std::cos(g.latitude);
  EXPECT_NEAR(std::hypot(north, east), 0.014, 0.001);
  EXPECT_NEAR(std::abs(g.height - rigorous.height), 0.004, 0.0006);
  RecordProperty("horizontal_mm", std::to_string(1e3 * std::hypot(north, east)));
  RecordProperty("vertical_mm", std::to_string(1e3 * (g.height - rigorous.height)));
}

}  // namespace
}  // namespace swath::georef
