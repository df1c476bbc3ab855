// SPDX-License-Identifier: GPL-3.0-or-later
// A flight through turbulence with its exact positions, and the fixes of a GNSS receiver on it.
#pragma once

#include <Eigen/Cholesky>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <random>

#include "trajectory/fix_window.h"

namespace swath::trajectory::test {

/// 60 m/s along one course, shaken by sums of sines from 0.02 to 0.5 Hz; local east, north, up.
class MadeFlight {
 public:
  /// `roughness`: rms of the acceleration of each axis, m/s^2.
  explicit MadeFlight(std::uint64_t seed, double roughness = 0.25) : random_(seed) {
    const double course = 2.0 * std::numbers::pi * uniform();
    velocity_ = {60.0 * std::sin(course), 60.0 * std::cos(course), 0.5 * (uniform() - 0.5)};
    for (auto& axis : waves_)
      for (Wave& w : axis) {
        const double omega = 2.0 * std::numbers::pi * 0.02 * std::pow(25.0, uniform());
        w = {roughness * std::sqrt(2.0 / waves) / (omega * omega), omega, 2.0 * std::numbers::pi * uniform()};
      }
  }
  Eigen::Vector3d position(double t) const {
    Eigen::Vector3d p = velocity_ * t;
    for (int k = 0; k < 3; ++k)
      for (const Wave& w : waves_[k]) p[k] += w.amplitude * std::sin(w.omega * t + w.phase);
    return p;
  }
  Eigen::Vector3d velocity(double t) const {
    Eigen::Vector3d v = velocity_;
    for (int k = 0; k < 3; ++k)
      for (const Wave& w : waves_[k]) v[k] += w.amplitude * w.omega * std::cos(w.omega * t + w.phase);
    return v;
  }
  /// n fixes at `rate` per second: 1.6, 2.4 and 4 cm with correlations, all known to the fixes; times off by `clock` (s), which is not.
  PointFixes fixes(size_t n, double rate, double clock = 0.0005) {
    Eigen::Matrix3d c;
    c << 2.6e-4, 1.0e-4, -2.2e-4, 1.0e-4, 5.8e-4, 3.8e-4, -2.2e-4, 3.8e-4, 1.6e-3;
    const Eigen::Matrix3d root = c.llt().matrixL();
    PointFixes out;
    for (size_t i = 0; i < n; ++i) {
      const double t = static_cast<double>(i) / rate;
      const Eigen::Vector3d e(normal(), normal(), normal());
      out.position.push_back(position(t) + root * e);
      out.time.push_back(t + clock * normal());
      out.covariance.push_back(c);
    }
    return out;
  }
  double uniform() { return (static_cast<double>(random_() >> 11) + 0.5) * 0x1p-53; }
  double normal() { return std::sqrt(-2.0 * std::log(uniform())) * std::cos(2.0 * std::numbers::pi * uniform()); }

 private:
  struct Wave {
    double amplitude, omega, phase;
  };
  std::mt19937_64 random_;
  Eigen::Vector3d velocity_;
  static constexpr int waves = 12;
  Wave waves_[3][waves];
};

}  // namespace swath::trajectory::test
