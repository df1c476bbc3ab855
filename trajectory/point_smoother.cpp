// SPDX-License-Identifier: GPL-3.0-or-later
// Source: Rauch, Tung and Striebel 1965. The smoothed covariance is in a form of sums only, (I - G F) P (I - G F)' + G (P+ + Q) G', so that
// it stays positive.
#include "trajectory/point_smoother.h"

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <algorithm>

namespace swath::trajectory {

namespace {

using Matrix9 = Eigen::Matrix<double, 9, 9>;
using Matrix93 = Eigen::Matrix<double, 9, 3>;

constexpr double start_velocity_variance = 1e4;  // (m/s)^2 about the velocity of the first step: next to no knowledge

/// The three axes' own matrices in one of all nine states.
template <class OfAxis>
Matrix9 spread_axes(const OfAxis& of_axis) {
  Matrix9 out = Matrix9::Zero();
  for (int axis = 0; axis < 3; ++axis) {
    const Eigen::Matrix3d m = of_axis(axis);
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j) out(3 * i + axis, 3 * j + axis) = m(i, j);
  }
  return out;
}
Matrix9 transition_of(const PointMotion& m, double dt) {
  return spread_axes([&](int axis) { return motion_transition(m[static_cast<size_t>(axis)], dt); });
}
Matrix9 noise_of(const PointMotion& m, double dt) {
  return spread_axes([&](int axis) { return motion_noise(m[static_cast<size_t>(axis)], dt); });
}

}  // namespace

PointSmoother::PointSmoother(PointFixes fixes, MotionModel model) : fixes_(std::move(fixes)), model_(std::move(model)) {
  State s;
  s.x.head<6>() << fixes_.position[0], (fixes_.position[1] - fixes_.position[0]) / (fixes_.time[1] - fixes_.time[0]);
  s.covariance.topLeftCorner<3, 3>() = model_.white_of(fixes_.covariance[0]);
  s.covariance.diagonal().segment<3>(3).setConstant(start_velocity_variance);
  for (int axis = 0; axis < 3; ++axis) {
    const double a = model_.motion.front()[static_cast<size_t>(axis)].acceleration();
    s.covariance(6 + axis, 6 + axis) = a * a;
  }
  filtered_.push_back(s);
  for (size_t i = 1; i < fixes_.size(); ++i) {
    const double dt = fixes_.time[i] - fixes_.time[i - 1];
    const PointMotion& motion = model_.at(0.5 * (fixes_.time[i - 1] + fixes_.time[i]));
    const Matrix9 f = transition_of(motion, dt);
    s.x = f * filtered_.back().x;
    s.covariance = f * filtered_.back().covariance * f.transpose() + noise_of(motion, dt);
    const Eigen::Matrix3d r = model_.white_of(fixes_.covariance[i]);
    const Matrix93 gain = (s.covariance.topLeftCorner<3, 3>() + r).llt().solve(s.covariance.topRows<3>()).transpose();
    s.x += gain * (fixes_.position[i] - s.x.head<3>());
    Matrix9 rest = Matrix9::Identity();
    rest.leftCols<3>() -= gain;
    s.covariance = (rest * s.covariance * rest.transpose() + gain * r * gain.transpose()).eval();
    filtered_.push_back(s);
  }
  smoothed_ = filtered_;
  for (size_t i = fixes_.size() - 1; i-- > 0;)
    smoothed_[i] =
        back(filtered_[i], smoothed_[i + 1], fixes_.time[i + 1] - fixes_.time[i], model_.at(0.5 * (fixes_.time[i] + fixes_.time[i + 1])));
}

PointState PointSmoother::point(const State& s, double time) {
  PointState out;
  out.time = time;
  out.x = s.x.head<6>();
  out.covariance = s.covariance.topLeftCorner<6, 6>();
  return out;
}

PointSmoother::State PointSmoother::back(const State& filtered, const State& next, double dt, const PointMotion& motion) const {
  if (dt == 0.0) return next;
  const Matrix9 f = transition_of(motion, dt), q = noise_of(motion, dt);
  const Matrix9 predicted = f * filtered.covariance * f.transpose() + q;
  const Matrix9 gain = predicted.ldlt().solve(f * filtered.covariance).transpose();
  const Matrix9 rest = Matrix9::Identity() - gain * f;
  State out = filtered;
  out.x += gain * (next.x - f * filtered.x);
  out.covariance = rest * filtered.covariance * rest.transpose() + gain * (next.covariance + q) * gain.transpose();
  return out;
}

PointState PointSmoother::at(double t) const {
  const auto after = std::upper_bound(fixes_.time.begin() + 1, fixes_.time.end() - 1, t);
  const auto next = static_cast<size_t>(after - fixes_.time.begin());
  const double since = t - fixes_.time[next - 1];
  const PointMotion& motion = model_.at(0.5 * (fixes_.time[next - 1] + fixes_.time[next]));
  const Matrix9 f = transition_of(motion, since);
  State here;
  here.x = f * filtered_[next - 1].x;
  here.covariance = f * filtered_[next - 1].covariance * f.transpose() + noise_of(motion, since);
  return point(back(here, smoothed_[next], fixes_.time[next] - t, motion), t);
}

PointState PointSmoother::without(size_t i) const {
  // The update by the fix undone: the same formulas with the fix's information taken away.
  const State& s = smoothed_[i];
  const Eigen::Matrix3d rest = s.covariance.topLeftCorner<3, 3>() - model_.white_of(fixes_.covariance[i]);  // negative definite
  const Matrix93 gain = rest.partialPivLu().solve(s.covariance.topRows<3>()).transpose();
  State out = s;
  out.x += gain * (fixes_.position[i] - s.x.head<3>());
  out.covariance -= gain * s.covariance.topRows<3>();
  out.covariance = 0.5 * (out.covariance + out.covariance.transpose()).eval();
  return point(out, fixes_.time[i]);
}

}  // namespace swath::trajectory
