// SPDX-License-Identifier: GPL-3.0-or-later
// Source: Jubanski et al.: Z lever = (Z_roof - Z_CP) + c + antenna offset, here as the vertical part of a vector in body axes. The paper
// takes the aircraft for level; here roll, pitch and heading in the hangar have a value and a sigma (a quarter of a degree is 4 mm on 0.9
// m).
#include "calib/hangar/hangar_lever_arm.h"

#include <Eigen/Geometry>
#include <cmath>

namespace swath::calib {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

Eigen::Index index_of(size_t i) { return static_cast<Eigen::Index>(i); }

/// x, y, z up of the hangar to north, east, down.
Matrix3d ned_R_hangar() {
  Matrix3d m;
  m << 0, 1, 0, 1, 0, 0, 0, 0, -1;
  return m;
}

}  // namespace

BodyAxes stated_axes(const core::Attitude& attitude, const Vector3d& sigma, size_t points) {
  return {attitude, sigma, Eigen::RowVectorXd::Zero(index_of(3 * points))};
}

BodyAxes axes_of_marks(const HangarPoints& points, const std::vector<size_t>& aft, const std::vector<size_t>& fore, double offset,
                       const core::Attitude& level, const Vector3d& sigma) {
  BodyAxes out = stated_axes(level, sigma, points.position.size());
  Vector3d along = Vector3d::Zero();
  for (const size_t f : fore) along += points.position[f] / static_cast<double>(fore.size());
  for (const size_t a : aft) along -= points.position[a] / static_cast<double>(aft.size());
  out.attitude.heading = core::wrap_two_pi(std::atan2(along.x(), along.y()) + offset);
  const double squared = along.head<2>().squaredNorm();
  const Eigen::RowVector3d by_along(along.y() / squared, -along.x() / squared, 0);
  for (const size_t f : fore) out.heading_by_points.segment<3>(index_of(3 * f)) += by_along / static_cast<double>(fore.size());
  for (const size_t a : aft) out.heading_by_points.segment<3>(index_of(3 * a)) -= by_along / static_cast<double>(aft.size());
  return out;
}

BodyVector body_vector(const HangarPoints& points, const BodyPoint& from, const BodyPoint& to, const BodyAxes& axes) {
  const Matrix3d body_R_ned = core::matrix_of(axes.attitude).transpose();
  const Matrix3d body_R_hangar = body_R_ned * ned_R_hangar();
  const Vector3d ned = ned_R_hangar() * (points.position[to.mark] - points.position[from.mark]);
  const Vector3d turned = body_R_ned * ned;
  const Matrix3d Rx = Eigen::AngleAxisd(axes.attitude.roll, Vector3d::UnitX()).matrix();

  BodyVector out;
  out.value = turned + to.offset - from.offset;
  out.by_angles.col(0) = -Vector3d::UnitX().cross(turned);
  out.by_angles.col(1) = -Rx.transpose() * Vector3d::UnitY().cross(Vector3d(Rx * turned));
  out.by_angles.col(2) = -body_R_ned * Vector3d::UnitZ().cross(ned);
  out.by_points = out.by_angles.col(2) * axes.heading_by_points;
  out.by_points.middleCols<3>(index_of(3 * to.mark)) += body_R_hangar;
  out.by_points.middleCols<3>(index_of(3 * from.mark)) -= body_R_hangar;
  const double offsets = to.offset_sigma * to.offset_sigma + from.offset_sigma * from.offset_sigma;
  out.covariance = out.by_points * points.covariance * out.by_points.transpose() +
                   out.by_angles * axes.sigma.cwiseAbs2().asDiagonal() * out.by_angles.transpose() + offsets * Matrix3d::Identity();
  return out;
}

}  // namespace swath::calib
