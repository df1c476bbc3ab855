// SPDX-License-Identifier: GPL-3.0-or-later
// Surveyed points on the ground beside the returns around them.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "calib/ties/control.h"
#include "core/block.h"

namespace swath::calib {

struct CheckPoint {
  std::string name;
  Eigen::Vector3d map;  ///< easting, northing, height, map metres
  double sigma = 0.0;   ///< of the height, m
  double radius = 0.0;  ///< within which returns count, m; 0: that of all
};

/// What of use `check` can be compared with the returns: points as they are, planes at the middle of their corners, with the returns that
/// surely lie on them. A wall has no height and is left out. `map`: local frame to map metres.
std::vector<CheckPoint> check_points_of(const std::vector<SurveyedTarget>& targets,
                                        const std::function<Eigen::Vector3d(const Eigen::Vector3d&)>& map);

struct CheckResidual {
  std::string name;
  std::uint64_t returns = 0;
  double difference =
      0.0;             ///< height of the returns' plane at the point minus the point's, m; NaN with too few returns, or none about a plane
  double sigma = 0.0;  ///< of the point and of the plane's height by the returns' scatter, m
  double roughness = 0.0;  ///< rms of the returns about their plane, m
};

/// Collects single returns within `radius` (m) of each point (or its own), over all lines and batches, and fits a plane to them.
class CheckPoints {
 public:
  CheckPoints(std::vector<CheckPoint> points, double radius) : points_(std::move(points)), radius_(radius), moments_(points_.size()) {}
  /// Coordinates in map metres.
  void add(const core::Block& block);
  std::vector<CheckResidual> residuals() const;

 private:
  struct Moments {
    double n = 0;
    Eigen::Matrix<double, 4, 4> sum = Eigen::Matrix<double, 4, 4>::Zero();  ///< of (1, x, y, z) products, from the point, m
  };
  double radius_of(size_t point) const { return points_[point].radius > 0.0 ? points_[point].radius : radius_; }

  std::vector<CheckPoint> points_;
  double radius_;
  std::vector<Moments> moments_;
};

}  // namespace swath::calib
