// SPDX-License-Identifier: GPL-3.0-or-later
// How an error of the scanner's mounting displaces a target, and the error from displacements seen in opposite flights (Brandalize, eq 5 to
// 11). Axes: x forward, y right, z down, from the scanner; m and rad.
//
// Names: `displacement` is the rotation that the points have suffered, computed = displacement * true; the mounting's error is its inverse
// (mounting = -displacement to first order). Displacements of a target are computed minus surveyed coordinates along the axes of each
// flight; the mean over two opposite flights is free of an offset of the positions.
//
// Where the formulas end (error of 0.1 mrad; target at nadir, 55 m to the side, 1200 m below):
//   one angle alone       84 mrad roll, 67 mrad pitch, 67 mrad heading (84 with the computed y')
//   all three of one size 50 mrad roll and pitch; heading 2.1 mrad with the surveyed y (5.2 with y = 436 m), 10 mrad with the computed y'
// The computed y' is where the sensor, with its roll error, sees the target: y' = y - z dr. Heading must therefore come last, with y'.
#pragma once

#include <Eigen/Core>
#include <string>

#include "core/geo/frames.h"

namespace swath::calib {

/// Eq 9 with its right sign: dp = (x' - x) / z, from profiles (scan angle 0).
double pitch_displacement(double along, double z);
/// Eq 10: dr = (y - y') / z, from a wall along the flight. `across` = y' - y.
double roll_displacement(double across, double z);
/// Eq 11: dh = ((x - x') + z dp) / y, from the swath's edge. `along` = x' - x; `y`: computed y' (better) or surveyed y.
double heading_displacement(double along, double z, double pitch, double y);

/// What opposite flights show of one target, means of both flights.
struct OpposedDisplacements {
  double along_nadir = 0.0;  ///< x' - x at scan angle 0, m
  double across = 0.0;       ///< y' - y of a wall under the flight, m
  double along_side = 0.0;   ///< x' - x at the swath's edge, m
  double z = 0.0;            ///< height of the scanner above the target, m
  double y = 0.0;            ///< of the target at the swath's edge, as surveyed, m
  double y_computed = 0.0;   ///< the same as computed with the mounting in force, m
};

enum class SideDistance { surveyed, computed };  ///< which y eq 11 divides by

/// Eq 9, 10, 11 in that order.
core::Attitude small_angle_displacement(const OpposedDisplacements& d, SideDistance side = SideDistance::computed);
/// What flights of exact geometry would show with this mounting error. z, y: surveyed.
OpposedDisplacements displacements_of(const core::Attitude& mounting_error, double z, double y);

/// -displacement: the mounting's error by the formulas.
core::Attitude mounting_of(const core::Attitude& displacement);
/// The inverse rotation.
core::Attitude inverse(const core::Attitude& a);

/// Error of eq 9 to 11 for a displacement of this size: formulas less exact geometry, rad.
core::Attitude small_angle_error(const core::Attitude& displacement, double z, double y, SideDistance side = SideDistance::computed);
/// Says so where the formulas are off by more than `most` for this displacement; empty where they do not.
std::string small_angle_warning(const core::Attitude& displacement, double z, double y, double most = 1e-4,
                                SideDistance side = SideDistance::computed);

}  // namespace swath::calib
