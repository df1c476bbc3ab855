// SPDX-License-Identifier: GPL-3.0-or-later
#include "calib/block/block_frame.h"

#include <Eigen/Geometry>

#include "core/geo/geodesy.h"
#include "core/geo/map_axes.h"

namespace swath::calib {

using Eigen::Matrix3d;
using Eigen::Vector3d;

Matrix3d ecef_R_enu(const Vector3d& ecef) {
  const core::Geodetic g = core::geodetic_of(ecef);
  const Matrix3d ned = core::ecef_R_ned(g.latitude, g.longitude);
  Matrix3d out;
  out << ned.col(1), ned.col(0), -ned.col(2);
  return out;
}

BlockFrame::BlockFrame(const std::string& crs, const Vector3d& middle) : middle_(middle) {
  if (crs == "local") {
    middle_.setZero();
    return;
  }
  const core::Crs map(crs);
  core::require_easting_northing(map, "crs");  // angles count from the grid's north
  to_ecef_ = std::make_shared<core::Transform>(map, core::wgs84_ecef());
  from_ecef_ = std::make_shared<core::Transform>(core::wgs84_ecef(), map);
  origin_ = (*to_ecef_)(middle);
  ecef_R_local_ = ecef_R_enu(origin_);
}

Vector3d BlockFrame::local_of(const Vector3d& map) const {
  if (is_local()) return map;
  return ecef_R_local_.transpose() * ((*to_ecef_)(map)-origin_);
}

Vector3d BlockFrame::map_of(const Vector3d& local) const {
  if (is_local()) return local;
  return (*from_ecef_)(ecef_of(local));
}

Matrix3d BlockFrame::local_R_true(const Vector3d& local) const {
  if (is_local()) return Matrix3d::Identity();
  return ecef_R_local_.transpose() * ecef_R_enu(ecef_of(local));
}

Matrix3d BlockFrame::local_R_grid(const Vector3d& local) const {
  if (is_local()) return Matrix3d::Identity();
  constexpr double step = 10.0;  // m: the grid's north over it is straight to 1e-6 rad
  const Matrix3d enu = local_R_true(local);
  // Where the grid is a step of true north away, against where it is here: grid north is turned back by that angle.
  const Vector3d here = map_of(local), there = map_of(local + step * enu.col(1));
  const Vector3d way = there - here;
  const double turn = std::atan2(way.x(), way.y());  // of true north on the grid, clockwise
  return enu * Eigen::AngleAxisd(turn, Vector3d::UnitZ()).toRotationMatrix();
}

}  // namespace swath::calib
