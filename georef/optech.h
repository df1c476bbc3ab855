// SPDX-License-Identifier: GPL-3.0-or-later
// What the corrected sensor data (CSD) of Optech's ALTM mean in our terms, and the maker's own approximate positioning of a return.
#pragma once

#include <Eigen/Core>

#include "core/geo/frames.h"
#include "core/geo/geodesy.h"
#include "core/records/sensor.h"

namespace swath::georef {

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

/// East, north, up from the scanner to the point, m. The file's frames are x right, y forward, z up:
///   M(heading, pitch, roll) M(alignment) range (sin a, 0, -cos a),  M = R3(heading) R1(-pitch) R2(-roll),
/// the alignment being the sum, angle by angle, of misalignment and IMU offsets.
Eigen::Vector3d csd_local_vector(const CsdReturn& r, const CsdAlignment& alignment);

/// The point by the local linearisation that the format's readers use:
///   longitude + east / (N cos latitude), latitude + north / M, height + up
/// with the radii of curvature N, M of WGS84 at the scanner and without its height. Against the rigorous chain it is wrong by
/// (height above the ellipsoid / Earth's radius) of the horizontal vector and by its square / (2 radii) in height: 1.4 cm and 4 mm for
/// 230 m across at 1100 m. Longitude in (-pi, pi]. For proving a reader; work with calibration_of_csd.
core::Geodetic csd_point(const CsdReturn& r, const CsdAlignment& alignment);

/// The boresight that gives exactly the same vector in our frames (body x forward, y right, z down): M differs from
/// Rz(heading) Ry(pitch) Rx(roll) only by the exchange of axes, so that the angles are the sums, unchanged. The lever arm is zero: CSD
/// positions are those of the scanner.
core::Calibration calibration_of_csd(const core::Attitude& misalignment, const core::Attitude& imu_offsets);

}  // namespace swath::georef
