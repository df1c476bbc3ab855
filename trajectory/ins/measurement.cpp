// SPDX-License-Identifier: GPL-3.0-or-later
#include "trajectory/ins/measurement.h"

#include "core/geo/frames.h"
#include "core/geo/geodesy.h"

namespace swath::trajectory {

using core::skew;
using Eigen::Matrix3d;
using Eigen::Vector3d;

Vector3d antenna_velocity(const Estimate& e, const Vector3d& rate) {
  const Vector3d earth(0, 0, core::wgs84::omega);
  return e.nav.velocity + e.nav.ecef_R_body * rate.cross(e.lever) - earth.cross(e.nav.ecef_R_body * e.lever);
}

Prediction<3> predict_fix(const Layout& l, const Estimate& e, const Vector3d& rate, const Matrix3d& spread) {
  Prediction<3> p;
  p.design.setZero(3, l.size);
  const Vector3d arm = e.nav.ecef_R_body * e.lever;
  const Vector3d moving = antenna_velocity(e, rate);
  p.value = e.nav.position + arm + spread * e.fix + e.latency * moving;
  p.design.block<3, 3>(0, l.position).setIdentity();
  p.design.block<3, 3>(0, l.attitude) = -skew(arm);
  if (l.lever >= 0) p.design.block<3, 3>(0, l.lever) = e.nav.ecef_R_body;
  if (l.fix >= 0) p.design.block<3, 3>(0, l.fix) = spread;
  if (l.latency >= 0) p.design.col(l.latency) = moving;
  return p;
}

Prediction<3> predict_velocity(const Layout& l, const Estimate& e, const Vector3d& rate) {
  Prediction<3> p;
  p.design.setZero(3, l.size);
  const Matrix3d& C = e.nav.ecef_R_body;
  p.value = antenna_velocity(e, rate);
  p.design.block<3, 3>(0, l.velocity).setIdentity();
  p.design.block<3, 3>(0, l.attitude) = -skew(C * rate.cross(e.lever));
  p.design.block<3, 3>(0, l.gyro_bias) = C * skew(e.lever);
  if (l.lever >= 0) p.design.block<3, 3>(0, l.lever) = C * skew(rate);
  return p;
}

Prediction<2> predict_wheels(const Layout& l, const Estimate& e, const Vector3d& rate, const Vector3d& wheel, double& forward) {
  Prediction<2> p;
  p.design.setZero(2, l.size);
  const Matrix3d body_R_ecef = e.nav.ecef_R_body.transpose();
  const Vector3d v = body_R_ecef * e.nav.velocity + rate.cross(wheel);
  Eigen::Matrix<double, 2, 3> pick;
  pick << -e.track.x(), 1, 0, e.track.y(), 0, 1;
  forward = v.x();
  p.value = pick * v;
  p.design.block<2, 3>(0, l.velocity) = pick * body_R_ecef;
  p.design.block<2, 3>(0, l.attitude) = pick * body_R_ecef * skew(e.nav.velocity);
  p.design.block<2, 3>(0, l.gyro_bias) = pick * skew(wheel);
  if (l.track >= 0) {
    p.design(0, l.track) = -v.x();
    p.design(1, l.track + 1) = v.x();
  }
  return p;
}

}  // namespace swath::trajectory
