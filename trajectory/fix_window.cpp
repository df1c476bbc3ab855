// SPDX-License-Identifier: GPL-3.0-or-later
// Source: Jubanski and Mitishita 2005, eq 1 (straight line over the window, time reduced to its first epoch). Positions are reduced to the
// window's first fix before the normal equations, so that northings of 7000 km keep their last bits.
#include "trajectory/fix_window.h"

#include <Eigen/Cholesky>
#include <algorithm>

#include "core/geo/geodesy.h"

namespace swath::trajectory {

namespace {

constexpr size_t least_fixes = 2;  // per side: a velocity needs two

size_t fixes_before(const std::vector<double>& time, size_t middle, size_t epochs, double longest_step) {
  size_t first = middle;
  while (first > 0 && middle - first < epochs && (first == middle || time[first] - time[first - 1] <= longest_step)) --first;
  return first;
}

size_t fixes_after(const std::vector<double>& time, size_t after, size_t epochs, double longest_step) {
  size_t end = after;
  while (end < time.size() && end - after < epochs && (end == after || time[end] - time[end - 1] <= longest_step)) ++end;
  return end;
}

FixWindow window(const std::vector<double>& time, size_t middle, size_t after, size_t epochs, double longest_step) {
  FixWindow w{0, middle, after, 0, Reach::outside};
  w.before = fixes_before(time, middle, epochs, longest_step);
  w.end = fixes_after(time, after, epochs, longest_step);
  const size_t left = w.middle - w.before, right = w.end - w.after;
  if (left == 0 || right == 0) return w;
  // The instant's own step: without the fix left out it is two steps long.
  if (time[after] - time[middle - 1] > longest_step)
    w.reach = Reach::gap;
  else if (left < least_fixes || right < least_fixes)
    w.reach = Reach::too_few;
  else
    w.reach = left == epochs && right == epochs ? Reach::full : Reach::partial;
  return w;
}

// Powers 1, s ... s^degree and their derivatives.
Eigen::VectorXd powers(double s, int degree) {
  Eigen::VectorXd p(degree + 1);
  p[0] = 1.0;
  for (int k = 1; k <= degree; ++k) p[k] = p[k - 1] * s;
  return p;
}
Eigen::VectorXd power_rates(double s, int degree) {
  Eigen::VectorXd p = Eigen::VectorXd::Zero(degree + 1);
  double power = 1.0;
  for (int k = 1; k <= degree; ++k, power *= s) p[k] = k * power;
  return p;
}

// Row of the three positions in the unknowns: [p0 I, p1 I ...].
Eigen::MatrixXd design(const Eigen::VectorXd& p) {
  Eigen::MatrixXd a(3, 3 * p.size());
  for (int k = 0; k < p.size(); ++k) a.middleCols<3>(3 * k) = p[k] * Eigen::Matrix3d::Identity();
  return a;
}

}  // namespace

LocalFrame local_frame(const Eigen::Vector3d& ecef) {
  const core::Geodetic g = core::geodetic_of(ecef);
  const Eigen::Matrix3d axes = core::ecef_R_ned(g.latitude, g.longitude);
  LocalFrame f{ecef, {}};
  f.local_R_ecef.row(0) = axes.col(1).transpose();
  f.local_R_ecef.row(1) = axes.col(0).transpose();
  f.local_R_ecef.row(2) = -axes.col(2).transpose();
  return f;
}

PointFixes to_local(const core::GnssData& gnss, const LocalFrame& frame) {
  PointFixes out;
  out.time = gnss.time;
  for (size_t i = 0; i < gnss.size(); ++i) {
    out.position.push_back(frame.local_R_ecef * (gnss.position[i] - frame.origin));
    out.covariance.push_back(frame.local_R_ecef * gnss.covariance[i] * frame.local_R_ecef.transpose());
  }
  return out;
}

FixWindow window_at(const std::vector<double>& time, double t, size_t epochs, double longest_step) {
  const auto next = static_cast<size_t>(std::upper_bound(time.begin(), time.end(), t) - time.begin());
  return window(time, next, next, epochs, longest_step);
}

FixWindow window_without(const std::vector<double>& time, size_t left_out, size_t epochs, double longest_step) {
  return window(time, left_out, left_out + 1, epochs, longest_step);
}

Eigen::Vector3d PolynomialFit::position(double t) const {
  return coefficients * powers(t - start, static_cast<int>(coefficients.cols()) - 1);
}
Eigen::Vector3d PolynomialFit::velocity(double t) const {
  return coefficients * power_rates(t - start, static_cast<int>(coefficients.cols()) - 1);
}
Eigen::Matrix<double, 6, 6> PolynomialFit::covariance_at(double t) const {
  const int degree = static_cast<int>(coefficients.cols()) - 1;
  Eigen::MatrixXd a(6, 3 * (degree + 1));
  a << design(powers(t - start, degree)), design(power_rates(t - start, degree));
  return a * covariance * a.transpose();
}

PolynomialFit fit_polynomial(const PointFixes& fixes, const FixWindow& w, int degree, bool axis_by_axis, bool weighted) {
  const int unknowns = 3 * (degree + 1);
  const Eigen::Vector3d reference = fixes.position[w.before];
  PolynomialFit fit;
  fit.start = fixes.time[w.before];

  const auto covariance_of = [&](size_t i) -> Eigen::Matrix3d {
    if (axis_by_axis) return fixes.covariance[i].diagonal().asDiagonal();
    return fixes.covariance[i];
  };
  const auto weight_of = [&](size_t i) -> Eigen::Matrix3d { return covariance_of(i).llt().solve(Eigen::Matrix3d::Identity()); };
  Eigen::MatrixXd normal = Eigen::MatrixXd::Zero(unknowns, unknowns), unit_normal = normal, noise = normal;
  Eigen::VectorXd right = Eigen::VectorXd::Zero(unknowns), unit_right = right;
  for (size_t k = 0; k < w.size(); ++k) {
    const size_t i = w.at(k);
    const Eigen::MatrixXd a = design(powers(fixes.time[i] - fit.start, degree));
    const Eigen::Vector3d l = fixes.position[i] - reference;
    const Eigen::Matrix3d weight = weight_of(i);
    normal += a.transpose() * weight * a;
    right += a.transpose() * weight * l;
    unit_normal += a.transpose() * a;
    unit_right += a.transpose() * l;
    noise += a.transpose() * covariance_of(i) * a;
  }
  // Unit weights: the fixes' covariances are propagated into the coefficients all the same.
  const Eigen::LLT<Eigen::MatrixXd> solver(weighted ? normal : unit_normal);
  const Eigen::VectorXd x = solver.solve(weighted ? right : unit_right);
  fit.coefficients = Eigen::Map<const Eigen::MatrixXd>(x.data(), 3, degree + 1);
  const Eigen::MatrixXd inverse = solver.solve(Eigen::MatrixXd::Identity(unknowns, unknowns));
  fit.covariance = weighted ? inverse : Eigen::MatrixXd(inverse * noise * inverse);

  Eigen::Vector3d square = Eigen::Vector3d::Zero();
  for (size_t k = 0; k < w.size(); ++k) {
    const size_t i = w.at(k);
    const Eigen::Vector3d v = fixes.position[i] - reference - fit.position(fixes.time[i]);
    square += axis_by_axis ? Eigen::Vector3d(v.cwiseProduct(weight_of(i) * v)) : Eigen::Vector3d::Constant(v.dot(weight_of(i) * v) / 3.0);
  }
  const double left_over = static_cast<double>(w.size()) - (degree + 1);
  fit.variance_factor = left_over > 0 ? Eigen::Vector3d(square / left_over) : Eigen::Vector3d::Ones();
  fit.coefficients.col(0) += reference;
  return fit;
}

}  // namespace swath::trajectory
