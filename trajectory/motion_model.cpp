// SPDX-License-Identifier: GPL-3.0-or-later
// Sources: Singer 1970 (the process); Bar-Shalom, Li, Kirubarajan 2001, 8.2.3 (its discrete noise). The level by the innovations'
// likelihood. How much of a fix's error is white shows where the antenna moves little within a step, and hardly elsewhere: the stated sigma
// is then believed, by a prior.
#include "trajectory/motion_model.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>

#include "core/statistics.h"

namespace swath::trajectory {

namespace {

// (m/s)^2 about the velocity of a piece's first step: next to no knowledge.
constexpr double piece_velocity_variance = 1e4;
// Bounds of the search: from an antenna on a pillar to aerobatics; times from a tenth of a step to a minute, over which a turn lasts.
constexpr double least_acceleration = 1e-4, greatest_acceleration = 100.0, least_time_share = 0.1, greatest_time = 60.0;
constexpr double least_white = 0.1, greatest_white = 10.0;
// Some of a fix's error is always slow (orbits, air, phase centres). Nothing known of its share, half of the variance is expected to be
// white, and the logarithm of its sigma within 0.5.
const double expected_white = -0.5 * std::log(2.0);
constexpr double white_prior = 0.5;
constexpr double level_grid = 1.2, time_grid = 1.0, white_grid = 0.5, posterior_grid = 0.1, closeness = 0.02;  // of logarithms
constexpr int model_rounds = 2;
constexpr size_t overlap = 3;             // fixes of the neighbours that settle a piece's start
constexpr size_t enough_fixes = 4000;     // of a record's pieces, for what is one per record
constexpr double series_below = 0.5;      // dt / time: the closed form loses digits there
constexpr double noise_tolerance = 5e-3;  // of a step: the noise of one of nearly its length serves

/// What a unit impulse of the acceleration's drive makes of position, velocity and acceleration after s.
Eigen::Vector3d response(double s, double time) {
  const double x = s / time;
  const double first = x < 1e-8 ? 1.0 - 0.5 * x : -std::expm1(-x) / x;
  const double second = x < 1e-3 ? 0.5 - x / 6.0 + x * x / 24.0 : (x + std::expm1(-x)) / (x * x);
  return {s * s * second, s * first, std::exp(-x)};
}

/// The integral of the response's square by Gauss-Legendre, 8 nodes: exact to the last digits where dt is short against the time.
Eigen::Matrix3d noise_by_quadrature(const AxisMotion& m, double dt) {
  constexpr std::array<double, 4> node{0.1834346424956498, 0.5255324099163290, 0.7966664774136267, 0.9602898564975363};
  constexpr std::array<double, 4> weight{0.3626837833783620, 0.3137066458778873, 0.2223810344533745, 0.1012285362903763};
  Eigen::Matrix3d out = Eigen::Matrix3d::Zero();
  for (size_t k = 0; k < node.size(); ++k)
    for (const double sign : {-1.0, 1.0}) {
      const Eigen::Vector3d g = response(0.5 * dt * (1.0 + sign * node[k]), m.time);
      out += 0.5 * dt * weight[k] * g * g.transpose();
    }
  return m.drive * out;
}

/// The argument of the largest value within [lowest, highest]: on a grid, then by golden section.
double best_of(const std::function<double(double)>& f, double lowest, double highest, double grid) {
  double best = lowest, best_value = f(best);
  for (double x = lowest + grid; x < highest + 0.5 * grid; x += grid)
    if (const double value = f(x); value > best_value) best = x, best_value = value;
  double a = std::max(best - grid, lowest), b = std::min(best + grid, highest);
  constexpr double golden = 1.0 / std::numbers::phi;
  double c = b - golden * (b - a), d = a + golden * (b - a), fc = f(c), fd = f(d);
  while (b - a > closeness) {
    if (fc > fd)
      b = d, d = c, fd = fc, c = b - golden * (b - a), fc = f(c);
    else
      a = c, c = d, fc = fd, d = a + golden * (b - a), fd = f(d);
  }
  return 0.5 * (a + b);
}

/// Fixes of a piece with those that settle its start and end.
struct Stretch {
  size_t first, end;
};

/// Logarithm of the most likely standard deviation of the acceleration of one piece, and the likelihood there.
std::pair<double, double> level_of(const PointFixes& fixes, const Stretch& s, int axis, double time, double white) {
  const auto f = [&](double level) { return log_likelihood(fixes, s.first, s.end, axis, motion_of(std::exp(level), time), white); };
  const double level = best_of(f, std::log(least_acceleration), std::log(greatest_acceleration), level_grid);
  return {level, f(level)};
}

/// Some of the stretches, evenly chosen, that hold enough fixes between them.
std::vector<Stretch> sample_of(const std::vector<Stretch>& all) {
  size_t fixes = 0;
  for (const Stretch& s : all) fixes += s.end - s.first;
  const size_t every = fixes / enough_fixes + 1;
  std::vector<Stretch> out;
  for (size_t k = 0; k < all.size(); k += every) out.push_back(all[k]);
  return out;
}

/// What is one for a record: correlation times of some axes, and the white share that they have in common.
struct RecordLevel {
  std::vector<double> time;
  double white = 1.0, slow = 0.0;  ///< of standard deviations; `slow` of the mean variance over what `white` may be
};

RecordLevel record_level(const PointFixes& fixes, const std::vector<Stretch>& sample, const std::vector<int>& axes) {
  const double shortest = std::log(least_time_share * core::median_step(fixes.time));
  double white = expected_white;  // logarithms
  std::vector<double> time(axes.size(), 0.0);
  const auto probability = [&](size_t k, double log_time, double log_white) {
    double sum = 0.0;
    for (const Stretch& s : sample) sum += level_of(fixes, s, axes[k], std::exp(log_time), std::exp(log_white)).second;
    return sum;
  };
  const auto of_white = [&](double w) {
    double sum = -0.5 * std::pow((w - expected_white) / white_prior, 2);
    for (size_t k = 0; k < axes.size(); ++k) sum += probability(k, time[k], w);
    return sum;
  };
  for (int round = 0; round < model_rounds; ++round) {
    for (size_t k = 0; k < axes.size(); ++k)
      time[k] = best_of([&](double t) { return probability(k, t, white); }, shortest, std::log(greatest_time), time_grid);
    white = best_of(of_white, std::log(least_white), std::log(greatest_white), white_grid);
  }
  RecordLevel out;
  for (const double t : time) out.time.push_back(std::exp(t));
  out.white = std::exp(white);
  double weights = 0.0, slow = 0.0;
  const double best = of_white(white);
  for (double w = std::log(least_white); w < std::log(greatest_white); w += posterior_grid) {
    const double weight = std::exp(of_white(w) - best);
    weights += weight;
    slow += weight * std::max(1.0 - std::exp(2.0 * w), 0.0);
  }
  out.slow = std::sqrt(slow / weights);
  return out;
}

}  // namespace

double AxisMotion::acceleration() const { return std::sqrt(0.5 * drive * time); }

AxisMotion motion_of(double acceleration, double time) { return {2.0 * acceleration * acceleration / time, time}; }

Eigen::Matrix3d motion_transition(const AxisMotion& m, double dt) {
  const Eigen::Vector3d r = response(dt, m.time);
  Eigen::Matrix3d out;
  out << 1.0, dt, r[0], 0.0, 1.0, r[1], 0.0, 0.0, r[2];
  return out;
}

Eigen::Matrix3d motion_noise(const AxisMotion& m, double dt) {
  const double x = dt / m.time, t = m.time, e = std::exp(-x), e2 = e * e;
  if (x < series_below) return noise_by_quadrature(m, dt);
  Eigen::Matrix3d q;
  q(0, 0) = t * t * t * t * t * (1.0 - e2 + 2.0 * x + 2.0 * x * x * x / 3.0 - 2.0 * x * x - 4.0 * x * e);
  q(0, 1) = q(1, 0) = t * t * t * t * (e2 + 1.0 - 2.0 * e + 2.0 * x * e - 2.0 * x + x * x);
  q(0, 2) = q(2, 0) = t * t * t * (1.0 - e2 - 2.0 * x * e);
  q(1, 1) = t * t * t * (4.0 * e - 3.0 - e2 + 2.0 * x);
  q(1, 2) = q(2, 1) = t * t * (e2 + 1.0 - 2.0 * e);
  q(2, 2) = t * (1.0 - e2);
  return 0.5 * m.drive * q;
}

const PointMotion& MotionModel::at(double t) const {
  const auto next = std::upper_bound(start.begin() + 1, start.end(), t);
  return motion[static_cast<size_t>(next - start.begin()) - 1];
}

Eigen::Matrix3d MotionModel::white_of(const Eigen::Matrix3d& stated) const { return white.asDiagonal() * stated * white.asDiagonal(); }

Eigen::Matrix3d MotionModel::slow_of(const Eigen::Matrix3d& stated) const { return slow.asDiagonal() * stated * slow.asDiagonal(); }

MotionModel fit_motion(const PointFixes& fixes, const std::vector<size_t>& pieces) {
  MotionModel out;
  std::vector<Stretch> all;
  for (size_t k = 0; k < pieces.size(); ++k) {
    const size_t end = k + 1 < pieces.size() ? pieces[k + 1] : fixes.size();
    out.start.push_back(fixes.time[pieces[k]]);
    all.push_back({pieces[k] > overlap ? pieces[k] - overlap : 0, std::min(end + overlap, fixes.size())});
  }
  out.motion.resize(all.size());
  const std::vector<Stretch> sample = sample_of(all);
  const RecordLevel horizontal = record_level(fixes, sample, {0, 1}), vertical = record_level(fixes, sample, {2});
  out.white << horizontal.white, horizontal.white, vertical.white;
  out.slow << horizontal.slow, horizontal.slow, vertical.slow;
  const double times[] = {horizontal.time[0], horizontal.time[1], vertical.time[0]};
  for (int axis = 0; axis < 3; ++axis)
    for (size_t k = 0; k < all.size(); ++k)
      out.motion[k][static_cast<size_t>(axis)] =
          motion_of(std::exp(level_of(fixes, all[k], axis, times[axis], out.white[axis]).first), times[axis]);
  return out;
}

double log_likelihood(const PointFixes& fixes, size_t first, size_t end, int axis, const AxisMotion& m, double white) {
  const auto z = [&](size_t i) { return fixes.position[i][axis]; };
  const auto r = [&](size_t i) { return white * white * fixes.covariance[i](axis, axis); };
  Eigen::Vector3d x(z(first), (z(first + 1) - z(first)) / (fixes.time[first + 1] - fixes.time[first]), 0.0);
  Eigen::Matrix3d p = Eigen::Matrix3d::Zero(), noise = p;
  p.diagonal() << r(first), piece_velocity_variance, m.acceleration() * m.acceleration();
  double sum = 0.0, step_of_noise = 0.0;
  for (size_t i = first + 1; i < end; ++i) {
    const double dt = fixes.time[i] - fixes.time[i - 1];
    if (std::abs(dt - step_of_noise) > noise_tolerance * dt) noise = motion_noise(m, dt), step_of_noise = dt;
    const Eigen::Matrix3d f = motion_transition(m, dt);
    x = f * x;
    p = f * p * f.transpose() + noise;
    const double variance = p(0, 0) + r(i), innovation = z(i) - x[0];
    // The second fix settles the velocity and says nothing about the acceleration.
    if (i > first + 1) sum -= 0.5 * (std::log(variance) + innovation * innovation / variance);
    const Eigen::Vector3d gain = p.col(0) / variance;
    x += gain * innovation;
    p -= variance * gain * gain.transpose();
  }
  return sum;
}

}  // namespace swath::trajectory
