// SPDX-License-Identifier: GPL-3.0-or-later
#include "trajectory/ins/alignment.h"

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <Eigen/SVD>
#include <algorithm>
#include <cmath>

#include "core/geo/frames.h"
#include "core/geo/geodesy.h"

namespace swath::trajectory {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

constexpr double window = 40.0, hop = 20.0, latest = 1800.0;  // s
constexpr double half_span = 2.0;                             // s between the three fixes of a second difference
constexpr double track_sigma = 15 * core::degree;             // crab and mounting
constexpr double least_speed = 3.0;                           // m/s for a track
constexpr double good_enough = 1.0 * core::degree;
constexpr double most_bridged = 0.1;                                  // s of a window without IMU records
constexpr double least_force_sigma = 0.02;                            // m/s^2: vibration, lever arm errors
constexpr double still_rate = 0.5 * core::degree, still_force = 0.3;  // rad/s, m/s^2
constexpr double most_moved = 3.0;                                    // m within a second
constexpr double still_least = 2.0;                                   // s

Matrix3d turn_z(double angle) { return Eigen::AngleAxisd(angle, Vector3d::UnitZ()).toRotationMatrix(); }

/// Attraction without the centrifugal part, ecef.
Vector3d gravitation_at(const Vector3d& ecef) {
  constexpr double w2 = core::wgs84::omega * core::wgs84::omega;
  return gravity_at(ecef) - w2 * Vector3d(ecef.x(), ecef.y(), 0);
}

/// Solves Wahba's problem: R with i = R b.
Matrix3d rotation_of(const Matrix3d& sum) {
  const Eigen::JacobiSVD<Matrix3d> svd(sum, Eigen::ComputeFullU | Eigen::ComputeFullV);
  const double sign = (svd.matrixU() * svd.matrixV().transpose()).determinant();
  return svd.matrixU() * Vector3d(1, 1, sign).asDiagonal() * svd.matrixV().transpose();
}

/// One window: fixes with what the IMU did up to each of them.
struct Instant {
  double time;
  Vector3d fix;       // antenna, inertial axes of the window's beginning, less the twice integrated gravitation
  Vector3d path;      // twice integrated specific force plus the turned lever arm, body axes of the beginning
  Vector3d forward;   // body's forward axis, same axes
  Vector3d velocity;  // antenna over the ground, inertial axes
};

std::vector<Instant> collect(const ImuPath& path, const core::GnssData& gnss, size_t first, size_t last, const Vector3d& lever,
                             const Vector3d& gyro_bias) {
  std::vector<Instant> out;
  const double t0 = gnss.time[first];
  ImuWalk walk(path, t0);
  Matrix3d turn = Matrix3d::Identity();
  Vector3d speed = Vector3d::Zero(), way = Vector3d::Zero(), fall = Vector3d::Zero(), fallen = Vector3d::Zero();
  double before = t0;
  Vector3d pull = gravitation_at(gnss.position[first]);
  for (size_t k = first; k <= last; ++k) {
    Increment piece;
    while (walk.next(gnss.time[k], piece)) {
      const Vector3d angle = piece.angle - piece.step * gyro_bias;
      const Vector3d push = turn * (piece.velocity + 0.5 * angle.cross(piece.velocity));
      way += piece.step * (speed + 0.5 * push);
      speed += push;
      turn = turn * core::exp_so3(angle);
    }
    const double t = gnss.time[k], dt = t - before;
    const Matrix3d inertial = turn_z(core::wgs84::omega * (t - t0));
    const Vector3d now = inertial * gravitation_at(gnss.position[k]);
    fallen += dt * fall + dt * dt * (pull / 3.0 + now / 6.0);  // gravitation linear in time
    fall += 0.5 * dt * (pull + now);
    pull = now;
    before = t;
    const size_t a = k > first ? k - 1 : k, b = k < last ? k + 1 : k;
    const Vector3d velocity = (gnss.position[b] - gnss.position[a]) / std::max(1e-3, gnss.time[b] - gnss.time[a]);
    out.push_back({t, inertial * gnss.position[k] - fallen, way + turn * lever, turn.col(0), inertial * velocity});
  }
  return out;
}

struct Solution {
  Matrix3d rotation, covariance;
};

std::optional<Solution> solve(const std::vector<Instant>& at, const Vector3d& up, double fix_sigma, double force_sigma) {
  Matrix3d sum = Matrix3d::Zero(), track = Matrix3d::Zero();
  Matrix3d information = Matrix3d::Zero(), track_information = Matrix3d::Zero();
  double pairs = 0, tracks = 0, weights = 0;
  size_t j = 0, k = 0;
  for (size_t i = 0; i < at.size(); ++i) {
    while (j < at.size() && at[j].time < at[i].time + half_span - 1e-3) ++j;
    // Behind a gap, or where fixes are seldom, the next one is farther than the second span.
    while (k < at.size() && (k <= j || at[k].time < at[i].time + 2 * half_span - 1e-3)) ++k;
    if (k >= at.size()) break;
    const double h1 = at[j].time - at[i].time, h2 = at[k].time - at[j].time, h = 0.5 * (h1 + h2);
    if (h > 3 * half_span) continue;
    const auto difference = [&](const Vector3d Instant::*p) -> Vector3d {
      return ((at[k].*p - at[j].*p) / h2 - (at[j].*p - at[i].*p) / h1) / h;
    };
    const Vector3d to = difference(&Instant::fix), from = difference(&Instant::path);
    const double sigma = std::hypot(std::hypot(least_force_sigma, force_sigma), 2.45 * fix_sigma / (h1 * h2));
    // Overlapping differences share their fixes: only every 2 h counts as new.
    const double step = i > 0 ? at[i].time - at[i - 1].time : h1;
    const double weight = std::min(1.0, step / (2 * h)) / (sigma * sigma);
    sum += weight * to * from.transpose();
    information += weight * (to.squaredNorm() * Matrix3d::Identity() - to * to.transpose());
    weights += weight;
    ++pairs;
    const Vector3d level = at[j].velocity - up * up.dot(at[j].velocity);
    if (level.norm() < least_speed) continue;
    track += level.normalized() * at[j].forward.transpose();
    // Only about the vertical does the track say anything.
    track_information += up * up.transpose();
    ++tracks;
  }
  if (pairs < 3) return std::nullopt;
  if (tracks > 0) {
    const double weight = 1 / (track_sigma * track_sigma * tracks);
    sum += weight * track;
    information += weight * track_information;
  }
  Solution out;
  out.rotation = rotation_of(sum);
  information += 1e-3 * Matrix3d::Identity();  // an axis that nothing is known about: 1800 deg
  // A constant bias of the accelerometers does not average out: at most sigma^2 (sum of weights) beside the white part's 1.
  out.covariance = (1 + force_sigma * force_sigma * weights) * information.inverse();
  return out;
}

double worst(const Matrix3d& covariance) { return std::sqrt(Eigen::SelfAdjointEigenSolver<Matrix3d>(covariance).eigenvalues().maxCoeff()); }

}  // namespace

