// SPDX-License-Identifier: GPL-3.0-or-later
// Straight pieces of flight lines, and how near they come to places.
#pragma once

#include <Eigen/Core>
#include <limits>
#include <optional>
#include <utility>
#include <vector>

namespace swath::calib {

/// A straight piece of a flight line.
struct Pass {
  int line = 0;
  size_t recorded = 0;                 ///< number of its whole_lines()
  double first = 0.0, last = 0.0;      ///< time as recorded, s
  double rate = 0.0;                   ///< records per second
  double speed = 0.0;                  ///< m/s
  double course = 0.0;                 ///< over ground from local north, rad
  std::vector<double> time;            ///< of the track's points, as recorded, s
  std::vector<Eigen::Vector2d> track;  ///< local east, north, m
};

/// A pass in axes along and across its course, in which it is thin: what lies far from it is seen at once. The pass must outlive it.
class CourseBox {
 public:
  explicit CourseBox(const Pass& pass);
  /// The nearest point of the track, where one lies nearer than `reach`: distance, m, and time, s.
  std::optional<std::pair<double, double>> nearest(const Eigen::Vector2d& place, double reach) const;

 private:
  double across_of(const Eigen::Vector2d& v) const { return v.x() * ahead_.y() - v.y() * ahead_.x(); }
  const Pass& pass_;
  Eigen::Vector2d ahead_;
  std::vector<double> along_;  // m, ascending
  double left_ = std::numeric_limits<double>::infinity(), right_ = -left_;
};

}  // namespace swath::calib
