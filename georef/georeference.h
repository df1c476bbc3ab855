// SPDX-License-Identifier: GPL-3.0-or-later
// Raw returns of a flight line to map coordinates, with the standard deviations of each.
#pragma once

#include <Eigen/Core>
#include <cstdint>

#include "core/block.h"
#include "core/config/result.h"
#include "core/records/sensor.h"
#include "core/report.h"
#include "core/shot.h"
#include "georef/correlated_errors.h"
#include "georef/map_patch.h"
#include "georef/shot_geometry.h"
#include "trajectory/trajectory.h"

namespace swath::georef {

/// What became of the returns: their sum is the number of returns given.
struct Counts {
  std::uint64_t georeferenced = 0;
  core::LeftOut outside;            ///< time in no span of the trajectory (or not a number)
  core::FileTimes outside_times{};  ///< when those with a finite time were
  core::LeftOut no_range;           ///< range not a number, or not above zero (recorded or calibrated)
  core::LeftOut no_beam;            ///< scan angle not a number, or `forward` beyond +-1
  core::LeftOut no_map;             ///< no coordinates in the map's CRS

  Counts& operator+=(const Counts& o);
  bool operator==(const Counts&) const = default;
};

template <class V>
void describe(const Counts& r, V& v) {
  using core::if_any;
  v.result("outside the trajectory, left out", r.outside, if_any(), "Returns at times that the trajectory does not cover.");
  v.result("range not above zero, left out", r.no_range, if_any(), "Returns whose range is 0, negative or not a number.");
  v.result("no beam for the scan angle, left out", r.no_beam, if_any(), "Returns whose scan angle the scanner model does not allow.");
  v.result("no coordinates in the CRS, left out", r.no_map, if_any(), "Returns that the projection cannot map.");
}

/// Georeferences returns by the equation of georef/shot_geometry.h, positions to map by MapPatches (within 0.1 mm of PROJ).
/// The trajectory must outlive this object. All functions are const and safe from many threads; the result for a return depends on nothing
/// but that return.
class Georeferencer {
 public:
  /// `block_origin`: CRS units, subtracted from all coordinates. `with_sigma`: also fill sigma_h and sigma_v.
  Georeferencer(const core::Scanner& scanner, const core::Calibration& calibration, const core::SensorSigma& sigma,
                const trajectory::Trajectory& trajectory, const core::Crs& map, Eigen::Vector3d block_origin, bool with_sigma = true);

  /// Appends to `out` (empty, or of the same origin) every return that has a place; the others are counted. Order is kept. Columns filled:
  ///   x y z       CRS units, relative to the block origin
  ///   time        GPS time s, latency included
  ///   intensity return_number return_count flags record   as recorded (where `shots` has them)
  ///   scan_angle  rad, positive to starboard: the calibrated scanner angle a' (conical, palmer: the beam's angle across, atan2(y, z)). It
  ///   is counted
  ///               from the scanner's nadir; LAS 1.4 asks for the angle with the aircraft's roll, which differs by that roll.
  ///   range       m, calibrated and corrected for the air
  ///   incidence   rad, between the beam and the ellipsoid's normal at the ground (terrain.intensity takes the terrain's)
  ///   sigma_h     m, sqrt(var north + var east); sigma_v m: J S J^T with the trajectory's sigmas at that instant and SensorSigma, its
  ///               correlations and those of the trajectory with the calibration (core::CalibrationResponse)
  /// Throws core::Error where `out` holds points of another origin.
  Counts run(const core::Shots& shots, core::Block& out) const;

  const ShotGeometry& geometry() const { return geometry_; }
  const MapPatches& map() const { return map_; }
  const Eigen::Vector3d& origin() const { return origin_; }

 private:
  ShotGeometry geometry_;
  core::SensorSigma sigma_;
  CorrelatedErrors correlated_;
  const trajectory::Trajectory* trajectory_;
  MapPatches map_;
  Eigen::Vector3d origin_;
  bool with_sigma_;
};

}  // namespace swath::georef
