// SPDX-License-Identifier: GPL-3.0-or-later
// Points from horizontal angles, vertical angles and distances measured at stations, by the combined (Gauss-Helmert) adjustment.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <limits>
#include <optional>
#include <vector>

namespace swath::calib {

/// The angle at one station between the sights to another station and to a point, in the horizontal plane.
struct HorizontalAngle {
  size_t at, to_station, point;
  double angle, sigma;  ///< rad, 0 < angle < pi
};
/// Elevation of a point above the horizon of a station.
struct VerticalAngle {
  size_t at, point;
  double angle, sigma;  ///< rad, within +-pi/2, positive upwards
};
struct PointDistance {
  size_t at, point;
  double distance, sigma;  ///< m, slant
};

/// All sights at the points of a hangar. Each of its observations is met once, in however many conditions it takes part.
struct PointNetwork {
  size_t points = 0;
  std::vector<Eigen::Vector3d> stations;  ///< x, y level, z up, m
  Eigen::MatrixXd station_covariance;     ///< 3 per station, m^2; empty: the stations are held, which makes sigmas far too small
  std::vector<HorizontalAngle> angles;
  std::vector<VerticalAngle> verticals;
  std::vector<PointDistance> distances;
  /// Each vertical angle makes a condition for the height by its tangent too. Without it only its cosine counts, as in the paper: the sign
  /// is lost, and a point at the height of the instrument has hardly a height.
  bool signed_elevations = false;
};

/// One condition between a point and its observations. `from_a`: the point's distance from station A is that which the triangle A, B, point
/// gives; `from_b`: the same from B; `measured`: it is that which was measured; `height`: the point is as high over A as the vertical angle
/// says.
struct PointCondition {
  enum class Kind { from_a, from_b, measured, height } kind;
  size_t point;
  size_t a, b;         ///< stations; b only with angles
  size_t alpha, beta;  ///< indices of the angles at a (to b) and at b (to a)
  size_t other;        ///< of the vertical angle, or of the distance
};
/// Pairs of stations with both angles and a vertical angle make a condition for each such vertical angle; every distance makes one, and
/// every vertical angle where elevations are signed.
std::vector<PointCondition> conditions_of(const PointNetwork& network);

/// Observations in one column: angles, vertical angles, distances, then the stations' coordinates where they have a covariance.
Eigen::VectorXd observations_of(const PointNetwork& network);

/// Misclosures of the conditions (m) with their derivatives by the points' coordinates and by the observations.
struct Misclosures {
  Eigen::VectorXd value;
  Eigen::MatrixXd by_points, by_observations;
};
Misclosures misclosures(const PointNetwork& network, const std::vector<PointCondition>& conditions, const Eigen::VectorXd& points,
                        const Eigen::VectorXd& observations);

struct CombinedPoints {
  bool solved = false;                                                ///< false: singular, or no convergence
  Eigen::VectorXd points;                                             ///< 3 per point, m
  Eigen::MatrixXd covariance;                                         ///< by the stated sigmas, m^2
  double squares = std::numeric_limits<double>::infinity();           ///< v' P v
  double variance_factor = std::numeric_limits<double>::quiet_NaN();  ///< sigma0^2; NaN without redundancy
  int redundancy = 0;                                                 ///< conditions less unknowns
  int iterations = 0;
  Eigen::VectorXd residual;  ///< adjusted - observed, in the order of observations_of()
  Eigen::VectorXd w;         ///< residuals by their own sigma (Baarda); 0 where nothing checks the observation
};
/// Combined adjustment from start values, 3 per point (Jubanski et al., eq 4-8 and 10).
CombinedPoints adjust_points(const PointNetwork& network, const Eigen::VectorXd& start);

enum class PointState {
  solved,
  too_few,         ///< fewer than three conditions
  not_determined,  ///< fewer than three stations see it, or they stand in one line
  weak,            ///< its height (or another direction) is hardly determined, and no sigma of it is true
  two_fit,         ///< the point and its mirror image fit equally well, and nothing says which
  not_found,       ///< the adjustment does not converge
};
/// How one point was found before all were adjusted together.
struct PointSearch {
  PointState state = PointState::not_found;
  Eigen::Vector3d position = Eigen::Vector3d::Zero();
  double variance_factor = 0.0;           ///< of the point by itself: its sum of squares over its redundancy (1 where that is 0)
  std::optional<Eigen::Vector3d> mirror;  ///< where the mirrored start leads
  double mirror_variance_factor = 0.0;
  bool start_led_to_mirror = false;    ///< from the stated start value alone the mirror would have been found
  bool decided_by_elevation = false;   ///< both fit equally well but for the signs of the vertical angles
  bool decided_by_start = false;       ///< both fit equally well; the one nearer to the stated start was taken
  bool elevations_contradict = false;  ///< the signs of the vertical angles fit the mirror: they may count positive downwards
};

struct FoundPoints {
  std::vector<PointSearch> searches;
  CombinedPoints adjusted;  ///< of all points together; solved only where every search is
};
/// Finds start values on both sides of the stations' plane, adjusts from each, takes the better, then adjusts all points together.
/// cos(vertical angle) hides the sign of the angle, so that the adjustment itself does not know above from below.
/// `starts`: one per point, or none.
FoundPoints find_points(const PointNetwork& network, const std::vector<std::optional<Eigen::Vector3d>>& starts);

}  // namespace swath::calib
