// SPDX-License-Identifier: GPL-3.0-or-later
// Velocity over the ground from two positions of a trajectory.
#pragma once

#include <cmath>

#include "core/geo/frames.h"
#include "core/geo/geodesy.h"
#include "core/records/trajectory_data.h"

namespace swath::trajectory {

struct GroundVelocity {
  double north = 0.0, east = 0.0;  ///< m/s
};

/// Mean from record i to j; not finite where their times are the same.
inline GroundVelocity ground_velocity(const core::TrajectoryData& d, size_t i, size_t j) {
  const double dt = d.time[j] - d.time[i];
  const double latitude = 0.5 * (d.latitude[i] + d.latitude[j]);
  const double north = (core::meridian_radius(latitude) + d.height[i]) * (d.latitude[j] - d.latitude[i]);
  const double east =
      (core::prime_vertical_radius(latitude) + d.height[i]) * std::cos(latitude) * core::wrap_pi(d.longitude[j] - d.longitude[i]);
  return {north / dt, east / dt};
}

}  // namespace swath::trajectory