double Alignment::worst_sigma() const { return worst(covariance); }

std::vector<Span> find_standstills(const ImuPath& path, const core::GnssData& gnss, const core::ImuErrorModel& spec) {
  std::vector<Span> out;
  const core::ImuData& imu = path.imu;
  size_t k = 0, fix = 0;
  const double bias = 3 * spec.gyro_bias.value + 1e-3;
  for (double t = path.begin(); t + 1.0 <= path.end() + 1e-6; t += 1.0) {
    Vector3d sum[2] = {Vector3d::Zero(), Vector3d::Zero()}, squares[2] = {Vector3d::Zero(), Vector3d::Zero()};
    double n = 0;
    bool bridged = false;
    for (; k < imu.size() && imu.time[k] <= t + 1.0; ++k, ++n) {
      const Vector3d v[2] = {imu.angle[k] / imu.step[k], imu.velocity[k] / imu.step[k]};
      for (int s = 0; s < 2; ++s) {
        sum[s] += v[s];
        squares[s] += v[s].cwiseAbs2();
      }
      bridged = bridged || path.is_bridged(k);
    }
    while (fix < gnss.size() && gnss.time[fix] < t - 1e-6) ++fix;
    size_t last = fix;
    while (last + 1 < gnss.size() && gnss.time[last + 1] <= t + 1.2) ++last;
    if (n < 5 || bridged || last <= fix || last >= gnss.size()) continue;
    const auto spread = [&](int s) { return std::sqrt(std::max(0.0, (squares[s] / n - (sum[s] / n).cwiseAbs2()).maxCoeff())); };
    // White noise of the sensors themselves is no motion.
    const double step = 1.0 / n;
    const double rate_noise = spec.angular_random_walk.value / std::sqrt(step),
                 force_noise = spec.velocity_random_walk.value / std::sqrt(step);
    const double moved = (gnss.position[last] - gnss.position[fix]).norm();
    // Poor fixes cannot show standstill: what they allow for stays below a slow flight.
    const double sure = std::min(most_moved, 0.03 + 3 * std::sqrt(gnss.covariance[fix].trace()));
    const double speed = gnss.has_velocity() && gnss.velocity[fix].allFinite() ? gnss.velocity[fix].norm() : 0.0;
    const bool still = spread(0) < still_rate + 2 * rate_noise && spread(1) < still_force + 2 * force_noise &&
                       (sum[0] / n).norm() < still_rate + bias && moved < sure && speed < 0.1;
    if (!still) continue;
    if (!out.empty() && out.back().last > t - 0.5)
      out.back().last = t + 1.0;
    else
      out.push_back({t, t + 1.0});
  }
  std::erase_if(out, [](const Span& s) { return s.last - s.first < still_least; });
  return out;
}

