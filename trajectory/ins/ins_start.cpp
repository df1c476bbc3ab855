// SPDX-License-Identifier: GPL-3.0-or-later
#include "trajectory/ins/ins_start.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "core/error.h"
#include "core/geo/frames.h"
#include "core/geo/geodesy.h"
#include "trajectory/ins/imu_walk.h"

namespace swath::trajectory {

using Eigen::Matrix3d;
using Eigen::Vector3d;

namespace {

constexpr double near_fix = 2.0;  // s: a start as near to a fix takes its position

}  // namespace

Alignment align(const ImuPath& path, const core::GnssData& gnss, const core::ImuErrorModel& spec, const Vector3d& lever,
                const std::vector<Span>& standstills, const InsGnssOptions& options) {
  if (options.alignment == AlignmentMethod::given) {
    const core::Geodetic g = core::geodetic_of(gnss.position.front());
    const Matrix3d ned = core::ecef_R_ned(g.latitude, g.longitude);
    Alignment out;
    out.method = "given";
    out.time = path.begin();
    out.ecef_R_body = ned * core::matrix_of({options.given.roll.value, options.given.pitch.value, options.given.heading.value});
    const double level = options.given.sigma_roll_pitch.value, heading = options.given.sigma_heading.value;
    out.covariance = ned * Vector3d(level * level, level * level, heading * heading).asDiagonal() * ned.transpose();
    return out;
  }
  std::optional<Alignment> still;
  constexpr double compass = 5 * core::degree;  // better than this, gyrocompassing needs no motion
  for (const Span& s : standstills) {
    const auto fix = std::min<size_t>(
        static_cast<size_t>(std::lower_bound(gnss.time.begin(), gnss.time.end(), s.first) - gnss.time.begin()), gnss.size() - 1);
    const Alignment a = align_still(path, s, gnss.position[fix], spec);
    if (!still || a.worst_sigma() < still->worst_sigma()) still = a;
  }
  if (options.alignment == AlignmentMethod::still && !still)
    throw core::Error("no standstill to align on", "trajectory.ins_gnss", "choose alignment = \"moving\" or \"given\"");
  const bool automatic = options.alignment == AlignmentMethod::automatic;
  if (still && (options.alignment == AlignmentMethod::still || (automatic && still->worst_sigma() < compass))) return *still;
  const std::optional<Alignment> moving = align_moving(path, gnss, lever, spec, still && automatic ? still->gyro_bias : Vector3d::Zero());
  if (!moving)
    throw core::Error("the fixes are too few or too far apart, or the IMU has too many gaps, to find the attitude", "trajectory.ins_gnss",
                      "state it: alignment = \"given\", with given.roll, given.pitch and given.heading");
  return *moving;
}

namespace {

/// Position and velocity at an instant near fixes: a straight line through those within 1.5 s.
void set_motion(NavState& nav, const core::GnssData& gnss, size_t at, const Vector3d& lever) {
  double n = 0, t1 = 0, t2 = 0;
  Vector3d p1 = Vector3d::Zero(), tp = Vector3d::Zero();
  const double origin = gnss.time[at];
  for (size_t k = at; k < gnss.size() && (gnss.time[k] <= origin + 1.5 || k < at + 3); ++k) {
    const double t = gnss.time[k] - origin;
    n += 1;
    t1 += t;
    t2 += t * t;
    p1 += gnss.position[k] - gnss.position[at];
    tp += t * (gnss.position[k] - gnss.position[at]);
  }
  const double d = n * t2 - t1 * t1;
  nav.velocity = d > 0 ? Vector3d((n * tp - t1 * p1) / d) : Vector3d::Zero();
  nav.position = gnss.position[at] + nav.velocity * (nav.time - origin) - nav.ecef_R_body * lever;
}

}  // namespace

Start start_of(const ImuPath& path, const core::GnssData& gnss, const Alignment& alignment, const core::ImuErrorModel& spec,
               const Layout& l, const Vector3d& lever, double lever_sigma, const InsGnssOptions& options) {
  Start out;
  Estimate& e = out.estimate;
  e.lever = lever;
  const double first = gnss.time.front(), lead = first - path.begin();
  const bool near = lead < near_fix;
  const Alignment a = carried(alignment, near ? path.begin() : first, path, spec);
  e.nav.time = a.time;
  e.nav.ecef_R_body = a.ecef_R_body;
  set_motion(e.nav, gnss, 0, lever);
  if (!near) {
    ImuWalk walk(path, a.time);
    Increment piece;
    const Vector3d bias = a.gyro_bias;
    while (walk.next(path.begin(), piece)) {
      piece.angle -= piece.step * bias;
      advance(e.nav, piece);
    }
  }
  e.nav.time = path.begin();

  StateMatrix& P = out.covariance;
  P = StateMatrix::Zero(l.size, l.size);
  const auto put = [&P](int row, double sigma) {
    if (row >= 0) P.diagonal().segment<3>(row).setConstant(sigma * sigma);
  };
  // Dead reckoning back over `lead` seconds with an attitude of a few degrees.
  const double away = near ? 0.0 : lead;
  const double tilt = std::max(1 * core::degree, alignment.worst_sigma());
  put(Layout::position, 10.0 + 0.5 * 9.8 * tilt * away * away);
  put(Layout::velocity, 3.0 + 9.8 * tilt * away);
  constexpr double slack = 1.0 * core::degree;  // what the alignment does not report of itself
  const double widest = core::pi / 3;
  out.attitude_given = options.alignment == AlignmentMethod::given;
  P.block<3, 3>(Layout::attitude, Layout::attitude) =
      out.attitude_given ? alignment.covariance : Matrix3d(4 * a.covariance + slack * slack * Matrix3d::Identity());
  for (int i = 0; i < 3; ++i) {
    double& variance = P(Layout::attitude + i, Layout::attitude + i);
    if (variance <= widest * widest) continue;
    P.row(Layout::attitude + i) *= widest / std::sqrt(variance);
    P.col(Layout::attitude + i) *= widest / std::sqrt(variance);
    variance = widest * widest;
  }
  put(Layout::gyro_bias, std::hypot(spec.gyro_bias.value, spec.gyro_drift.value));
  put(Layout::force_bias, std::hypot(spec.accelerometer_bias.value, spec.accelerometer_drift.value));
  put(l.gyro_scale, spec.gyro_scale.value);
  put(l.force_scale, spec.accelerometer_scale.value);
  put(l.lever, lever_sigma);
  put(l.fix, 1.0);
  if (l.latency >= 0) P(l.latency, l.latency) = options.latency_sigma.value * options.latency_sigma.value;
  constexpr double axis_sigma = 5 * core::degree;
  if (l.track >= 0) P.diagonal().segment<2>(l.track).setConstant(axis_sigma * axis_sigma);
  return out;
}

StateVector stated_mean(const Estimate& stated, const Estimate& reference, const Layout& l, bool attitude) {
  StateVector mean = stated.minus(reference, l);
  mean.head<6>().setZero();
  if (!attitude) mean.segment<3>(Layout::attitude).setZero();
  if (l.fix >= 0) mean.segment<3>(l.fix) = -reference.fix;
  return mean;
}

StateMatrix widened(const StateMatrix& stated, const StateVector& smoothed_sigma, bool attitude) {
  StateMatrix out = stated;
  const Matrix3d known = stated.block<3, 3>(Layout::attitude, Layout::attitude);
  out.topLeftCorner<9, 9>().setZero();
  for (int i = 0; i < 9; ++i)
    out(i, i) = std::min(stated(i, i), 100 * std::max(smoothed_sigma[i] * smoothed_sigma[i], 1e-6 * stated(i, i)));
  if (attitude) out.block<3, 3>(Layout::attitude, Layout::attitude) = known;
  return out;
}

}  // namespace swath::trajectory
