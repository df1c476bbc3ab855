// SPDX-License-Identifier: GPL-3.0-or-later
#include "trajectory/ins/error_state.h"

#include <cmath>

#include "core/geo/frames.h"
#include "core/geo/geodesy.h"

namespace swath::trajectory {

using core::skew;
using Eigen::Matrix3d;
using Eigen::Vector3d;

Layout::Layout(bool scales, bool lever_arm, bool correlated_fixes, bool fix_latency, bool vehicle) {
  const auto take = [this](bool wanted, int& row, int rows) {
    if (!wanted) return;
    row = size;
    size += rows;
  };
  take(scales, gyro_scale, 3);
  take(scales, force_scale, 3);
  take(lever_arm, lever, 3);
  take(correlated_fixes, fix, 3);
  take(fix_latency, latency, 1);
  take(vehicle, track, 2);
}

void Estimate::correct(const Layout& l, const StateVector& e) {
  nav.position += e.segment<3>(l.position);
  nav.velocity += e.segment<3>(l.velocity);
  nav.ecef_R_body = orthonormal(core::exp_so3(e.segment<3>(l.attitude)) * nav.ecef_R_body);
  gyro_bias += e.segment<3>(l.gyro_bias);
  force_bias += e.segment<3>(l.force_bias);
  if (l.gyro_scale >= 0) gyro_scale += e.segment<3>(l.gyro_scale);
  if (l.force_scale >= 0) force_scale += e.segment<3>(l.force_scale);
  if (l.lever >= 0) lever += e.segment<3>(l.lever);
  if (l.fix >= 0) fix += e.segment<3>(l.fix);
  if (l.latency >= 0) latency += e[l.latency];
  if (l.track >= 0) track += e.segment<2>(l.track);
}

StateVector Estimate::minus(const Estimate& from, const Layout& l) const {
  StateVector e = StateVector::Zero(l.size);
  e.segment<3>(l.position) = nav.position - from.nav.position;
  e.segment<3>(l.velocity) = nav.velocity - from.nav.velocity;
  e.segment<3>(l.attitude) = core::log_so3(nav.ecef_R_body * from.nav.ecef_R_body.transpose());
  e.segment<3>(l.gyro_bias) = gyro_bias - from.gyro_bias;
  e.segment<3>(l.force_bias) = force_bias - from.force_bias;
  if (l.gyro_scale >= 0) e.segment<3>(l.gyro_scale) = gyro_scale - from.gyro_scale;
  if (l.force_scale >= 0) e.segment<3>(l.force_scale) = force_scale - from.force_scale;
  if (l.lever >= 0) e.segment<3>(l.lever) = lever - from.lever;
  if (l.fix >= 0) e.segment<3>(l.fix) = fix - from.fix;
  if (l.latency >= 0) e[l.latency] = latency - from.latency;
  if (l.track >= 0) e.segment<2>(l.track) = track - from.track;
  return e;
}

Increment Estimate::corrected(const Increment& m) const {
  return {(m.angle - m.step * gyro_bias).cwiseQuotient(Vector3d::Ones() + gyro_scale),
          (m.velocity - m.step * force_bias).cwiseQuotient(Vector3d::Ones() + force_scale), m.step};
}

ProcessNoise ProcessNoise::of(const core::ImuErrorModel& m, double fix_time) {
  const auto square = [](double v) { return v * v; };
  return {square(m.angular_random_walk.value), square(m.velocity_random_walk.value), 2 * square(m.gyro_drift.value) / m.drift_time.value,
          2 * square(m.accelerometer_drift.value) / m.drift_time.value, fix_time};
}

void Propagation::add(const Increment& measured) {
  const Increment inc = estimate_.corrected(measured);
  const double dt = inc.step;
  // Attitude in the middle of the increment: sums of products are then of second order.
  const Matrix3d C = estimate_.nav.ecef_R_body * (Matrix3d::Identity() + 0.5 * skew(inc.angle));
  const Matrix3d turned = C * inc.angle.asDiagonal();
  const Vector3d force = C * inc.velocity;
  const Matrix3d lift = skew(force);
  // Position: the velocity's mean over the step.
  r_psi_ += dt * (v_psi_ - 0.5 * lift);
  r_gyro_bias_ += dt * v_gyro_bias_;
  r_gyro_scale_ += dt * v_gyro_scale_;
  r_bias_ += dt * (v_bias_ - 0.5 * dt * C);
  v_bias_ -= dt * C;
  v_psi_ -= lift;
  v_gyro_bias_ -= lift * (psi_bias_ - 0.5 * dt * C);
  v_gyro_scale_ -= lift * (psi_scale_ - 0.5 * turned);
  psi_bias_ -= dt * C;
  psi_scale_ -= turned;
  const Matrix3d pushed = C * inc.velocity.asDiagonal();
  r_scale_ += dt * (v_scale_ - 0.5 * pushed);
  v_scale_ -= pushed;
  elapsed_ += dt;
  advance(estimate_.nav, inc);
}

StateMatrix Propagation::transition(const ProcessNoise& noise) const {
  const Layout& l = layout_;
  const double t = elapsed_;
  StateMatrix phi = StateMatrix::Identity(l.size, l.size);
  const Matrix3d earth = skew(Vector3d(0, 0, core::wgs84::omega));
  const Matrix3d gradient = gravity_gradient_at(estimate_.nav.position);
  const auto at = [&phi](int row, int column) { return phi.block<3, 3>(row, column); };
  at(l.position, l.position) += 0.5 * t * t * gradient;
  at(l.position, l.velocity) = t * Matrix3d::Identity() - t * t * earth;
  at(l.velocity, l.position) = t * gradient;
  at(l.velocity, l.velocity) -= 2 * t * earth;
  at(l.attitude, l.attitude) = core::exp_so3(Vector3d(0, 0, -core::wgs84::omega * t));
  at(l.attitude, l.gyro_bias) = psi_bias_;
  at(l.velocity, l.attitude) = v_psi_;
  at(l.velocity, l.gyro_bias) = v_gyro_bias_;
  at(l.velocity, l.force_bias) = v_bias_;
  at(l.position, l.attitude) = r_psi_;
  at(l.position, l.gyro_bias) = r_gyro_bias_;
  at(l.position, l.force_bias) = r_bias_;
  if (l.gyro_scale >= 0) {
    at(l.attitude, l.gyro_scale) = psi_scale_;
    at(l.velocity, l.gyro_scale) = v_gyro_scale_;
    at(l.position, l.gyro_scale) = r_gyro_scale_;
  }
  if (l.force_scale >= 0) {
    at(l.velocity, l.force_scale) = v_scale_;
    at(l.position, l.force_scale) = r_scale_;
  }
  if (l.fix >= 0) at(l.fix, l.fix) = std::exp(-std::abs(t) / noise.fix_time) * Matrix3d::Identity();
  return phi;
}

StateVector Propagation::gained(const ProcessNoise& noise, const Bridging& bridged) const {
  const Layout& l = layout_;
  const double t = std::abs(elapsed_);
  StateVector q = StateVector::Zero(l.size);
  q.segment<3>(l.attitude).setConstant(t * noise.angle + bridged.turn);
  q.segment<3>(l.velocity).setConstant(t * noise.velocity + bridged.push);
  q.segment<3>(l.gyro_bias).setConstant(t * noise.gyro_drift);
  q.segment<3>(l.force_bias).setConstant(t * noise.force_drift);
  if (l.fix >= 0) q.segment<3>(l.fix).setConstant(1 - std::exp(-2 * t / noise.fix_time));
  return q;
}

}  // namespace swath::trajectory
