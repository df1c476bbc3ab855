// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <vector>

namespace swath::core {

/// A trajectory as recorded: IMU centre and attitude of `body` over time. Columns of one length; the optional ones may be empty.
struct TrajectoryData {
  std::vector<double> time;                         ///< GPS time, s
  std::vector<double> latitude, longitude, height;  ///< rad, rad, ellipsoidal m (WGS84)
  std::vector<double> roll, pitch, heading;         ///< rad; heading from true north, clockwise (wander removed)
  std::vector<double> v_north, v_east, v_down;      ///< m/s; may be empty
  // One-sigma uncertainties; all empty where the file has none.
  std::vector<float> sigma_north, sigma_east, sigma_down;     ///< m
  std::vector<float> sigma_roll, sigma_pitch, sigma_heading;  ///< rad

  size_t size() const { return time.size(); }
  bool has_sigma() const { return !sigma_north.empty(); }
  bool has_velocity() const { return !v_north.empty(); }
};

}  // namespace swath::core
