// SPDX-License-Identifier: GPL-3.0-or-later
// Sigma by clusters after Liang and Zeger (1986, "Longitudinal data analysis using generalized linear models"), and by the residuals'
// autocovariances after Newey and West (1987, "A simple, positive semi-definite, heteroskedasticity and autocorrelation consistent
// covariance matrix"). Deviation: autocovariances are pooled over the windows and summed without a taper to the lag at which the sum is
// largest: too large by up to a tenth in white noise.
#include "trajectory/clock/clock_fit.h"

#include <Eigen/Cholesky>
#include <Eigen/Geometry>
#include <Eigen/SVD>
#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include "core/geo/frames.h"
#include "core/statistics.h"

namespace swath::trajectory {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;
constexpr int own = 3 + clock_sensor_errors;  // unknowns of a window beside the offset: rotation, sensors
using VectorOwn = Eigen::Matrix<double, own, 1>;
using VectorN = Eigen::Matrix<double, own + 1, 1>;  // offset, own
using MatrixN = Eigen::Matrix<double, own + 1, own + 1>;
using Rows = Eigen::Matrix<double, 3, own + 1>;

constexpr double huber = 2.5, clipped = 3.0;             // sigmas
constexpr double loose_drift = 3e-3, loose_bias = 0.2;   // rad/s, m/s^2: what a window may take beside the stated sensor errors
constexpr double loose_scale = 2e-4;                     // the same of scale factors
constexpr double first_scale = 0.1, least_scale = 1e-3;  // m/s^2
constexpr double least_sigma = 2e-4, settled = 1e-5;     // s
constexpr int rounds = 15;

/// What the IMU senses at an offset from the grid's middle, by the cubic through the four around; and its derivative by the offset.
std::pair<Vector3d, Vector3d> sensed_at(const ClockTriple& t, double offset) {
  const double x = offset / clock_grid + 0.5 * static_cast<double>(t.sensed.size() - 1);
  const auto k = static_cast<size_t>(std::clamp(std::floor(x), 1.0, static_cast<double>(t.sensed.size()) - 3));
  const double s = x - static_cast<double>(k);
  const Vector3d &a = t.sensed[k - 1], &b = t.sensed[k], &c = t.sensed[k + 1], &d = t.sensed[k + 2];
  const Vector3d p1 = c - a / 3 - b / 2 - d / 6, p2 = (a + c) / 2 - b, p3 = (d - a) / 6 + (b - c) / 2;
  return {b + s * (p1 + s * (p2 + s * p3)), (p1 + s * (2 * p2 + s * 3 * p3)) / clock_grid};
}

/// What one window has of its own.
struct Own {
  Matrix3d rotation;
  ClockSensorErrors sensors = ClockSensorErrors::Zero();
  std::vector<Vector3d> left{};  // residuals of the round before
  std::vector<Vector3d> pull{};  // what a unit of each residual adds to the right side of the offset
};

/// The common offset at one round: normal equations of each window with its own unknowns taken out.
struct Round {
  std::vector<double> normal, right;  // per window, of the offset
  double weight() const { return std::accumulate(normal.begin(), normal.end(), 0.0); }
  double step() const { return weight() > 0 ? std::accumulate(right.begin(), right.end(), 0.0) / weight() : 0.0; }
};

double huber_weight(double residual, double scale) {
  const double z = std::abs(residual) / scale;
  return z > huber ? huber / z : 1.0;
}

/// Weights of the second differences by the residuals of the round before; at first all alike.
std::vector<Vector3d> weights_of(const ClockWindow& w, const Own& mine, const Vector3d& scale) {
  std::vector<Vector3d> out(w.triples.size(), scale.cwiseAbs2().cwiseInverse());
  for (size_t i = 0; i < mine.left.size(); ++i)
    for (int a = 0; a < 3; ++a) out[i][a] *= huber_weight(mine.left[i][a], scale[a]);
  return out;
}

/// One step of Gauss and Newton in a window's own unknowns at `offset`.
void solve_window(const ClockWindow& w, double offset, const Vector3d& scale, const VectorN& prior, Own& mine, Round& out) {
  const std::vector<Vector3d> weights = weights_of(w, mine, scale);
  MatrixN normal = prior.asDiagonal();
  VectorN right = VectorN::Zero();
  right.tail<clock_sensor_errors>() = -prior.tail<clock_sensor_errors>().cwiseProduct(mine.sensors);
  std::vector<Rows> rows;
  mine.left.resize(w.triples.size());
  mine.pull.resize(w.triples.size());
  for (size_t i = 0; i < w.triples.size(); ++i) {
    const ClockTriple& t = w.triples[i];
    const auto [sensed, rate] = sensed_at(t, offset);
    const Vector3d turned = mine.rotation * sensed;
    Rows J;
    J << mine.rotation * rate, -core::skew(turned), mine.rotation * t.by_sensors;
    mine.left[i] = t.force - turned - J.rightCols<clock_sensor_errors>() * mine.sensors;
    normal += J.transpose() * weights[i].asDiagonal() * J;
    right += J.transpose() * weights[i].cwiseProduct(mine.left[i]);
    rows.push_back(J);
  }
  const Eigen::LDLT<Eigen::Matrix<double, own, own>> solver(normal.bottomRightCorner<own, own>());
  const VectorOwn coupled = normal.block<own, 1>(1, 0), by_offset = solver.solve(coupled), step = solver.solve(right.tail<own>());
  out.normal.push_back(normal(0, 0) - coupled.dot(by_offset));
  out.right.push_back(right[0] - coupled.dot(step));
  for (size_t i = 0; i < rows.size(); ++i) {
    mine.pull[i] = weights[i].cwiseProduct(rows[i].col(0) - rows[i].rightCols<own>() * by_offset);
    mine.left[i] -= rows[i].rightCols<own>() * step;
  }
  mine.rotation = core::exp_so3(Vector3d(step.head<3>())) * mine.rotation;
  mine.sensors += step.tail<clock_sensor_errors>();
}

Vector3d scale_of(const std::vector<Own>& windows) {
  Vector3d out;
  for (int a = 0; a < 3; ++a) {
    std::vector<double> sizes;
    for (const Own& window : windows)
      for (const Vector3d& r : window.left) sizes.push_back(std::abs(r[a]));
    out[a] = std::max(least_scale, core::mad_to_sigma * core::median(std::move(sizes), 0.0));
  }
  return out;
}

/// Variance of the sum of all pulls times residuals: of each pair within half a window, by the autocovariance of its lag.
double noise_of(const std::vector<Own>& windows, const Vector3d& scale) {
  size_t longest = 0, triples = 0;
  for (const Own& w : windows) longest = std::max(longest, w.left.size()), triples += w.left.size();
  double sum = 0, largest = 0;
  for (size_t lag = 0; lag <= longest / 2; ++lag) {
    Vector3d products = Vector3d::Zero(), pulls = Vector3d::Zero();
    double pairs = 0;
    for (const Own& w : windows)
      for (size_t i = 0; i + lag < w.left.size(); ++i, ++pairs) {
        const auto bounded = [&](const Vector3d& r) { return r.cwiseMin(clipped * scale).cwiseMax(-clipped * scale); };
        products += bounded(w.left[i]).cwiseProduct(bounded(w.left[i + lag]));
        pulls += w.pull[i].cwiseProduct(w.pull[i + lag]);
      }
    if (pairs > 0) sum += (lag == 0 ? 1.0 : 2.0) * products.dot(pulls) / pairs;
    largest = std::max(largest, sum);
  }
  const double equations = 3.0 * static_cast<double>(triples), unknowns = static_cast<double>(own * windows.size());
  return largest * equations / std::max(1.0, equations - unknowns);
}

/// The same of an attitude that wanders by the gyros' angular random walk: residuals hide most of it, for it is slow.
double wander_of(const std::vector<ClockWindow>& windows, const std::vector<Own>& theirs, double walk, double spacing) {
  double sum = 0;
  for (size_t w = 0; w < windows.size(); ++w) {
    Vector3d later = Vector3d::Zero();
    for (size_t i = windows[w].triples.size(); i-- > 0;) {
      later += theirs[w].pull[i].cross(windows[w].triples[i].force);
      sum += later.squaredNorm();
    }
  }
  return walk * walk * spacing * sum;
}

/// Variance of the common offset by the scatter of the windows' own answers.
double scatter_of(const Round& r) {
  const double n = r.weight(), step = r.step();
  double scores = 0, squares = 0;
  for (size_t i = 0; i < r.normal.size(); ++i) {
    scores += std::pow(r.right[i] - r.normal[i] * step, 2);
    squares += r.normal[i] * r.normal[i];
  }
  const double windows = n * n / squares;  // of equal weight
  return scores / (n * n) * windows / std::max(1.0, windows - 1.0);
}

VectorN prior_of(const core::ImuErrorModel& spec) {
  VectorN out = VectorN::Zero();
  const auto within = [](double loose, double sigma) { return 1 / std::pow(loose + 3 * sigma, 2); };
  out.segment<3>(1).setConstant(1.0);
  out.segment<3>(4).setConstant(within(loose_drift, spec.gyro_bias.value));
  out.segment<3>(7).setConstant(within(loose_bias, spec.accelerometer_bias.value));
  out.segment<3>(10).setConstant(within(loose_scale, spec.gyro_scale.value));
  out.segment<3>(13).setConstant(within(loose_scale, spec.accelerometer_scale.value));
  return out;
}

}  // namespace

