// SPDX-License-Identifier: GPL-3.0-or-later
// From a target's displacements in all lines to roll, pitch and heading, each by its own passes.
#pragma once

#include <Eigen/Core>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "calib/target/target_edges.h"
#include "core/records/sensor.h"

namespace swath::calib {

/// Where a line has the target in its swath.
enum class TargetRole {
  profile,  ///< a line without scan
  nadir,
  between,
  edge,  ///< of the swath
};
std::string_view name_of(TargetRole r);

/// Covariance of the trajectory's errors at n instants: 6n x 6n, per instant north, east, down (m), roll, pitch, heading (rad).
using TrajectoryCovariance = std::function<Eigen::MatrixXd(const std::vector<double>&)>;

/// What separates nadir from edge, as shares of the swath's half width.
struct RoleShares {
  double nadir = 0.35, edge = 0.5;
};

/// One line that sees the target. Body axes at the instant of the view: x forward, y right, z down.
struct LineMeasure {
  int line = 0;
  const TargetView* view = nullptr;
  TargetRole role = TargetRole::nadir;
  double heading = 0.0;                                        ///< of the body, rad
  Eigen::Vector3d target{0, 0, 0};                             ///< from scanner to the target's centre as surveyed, body, m
  Eigen::Vector3d delta{0, 0, 0};                              ///< displacement, computed minus surveyed, body, m
  Eigen::Matrix3d body_R_level = Eigen::Matrix3d::Identity();  ///< columns: along, across (flight axes), up
  Eigen::Matrix3d body_R_local = Eigen::Matrix3d::Identity();  ///< columns: east, north, up
  Jacobian by = Jacobian::Zero();                              ///< of the point in body
  Eigen::Vector3d sigma{0, 0, 0};  ///< of the displacement along, across, up: with trajectory, survey and what else is not estimated
};

/// All lines together: displacements with the covariance of all that disturbs them.
struct TargetMeasures {
  std::vector<LineMeasure> lines;
  Eigen::MatrixXd covariance;           ///< 3n x 3n, of the deltas: edges, plane, survey, trajectory
  Eigen::MatrixXd held;                 ///< 3n x k: effect of one sigma of each calibration value that no reading estimates
  double widest = 0.0;                  ///< tangent of the swath's half angle
  bool surveyed = true, across = true;  ///< the target is surveyed; the scanner scans across
};

TargetMeasures target_measures(const std::vector<std::pair<int, const TargetView*>>& views, const ShotGeometry& geometry,
                               const trajectory::Trajectory& trajectory, const TrajectoryCovariance& trajectory_covariance,
                               const RoofTarget& target, const core::SensorSigma& sigma, double widest, const RoleShares& shares);

/// One reading of an angle, or of the range: as an error of the calibration in force.
struct Reading {
  int first = 0, second = 0;  ///< lines (second: -1 for a single one)
  double value = 0.0, sigma = 0.0;
  Eigen::RowVectorXd by;  ///< of all deltas, 1 x 3n
};

/// Several readings of one quantity.
struct ReadingMean {
  std::vector<Reading> readings;
  bool determined = false;
  double value = 0.0;
  double own = 0.0;      ///< sigma by the readings' own covariance
  double scatter = 0.0;  ///< sigma of the mean by their scatter; 0 where there are too few
  double sigma = 0.0;    ///< own, or scatter where it is larger by more than chance
  Eigen::RowVectorXd by;
};

/// Error of the mounting by eq 9, 10 and 11, in that order: displacement angles of the scanner about the body's axes.
struct AngleReadings {
  ReadingMean pitch, roll, heading;
  ReadingMean range;  ///< error of the range offset, m; determined for a surveyed target only
};
AngleReadings read_angles(const TargetMeasures& m);

/// All at once, by least squares: what the passes show of each parameter when all are free. Errors of the calibration in force.
struct JointTarget {
  struct One {
    bool free = false;
    double value = 0.0, sigma = 0.0;
  };
  One roll, pitch, heading, range_offset, scan_scale, lever_forward, lever_right;
  Eigen::Vector3d datum = Eigen::Vector3d::Zero(), datum_sigma = Eigen::Vector3d::Zero();  ///< east, north, up common to all lines, m
  double lowest = 0.0, highest = 0.0;                                                      ///< flying heights above the target, m
  bool two_heights = false;  ///< heights differ by a fifth at least: lever arms are free
  double chi2 = 0.0;         ///< per degree of freedom
};
JointTarget solve_jointly(const TargetMeasures& m, const core::SensorSigma& sigma);

}  // namespace swath::calib
