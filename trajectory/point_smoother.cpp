// SPDX-License-Identifier: GPL-3.0-or-later
// Source: Rauch, Tung and Striebel 1965; the model's discrete noise is exact for white acceleration (Bar-Shalom, Li, Kirubarajan 2001, eq
// 6.2.2-12). The smoothed covariance is in a form of sums only, (I - G F) P (I - G F)' + G (P+ + Q) G', so that it stays positive.
#include "trajectory/point_smoother.h"

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <numbers>

namespace swath::trajectory {

namespace {

using Matrix6 = PointState::Matrix6;

constexpr double start_velocity_variance = 1e4;  // (m/s)^2 about the velocity of the first step: next to no knowledge
// Search for the density of acceleration: from standing on a pillar (1e-8) to aerobatics (1e4 m^2/s^3).
constexpr double least_exponent = -8.0, most_exponent = 4.0, grid = 0.5, closeness = 1e-3;

Matrix6 transition(double dt) {
  Matrix6 f = Matrix6::Identity();
  f.topRightCorner<3, 3>().diagonal().setConstant(dt);
  return f;
}

double most_likely_density(const PointFixes& fixes, int axis) {
  const auto f = [&](double exponent) { return log_likelihood(fixes, axis, std::pow(10.0, exponent)); };
  double best = least_exponent, best_value = f(best);
  for (double e = least_exponent + grid; e <= most_exponent; e += grid)
    if (const double value = f(e); value > best_value) best = e, best_value = value;
  // Golden section between the neighbours of the best.
  double a = best - grid, b = best + grid;
  const double golden = 1.0 / std::numbers::phi;
  double c = b - golden * (b - a), d = a + golden * (b - a), fc = f(c), fd = f(d);
  while (b - a > closeness) {
    if (fc > fd)
      b = d, d = c, fd = fc, c = b - golden * (b - a), fc = f(c);
    else
      a = c, c = d, fc = fd, d = a + golden * (b - a), fd = f(d);
  }
  return std::pow(10.0, 0.5 * (a + b));
}

}  // namespace

double log_likelihood(const PointFixes& fixes, int axis, double q) {
  const auto z = [&](size_t i) { return fixes.position[i][axis]; };
  const auto r = [&](size_t i) { return fixes.covariance[i](axis, axis); };
  double x = z(0), v = (z(1) - z(0)) / (fixes.time[1] - fixes.time[0]);
  double pxx = r(0), pxv = 0.0, pvv = start_velocity_variance, sum = 0.0;
  for (size_t i = 1; i < fixes.size(); ++i) {
    const double dt = fixes.time[i] - fixes.time[i - 1];
    x += v * dt;
    pxx += dt * (2.0 * pxv + dt * pvv) + q * dt * dt * dt / 3.0;
    pxv += dt * pvv + q * dt * dt / 2.0;
    pvv += q * dt;
    const double s = pxx + r(i), innovation = z(i) - x, kx = pxx / s, kv = pxv / s;
    // The second fix settles the velocity and says nothing about q.
    if (i > 1) sum -= 0.5 * (std::log(s) + innovation * innovation / s);
    x += kx * innovation;
    v += kv * innovation;
    pvv -= kv * pxv;
    pxv *= r(i) / s;
    pxx *= r(i) / s;
  }
  return sum;
}

Matrix6 PointSmoother::noise(double dt) const {
  const Eigen::Vector3d q = acceleration_.cwiseAbs2();
  Matrix6 out = Matrix6::Zero();
  out.topLeftCorner<3, 3>().diagonal() = q * (dt * dt * dt / 3.0);
  out.topRightCorner<3, 3>().diagonal() = q * (dt * dt / 2.0);
  out.bottomLeftCorner<3, 3>() = out.topRightCorner<3, 3>();
  out.bottomRightCorner<3, 3>().diagonal() = q * dt;
  return out;
}

PointSmoother::PointSmoother(PointFixes fixes) : fixes_(std::move(fixes)) {
  for (int axis = 0; axis < 3; ++axis) acceleration_[axis] = std::sqrt(most_likely_density(fixes_, axis));
  PointState s;
  s.time = fixes_.time[0];
  s.x << fixes_.position[0], (fixes_.position[1] - fixes_.position[0]) / (fixes_.time[1] - fixes_.time[0]);
  s.covariance.topLeftCorner<3, 3>() = fixes_.covariance[0];
  s.covariance.bottomRightCorner<3, 3>().diagonal().setConstant(start_velocity_variance);
  filtered_.push_back(s);
  for (size_t i = 1; i < fixes_.size(); ++i) {
    const double dt = fixes_.time[i] - fixes_.time[i - 1];
    PointState next = update(predict(filtered_.back(), dt, noise(dt)), fixes_.position[i], fixes_.covariance[i]);
    next.time = fixes_.time[i];
    filtered_.push_back(next);
  }
  smoothed_ = filtered_;
  for (size_t i = fixes_.size() - 1; i-- > 0;) smoothed_[i] = back(filtered_[i], smoothed_[i + 1]);
}

PointState PointSmoother::back(const PointState& filtered, const PointState& next) const {
  const double dt = next.time - filtered.time;
  if (dt == 0.0) return next;
  const Matrix6 f = transition(dt), q = noise(dt);
  const PointState predicted = predict(filtered, dt, q);
  const Matrix6 gain = predicted.covariance.llt().solve(f * filtered.covariance).transpose();
  const Matrix6 rest = Matrix6::Identity() - gain * f;
  PointState out = filtered;
  out.x += gain * (next.x - predicted.x);
  out.covariance = rest * filtered.covariance * rest.transpose() + gain * (next.covariance + q) * gain.transpose();
  return out;
}

PointState PointSmoother::at(double t) const {
  const auto after = std::upper_bound(fixes_.time.begin(), fixes_.time.end() - 1, t);
  const auto next = static_cast<size_t>(after - fixes_.time.begin());
  const PointState& before = filtered_[next - 1];
  PointState here = predict(before, t - before.time, noise(t - before.time));
  here.time = t;
  return back(here, smoothed_[next]);
}

PointState PointSmoother::without(size_t i) const {
  // The update by the fix undone: the same formulas with the fix's information taken away.
  const PointState& s = smoothed_[i];
  const Eigen::Matrix3d rest = s.covariance.topLeftCorner<3, 3>() - fixes_.covariance[i];  // negative definite
  const Eigen::Matrix<double, 6, 3> gain = rest.partialPivLu().solve(s.covariance.topRows<3>()).transpose();
  PointState out = s;
  out.x += gain * (fixes_.position[i] - s.position());
  out.covariance -= gain * s.covariance.topRows<3>();
  out.covariance = 0.5 * (out.covariance + out.covariance.transpose()).eval();
  return out;
}

}  // namespace swath::trajectory
