// SPDX-License-Identifier: GPL-3.0-or-later
// Lever arms by a hangar survey: stations from distances, points from angles and distances, vectors in body axes.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

#include "calib/hangar/combined_point.h"
#include "calib/hangar/hangar_lever_arm.h"
#include "calib/hangar/resection.h"
#include "io/survey/hangar_file.h"

namespace swath::calib {

/// A station as used further on.
struct StationResult {
  std::string name;
  bool stated = false;  ///< its coordinates were given
  Resection resection;  ///< of those found from distances
  std::vector<std::string> targets;
  std::vector<std::string> places;                       ///< of its distances, "file:line"
  Eigen::Vector3d position = Eigen::Vector3d::Zero();    ///< m
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();  ///< m^2, the factor below in it
  double factor = 1.0;                                   ///< on the covariance, where the distances scatter more than stated
};

struct PointResult {
  std::string name;
  io::HangarRole role = io::HangarRole::mark;
  bool stated = false;
  PointSearch search;
  Eigen::Vector3d position = Eigen::Vector3d::Zero();
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
};

/// An observation at a point of the aircraft, with what the adjustment made of it.
struct SightResult {
  std::string text;                       ///< "angle at S1 from S3 to CP"
  std::string place;                      ///< "file:line"
  double observed = 0.0, residual = 0.0;  ///< rad or m; residual = adjusted - observed
  double sigma = 0.0;
  double w = 0.0;
};

/// A lever arm that survey.toml knows, or the way between two points.
struct LeverArm {
  io::HangarRole from, to;
  Eigen::Vector3d value = Eigen::Vector3d::Zero();       ///< body: forward, right, down, m
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();  ///< m^2
  double sigma() const;                                  ///< that of the least known component, m
};

struct HangarResult {
  std::vector<StationResult> stations;
  std::vector<PointResult> points;
  std::vector<SightResult> sights;
  std::optional<CombinedPoints> adjusted;  ///< of the points that were sighted
  double point_factor = 1.0;               ///< on its covariance, where the sights scatter more than stated
  BodyAxes axes;
  double heading_sigma = 0.0;  ///< rad, the marks' errors in it
  std::vector<LeverArm> lever_arms;
  std::vector<std::string> warnings;  ///< in words
};

/// The whole way. `hold_stations`: takes the stations as free of error, for comparison (its sigmas are far too small). Throws core::Error
/// where a station, a point or the heading is not determined, with what is missing.
HangarResult solve_hangar(const io::HangarSurvey& hangar, bool hold_stations);

/// Does a variance factor speak against the stated sigmas, at one in a thousand of chi-square?
bool scatter_too_large(double variance_factor, int redundancy);

/// The lines for survey.toml.
std::string survey_lines(const HangarResult& result);

}  // namespace swath::calib
