// SPDX-License-Identifier: GPL-3.0-or-later
// Source: the CSD reader of PDAL (pdal.io, readers.optech), whose test states the position of a file's first return; the frames are
// inferred from it and meet that position to 1e-9 deg. Deviation: none from that reader; its own error is stated in the header.
#include "georef/optech.h"

#include <cmath>

namespace swath::georef {

using Eigen::Matrix3d;
using Eigen::Vector3d;

namespace {

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

}  // namespace

Vector3d csd_local_vector(const CsdReturn& r, const CsdAlignment& alignment) {
  const Vector3d beam(std::sin(r.scan_angle), 0.0, -std::cos(r.scan_angle));
  return csd_matrix({r.roll, r.pitch, r.heading}) * csd_matrix(sum(alignment.misalignment, alignment.imu_offsets)) * (r.range * beam);
}

core::Geodetic csd_point(const CsdReturn& r, const CsdAlignment& alignment) {
  const Vector3d enu = csd_local_vector(r, alignment);
  core::Geodetic g;
  g.longitude = core::wrap_pi(r.longitude + enu.x() / (core::prime_vertical_radius(r.latitude) * std::cos(r.latitude)));
  g.latitude = r.latitude + enu.y() / core::meridian_radius(r.latitude);
  g.height = r.height + enu.z();
  return g;
}

core::Calibration calibration_of_csd(const core::Attitude& misalignment, const core::Attitude& imu_offsets) {
  const core::Attitude a = sum(misalignment, imu_offsets);
  core::Calibration c;
  c.roll = core::Radians(a.roll);
  c.pitch = core::Radians(a.pitch);
  c.heading = core::Radians(a.heading);
  return c;
}

}  // namespace swath::georef
