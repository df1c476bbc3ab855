// SPDX-License-Identifier: GPL-3.0-or-later
// The reference flights of the Kalman interpolator and the options that each of its variants stands for.
#pragma once

#include <filesystem>
#include <sstream>
#include <string>

#include "core/config/value.h"
#include "tests/world/support.h"
#include "trajectory/kinematic.h"

namespace swath::trajectory::test {

/// Rows of time, X, Y, Z and the upper triangle of the covariance, after a header line.
inline PointFixes read_fixes(const std::filesystem::path& file) {
  std::istringstream in(swath::test::read_bytes(file));
  PointFixes out;
  std::string line;
  std::getline(in, line);
  while (std::getline(in, line)) {
    for (char& c : line)
      if (c == ',') c = ' ';
    std::istringstream row(line);
    double v[10];
    for (double& x : v) row >> x;
    out.time.push_back(v[0]);
    out.position.emplace_back(v[1], v[2], v[3]);
    Eigen::Matrix3d c;
    c << v[4], v[5], v[6], v[5], v[7], v[8], v[6], v[8], v[9];
    out.covariance.push_back(c);
  }
  return out;
}

inline KinematicOptions options_of(const core::Value& variant) {
  const auto is = [&](const char* key, const char* value) { return variant.find(key)->as_text() == value; };
  KinematicOptions o;
  o.axes = is("mode", "axis") ? AxesForm::axis : AxesForm::simultaneous;
  o.line_weights = is("init", "wls") ? LineWeights::weighted : LineWeights::ordinary;
  o.start_covariance = is("p0", "apriori")       ? StartCovariance::a_priori
                       : is("p0", "aposteriori") ? StartCovariance::a_posteriori
                                                 : StartCovariance::diffuse;
  o.update_first = is("first", "update");
  o.noise = is("q", "speed") ? NoiseSpeed::speed : NoiseSpeed::axis;
  o.noise_floor = core::MetresPerSecond(variant.find("qfloor") ? variant.find("qfloor")->as_number() : 0.0);
  o.noise_grows_with_time = is("qtime", "dt");
  return o;
}

inline Eigen::Vector3d vector3(const core::Value& v) {
  return {v.items()[0].as_number(), v.items()[1].as_number(), v.items()[2].as_number()};
}

/// States of the reference are x, vx, y, vy, z, vz; ours x, y, z, vx, vy, vz: place of our k-th component there.
constexpr int place[6] = {0, 2, 4, 1, 3, 5};

inline PointState::Vector6 state6(const core::Value& v) {
  PointState::Vector6 out;
  for (int k = 0; k < 6; ++k) out[k] = v.items()[static_cast<size_t>(place[k])].as_number();
  return out;
}
inline PointState::Matrix6 matrix6(const core::Value& v) {
  PointState::Matrix6 out;
  for (int i = 0; i < 6; ++i)
    for (int j = 0; j < 6; ++j) out(i, j) = v.items()[static_cast<size_t>(place[i])].items()[static_cast<size_t>(place[j])].as_number();
  return out;
}

}  // namespace swath::trajectory::test