Alignment align_still(const ImuPath& path, const Span& stretch, const Vector3d& ecef, const core::ImuErrorModel& spec) {
  ImuWalk walk(path, stretch.first);
  Increment piece;
  Vector3d angle = Vector3d::Zero(), velocity = Vector3d::Zero();
  while (walk.next(stretch.last, piece)) {
    angle += piece.angle;
    velocity += piece.velocity;
  }
  const double length = stretch.last - stretch.first;
  const Vector3d rate = angle / length, force = velocity / length;
  const Vector3d gravity = gravity_at(ecef), up = -gravity.normalized(), earth(0, 0, core::wgs84::omega);
  // Triad: up, and east = earth x up.
  const Vector3d body_up = force.normalized();
  const auto triad = [](const Vector3d& first, const Vector3d& second) {
    Matrix3d m;
    m.col(0) = first.normalized();
    m.col(1) = first.cross(second).normalized();
    m.col(2) = m.col(0).cross(m.col(1));
    return m;
  };
  Alignment out;
  out.method = "still";
  out.time = 0.5 * (stretch.first + stretch.last);
  // Gyros that print zeros feel nothing: any heading, with a sigma that says so.
  const bool felt = body_up.cross(rate).norm() > 1e-9;
  out.ecef_R_body = triad(up, earth) * triad(body_up, felt ? rate : Vector3d(body_up.unitOrthogonal())).transpose();
  const auto square = [](double v) { return v * v; };
  const double tilt =
      square(spec.accelerometer_bias.value / gravity.norm()) + square(spec.velocity_random_walk.value) / length / gravity.squaredNorm();
  const double level_rate = (earth - up * up.dot(earth)).norm();
  const double rate_variance =
      square(spec.gyro_bias.value) + square(spec.gyro_drift.value) + square(spec.angular_random_walk.value) / length;
  const double heading = felt ? std::min(square(core::pi), rate_variance / square(std::max(level_rate, 1e-9))) : square(core::pi);
  out.covariance = (tilt + 1e-8) * (Matrix3d::Identity() - up * up.transpose()) + (heading + 1e-8) * up * up.transpose();
  out.gyro_bias = rate - out.ecef_R_body.transpose() * earth;
  return out;
}

std::optional<Alignment> align_moving(const ImuPath& path, const core::GnssData& gnss, const Vector3d& lever,
                                      const core::ImuErrorModel& spec, const Vector3d& gyro_bias) {
  std::optional<Alignment> best;
  if (gnss.size() < 4) return best;
  const double from = gnss.time.front(), until = std::min(gnss.time.back(), from + latest);
  for (double t = from; t == from || t + 0.5 * window <= until; t += hop) {
    const auto first = static_cast<size_t>(std::lower_bound(gnss.time.begin(), gnss.time.end(), t) - gnss.time.begin());
    auto last = static_cast<size_t>(std::upper_bound(gnss.time.begin(), gnss.time.end(), t + window) - gnss.time.begin());
    if (last < first + 4) continue;
    --last;
    if (path.bridged_within(gnss.time[first], gnss.time[last]).seconds > most_bridged) continue;
    const std::vector<Instant> at = collect(path, gnss, first, last, lever, gyro_bias);
    double fix_sigma = 0;
    for (size_t k = first; k <= last; ++k) fix_sigma = std::max(fix_sigma, std::sqrt(gnss.covariance[k].trace() / 3));
    const auto solution = solve(at, -gravity_at(gnss.position[first]).normalized(), fix_sigma, spec.accelerometer_bias.value);
    if (!solution) continue;
    Alignment a;
    a.time = gnss.time[first];
    a.method = "moving";
    a.ecef_R_body = solution->rotation;
    a.gyro_bias = gyro_bias;
    const double drift = spec.gyro_bias.value * window / 2;
    a.covariance = solution->covariance + drift * drift * Matrix3d::Identity();
    if (!best || a.worst_sigma() < best->worst_sigma()) best = a;
    if (worst(solution->covariance) < good_enough) break;
  }
  return best;
}

Alignment carried(const Alignment& from, double time, const ImuPath& path, const core::ImuErrorModel& spec) {
  Alignment out = from;
  ImuWalk walk(path, from.time);
  Increment piece;
  while (walk.next(time, piece)) {
    out.ecef_R_body = turn_z(-core::wgs84::omega * piece.step) * out.ecef_R_body * core::exp_so3(piece.angle - piece.step * from.gyro_bias);
  }
  const double dt = std::abs(walk.time() - from.time);
  const double drift = spec.gyro_bias.value * dt;
  out.time = walk.time();
  out.covariance += (drift * drift + spec.angular_random_walk.value * spec.angular_random_walk.value * dt) * Matrix3d::Identity();
  return out;
}

}  // namespace swath::trajectory
