// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/world/navigation.h"

#include <cmath>

#include "simulate/inertial.h"

namespace swath::test {

using Eigen::Matrix3d;
using Eigen::Vector3d;

namespace {

const core::Geodetic origin{48 * core::degree, 10.5 * core::degree, 600.0};
constexpr double eight_radius = 300.0, eight_rate = 0.05;  // m, rad/s of the figure's parameter
constexpr double ramp = 6.0;                               // s

simulate::PlannedFlight flight_over(const simulate::FlightOptions& options, const simulate::WorldOptions& world, std::int64_t seed = 1) {
  return {options, origin, 950.0, simulate::plan_lines(options, world, core::degrees(20).value, 0.02), 5.2, seed};
}

/// Increments over [t - step, t] by Gauss and Legendre with 4 nodes.
simulate::Increments increments_of(const MotionAt& motion, double t, double step) {
  constexpr std::array<double, 2> x{0.3399810435848563, 0.8611363115940526}, w{0.6521451548625461, 0.3478548451374538};
  simulate::Increments out{Vector3d::Zero(), Vector3d::Zero()};
  for (size_t i = 0; i < 2; ++i)
    for (const double sign : {-1.0, 1.0}) {
      const simulate::Inertial at = simulate::inertial_of(motion(t - 0.5 * step + sign * 0.5 * step * x[i]));
      out.angle += 0.5 * step * w[i] * at.rate;
      out.velocity += 0.5 * step * w[i] * at.force;
    }
  return out;
}

}  // namespace

simulate::PlannedFlight survey_flight(int lines, int cross_lines) {
  simulate::FlightOptions options;
  options.lines = lines;
  options.cross_lines = cross_lines;
  return flight_over(options, {});
}

simulate::PlannedFlight straight_flight(double length) {
  simulate::FlightOptions options;
  options.lines = 1;
  options.cross_lines = 0;
  options.line_length = core::Metres(length);
  return flight_over(options, {});
}

simulate::PlannedFlight craft_flight(double speed, std::int64_t seed) {
  simulate::FlightOptions options;
  options.lines = 3;
  options.cross_lines = 0;
  options.speed = core::MetresPerSecond(speed);
  options.wind = core::MetresPerSecond(0.3 * speed);
  options.line_length = core::Metres(20 * speed);
  options.lead = core::Seconds(3);
  return flight_over(options, {}, seed);
}

MotionAt motion_of(simulate::PlannedFlight flight) {
  return [flight = std::move(flight)](double t) { return flight.motion(t); };
}

Drive::Drive(std::vector<Change> changes, double azimuth, double elevation)
    : changes_(std::move(changes)), azimuth_(azimuth), elevation_(elevation) {}

simulate::Motion Drive::operator()(double t) const {
  // The figure's parameter and its derivatives: each change adds a smooth step of degree 5.
  double w = 0.3, w1 = 0, w2 = 0, speed = 0;
  for (const Change& c : changes_) {
    const double change = (c.speed - speed) * eight_rate, x = (t - c.time) / ramp;
    speed = c.speed;
    if (x <= 0) continue;
    if (x >= 1) {
      w += change * ramp * (x - 0.5);
      w1 += change;
    } else {
      w += change * ramp * x * x * x * x * (x * x - 3 * x + 2.5);
      w1 += change * x * x * x * (6 * x * x - 15 * x + 10);
      w2 += change / ramp * 30 * x * x * (x - 1) * (x - 1);
    }
  }
  // North and east by the parameter, then by time.
  const Eigen::Vector2d p(eight_radius * std::sin(w), 0.5 * eight_radius * std::sin(2 * w));
  const Eigen::Vector2d d(eight_radius * std::cos(w), eight_radius * std::cos(2 * w));
  const Eigen::Vector2d dd(-eight_radius * std::sin(w), -2 * eight_radius * std::sin(2 * w));
  static const double north = core::meridian_radius(origin.latitude),
                      east = core::prime_vertical_radius(origin.latitude) * std::cos(origin.latitude);
  simulate::Motion m;
  const double lat = origin.latitude + p.x() / north, h = origin.height;
  m.pose.position = {lat, origin.longitude + p.y() / east, h};
  const double sin_lat = std::sin(lat), cos_lat = std::cos(lat);
  const double M = core::meridian_radius(lat), N = core::prime_vertical_radius(lat);
  const double root = 1 - core::wgs84::e2 * sin_lat * sin_lat;
  const double M_slope = 3 * M * core::wgs84::e2 * sin_lat * cos_lat / root, N_slope = N * core::wgs84::e2 * sin_lat * cos_lat / root;
  // d/dw of latitude and longitude; velocities by w are what the heading follows, also at a stop.
  const double a = d.x() / north, b = d.y() / east, aa = dd.x() / north, bb = dd.y() / east;
  const double across = (N + h) * cos_lat, across_slope = N_slope * cos_lat - (N + h) * sin_lat;
  const Eigen::Vector2d v((M + h) * a, across * b), vv((M + h) * aa + M_slope * a * a, across * bb + across_slope * a * b);
  m.velocity = {v.x() * w1, v.y() * w1, 0};
  m.acceleration = {vv.x() * w1 * w1 + v.x() * w2, vv.y() * w1 * w1 + v.y() * w2, 0};
  const double turn = (v.x() * vv.y() - v.y() * vv.x()) / v.squaredNorm();
  // The forward axis has these angles in body: body looks to the other side.
  const double heading = std::atan2(v.y(), v.x());
  const Matrix3d vehicle_R_body = core::matrix_of({0, elevation_, 0}).transpose() * core::matrix_of({0, 0, azimuth_}).transpose();
  const core::Attitude mounted = core::attitude_of(vehicle_R_body);
  m.pose.attitude = {mounted.roll, mounted.pitch, core::wrap_two_pi(heading + mounted.heading)};
  m.attitude_rate = {0, 0, turn * w1};
  return m;
}

double Dice::normal() { return std::sqrt(-2.0 * std::log(uniform())) * std::cos(2.0 * core::pi * uniform()); }

Truth truth_at(const MotionAt& motion, double seconds) {
  const simulate::Motion m = motion(seconds);
  const Matrix3d ned = core::ecef_R_ned(m.pose.position.latitude, m.pose.position.longitude);
  return {core::ecef_of(m.pose.position), ned * m.velocity, ned * core::matrix_of(m.pose.attitude)};
}

Records exact_records(const MotionAt& motion, const Sensors& s) {
  Records out;
  const auto steps = static_cast<std::int64_t>(std::floor((s.until - s.from) / s.imu_step + 1e-9));
  for (std::int64_t k = 1; k <= steps; ++k) {
    const double t = s.from + static_cast<double>(k) * s.imu_step;
    const simulate::Increments i = increments_of(motion, t, s.imu_step);
    out.imu.time.push_back(motion_start + t);
    out.imu.step.push_back(s.imu_step);
    out.imu.angle.push_back(i.angle);
    out.imu.velocity.push_back(i.velocity);
  }
  const auto fixes = static_cast<std::int64_t>(std::floor((s.until - s.from) / s.fix_step + 1e-9));
  const Vector3d earth(0, 0, core::wgs84::omega);
  for (std::int64_t k = 0; k <= fixes; ++k) {
    const double t = s.from + static_cast<double>(k) * s.fix_step;
    const simulate::Motion m = motion(t);
    const Truth truth = truth_at(motion, t);
    const Vector3d arm = truth.ecef_R_body * s.lever;
    const Vector3d turning = truth.ecef_R_body * simulate::inertial_of(m).rate.cross(s.lever) - earth.cross(arm);
    out.gnss.time.push_back(motion_start + t);
    out.gnss.position.push_back(truth.position + arm);
    out.gnss.covariance.push_back(Matrix3d::Zero());
    out.gnss.velocity.push_back(truth.velocity + turning);
    out.gnss.velocity_covariance.push_back(Matrix3d::Zero());
    out.gnss.quality.push_back(core::FixQuality::fixed);
    out.gnss.satellites.push_back(12);
  }
  return out;
}

core::ImuData with_errors(const core::ImuData& exact, const core::ImuErrorModel& m, std::uint64_t seed) {
  Dice dice(seed * 7919 + 13);
  core::ImuData out = exact;
  const Vector3d gyro_bias = m.gyro_bias.value * dice.vector(), force_bias = m.accelerometer_bias.value * dice.vector();
  const Vector3d gyro_scale = m.gyro_scale.value * dice.vector(), force_scale = m.accelerometer_scale.value * dice.vector();
  Vector3d gyro_drift = m.gyro_drift.value * dice.vector(), force_drift = m.accelerometer_drift.value * dice.vector();
  const Vector3d one = Vector3d::Ones();
  for (size_t k = 0; k < out.size(); ++k) {
    const double dt = out.step[k], kept = std::exp(-dt / m.drift_time.value), fresh = std::sqrt(1 - kept * kept);
    gyro_drift = kept * gyro_drift + fresh * m.gyro_drift.value * dice.vector();
    force_drift = kept * force_drift + fresh * m.accelerometer_drift.value * dice.vector();
    out.angle[k] = exact.angle[k].cwiseProduct(one + gyro_scale) + dt * (gyro_bias + gyro_drift) +
                   m.angular_random_walk.value * std::sqrt(dt) * dice.vector();
    out.velocity[k] = exact.velocity[k].cwiseProduct(one + force_scale) + dt * (force_bias + force_drift) +
                      m.velocity_random_walk.value * std::sqrt(dt) * dice.vector();
  }
  return out;
}

core::GnssData with_errors(const core::GnssData& exact, const FixErrors& e, std::uint64_t seed) {
  Dice dice(seed * 104729 + 7), strays(seed * 31337 + 3);
  core::GnssData out = exact;
  Vector3d slow = dice.vector();
  const Vector3d sigma(e.horizontal, e.horizontal, e.vertical);
  for (size_t k = 0; k < out.size(); ++k) {
    const double dt = k > 0 ? out.time[k] - out.time[k - 1] : 0.0, kept = std::exp(-dt / e.time);
    slow = kept * slow + std::sqrt(1 - kept * kept) * dice.vector();
    const core::Geodetic g = core::geodetic_of(exact.position[k]);
    const Matrix3d ned = core::ecef_R_ned(g.latitude, g.longitude);
    out.position[k] += ned * sigma.cwiseProduct(std::sqrt(e.share) * slow + std::sqrt(1 - e.share) * dice.vector());
    out.covariance[k] = ned * sigma.cwiseAbs2().asDiagonal() * ned.transpose();
    out.velocity[k] += e.speed * dice.vector();
    out.velocity_covariance[k] = e.speed * e.speed * Matrix3d::Identity();
    const double stray = strays.uniform();
    const Vector3d where = strays.vector();
    if (stray < e.outliers) out.position[k] += e.outlier * where.normalized();
  }
  if (!e.velocity) {
    out.velocity.clear();
    out.velocity_covariance.clear();
  }
  return out;
}

core::GnssData keep_fixes(const core::GnssData& gnss, const std::function<bool(size_t)>& wanted) {
  core::GnssData out;
  for (size_t k = 0; k < gnss.size(); ++k) {
    if (!wanted(k)) continue;
    out.time.push_back(gnss.time[k]);
    out.position.push_back(gnss.position[k]);
    out.covariance.push_back(gnss.covariance[k]);
    if (gnss.has_velocity()) {
      out.velocity.push_back(gnss.velocity[k]);
      out.velocity_covariance.push_back(gnss.velocity_covariance[k]);
    }
    out.quality.push_back(gnss.quality[k]);
    out.satellites.push_back(gnss.satellites[k]);
  }
  return out;
}

core::GnssData without(const core::GnssData& gnss, double from, double until) {
  return keep_fixes(gnss, [&](size_t k) { return gnss.time[k] < motion_start + from || gnss.time[k] >= motion_start + until; });
}

Error6 error_of(const core::TrajectoryData& d, size_t k, const MotionAt& motion) {
  const Truth truth = truth_at(motion, d.time[k] - motion_start);
  const core::Geodetic g{d.latitude[k], d.longitude[k], d.height[k]};
  const Matrix3d ned = core::ecef_R_ned(g.latitude, g.longitude);
  const core::Attitude a = core::attitude_of(ned.transpose() * truth.ecef_R_body);
  Error6 out;
  out.head<3>() = ned.transpose() * (core::ecef_of(g) - truth.position);
  out.tail<3>() << d.roll[k] - a.roll, d.pitch[k] - a.pitch, core::wrap_pi(d.heading[k] - a.heading);
  return out;
}

Error6 sigma_of(const core::TrajectoryData& d, size_t k) {
  Error6 out;
  out << d.sigma_north[k], d.sigma_east[k], d.sigma_down[k], d.sigma_roll[k], d.sigma_pitch[k], d.sigma_heading[k];
  return out;
}

}  // namespace swath::test
