// SPDX-License-Identifier: GPL-3.0-or-later
// What the tests of calib share: poses from Euler angles, a curved flight, all scanner models.
#pragma once

#include <cmath>

#include "core/geo/frames.h"
#include "core/geo/geodesy.h"
#include "core/records/sensor.h"
#include "core/shot.h"
#include "trajectory/trajectory.h"

namespace swath::calib::test {

constexpr double deg = core::degree;

constexpr core::ScannerModel all_models[] = {core::ScannerModel::mirror, core::ScannerModel::polygon, core::ScannerModel::profile,
                                             core::ScannerModel::beam,   core::ScannerModel::conical, core::ScannerModel::palmer};

inline core::Scanner scanner_of(core::ScannerModel m, bool air) {
  core::Scanner s;
  s.model = m;
  s.air = air ? core::AirModel::ciddor : core::AirModel::none;
  s.at_sensor.temperature = core::Kelvin(281.65);
  s.at_sensor.pressure = core::Pascals(89875.0);
  return s;
}

inline core::Calibration some_calibration() {
  core::Calibration c;
  c.roll = core::degrees(0.3);
  c.pitch = core::degrees(-0.5);
  c.heading = core::degrees(1.2);
  c.lever_arm_scanner = {core::Metres(0.2), core::Metres(-0.1), core::Metres(0.35)};
  c.range_offset = core::Metres(0.04);
  c.range_scale = 1.00003;
  c.scan_offset = core::degrees(0.02);
  c.scan_scale = 1.0004;
  c.latency = core::Seconds(0.0021);
  return c;
}

/// Pose of a body that stands in geodetic place and Euler attitude, with given velocity (NED) and rates.
inline trajectory::Pose pose_of(const core::Geodetic& g, const core::Attitude& a, const Eigen::Vector3d& ned_velocity,
                                const Eigen::Vector3d& rate) {
  const Eigen::Matrix3d ned = core::ecef_R_ned(g.latitude, g.longitude);
  return {core::ecef_of(g), ned * core::matrix_of(a), ned * ned_velocity, rate};
}

/// Twelve seconds at 200 Hz with turbulence, heading swinging through 180 deg, 60 m/s, with sigmas.
inline core::TrajectoryData curved_flight(double start, double height) {
  core::TrajectoryData d;
  for (int i = 0; i <= 2400; ++i) {
    const double s = i * 0.005;
    d.time.push_back(start + s);
    d.latitude.push_back((47.9 - s * 60.0 / 111200.0) * deg);
    d.longitude.push_back((10.5 + s * s * 2e-6) * deg);
    d.height.push_back(height + 2.0 * std::sin(0.8 * s));
    d.roll.push_back(3.0 * deg * std::sin(1.7 * s));
    d.pitch.push_back(2.0 * deg + 1.0 * deg * std::cos(2.3 * s));
    d.heading.push_back(core::wrap_two_pi((180.0 + 4.0 * std::sin(0.9 * s)) * deg));
    d.sigma_north.push_back(0.03f), d.sigma_east.push_back(0.02f), d.sigma_down.push_back(0.05f);
    d.sigma_roll.push_back(static_cast<float>(0.003 * deg)), d.sigma_pitch.push_back(static_cast<float>(0.002 * deg));
    d.sigma_heading.push_back(static_cast<float>(0.006 * deg));
  }
  return d;
}

/// A zigzag scan of n returns, one per record, from `start` on.
inline core::Shots zigzag(size_t n, double start, double rate, double range) {
  core::Shots s;
  for (size_t i = 0; i < n; ++i) {
    const double t = static_cast<double>(i) / rate;
    s.time.push_back(start + t);
    s.angle.push_back(20.0 * deg * std::sin(2.0 * core::pi * 30.0 * t));
    s.range.push_back(range / std::cos(s.angle.back()) + 10.0 * std::sin(5.0 * t));
    s.intensity.push_back(static_cast<std::uint16_t>(i % 1000));
    s.return_number.push_back(1);
    s.return_count.push_back(1);
    s.flags.push_back(0);
    s.record.push_back(static_cast<std::uint32_t>(i));
  }
  return s;
}

}  // namespace swath::calib::test