Matrix3d body_rotation(const ClockWindow& w, const std::vector<Vector3d>& sensed) {
  Matrix3d sum = Matrix3d::Zero();
  for (size_t i = 0; i < w.triples.size(); ++i) sum += w.triples[i].force * sensed[i].transpose();
  const Eigen::JacobiSVD<Matrix3d> svd(sum, Eigen::ComputeFullU | Eigen::ComputeFullV);
  const double sign = (svd.matrixU() * svd.matrixV().transpose()).determinant();
  return svd.matrixU() * Vector3d(1, 1, sign).asDiagonal() * svd.matrixV().transpose();
}

ClockFit fit_clock(const std::vector<ClockWindow>& windows, const ClockGrid& grid, const core::ImuErrorModel& spec, double lever_sigma,
                   double spacing) {
  const VectorN prior = prior_of(spec);
  std::vector<Own> theirs;
  for (const ClockWindow& w : windows) {
    std::vector<Vector3d> sensed;
    for (const ClockTriple& t : w.triples) sensed.push_back(t.sensed[grid.offsets / 2]);
    theirs.push_back({body_rotation(w, sensed)});
  }
  ClockFit out;
  out.rms.setConstant(first_scale);
  Round round;
  for (int i = 0; i < rounds; ++i) {
    round = {};
    for (size_t w = 0; w < windows.size(); ++w) solve_window(windows[w], out.shift, out.rms, prior, theirs[w], round);
    out.rms = scale_of(theirs);
    if (!std::isfinite(round.step())) break;
    const double step = std::clamp(round.step(), -2 * clock_grid, 2 * clock_grid);
    out.shift = std::clamp(out.shift + step, -grid.reach(), grid.reach());
    if (i > 2 && std::abs(step) < settled) break;
  }
  for (int k = 0; k < clock_sensor_errors; ++k) {
    std::vector<double> of_windows;
    for (const Own& o : theirs) of_windows.push_back(-o.sensors[k]);
    out.sensors[k] = core::median(std::move(of_windows), 0.0);
  }
  const double weight = round.weight();
  out.motion_changes = weight > 0;
  if (!out.motion_changes) return out;
  double speed = 0;
  for (size_t w = 0; w < windows.size(); ++w) speed += round.normal[w] / weight * windows[w].speed;
  const double walk = spec.angular_random_walk.value;
  const double noise = (noise_of(theirs, out.rms) + wander_of(windows, theirs, walk, spacing)) / (weight * weight);
  out.sigma = std::sqrt(std::max(scatter_of(round), noise) + std::pow(lever_sigma / std::max(speed, 1.0), 2) + least_sigma * least_sigma);
  return out;
}

}  // namespace swath::trajectory
