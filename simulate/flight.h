// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "core/geo/frames.h"
#include "core/geo/geodesy.h"

namespace swath::simulate {

struct Pose {
  core::Geodetic position;  ///< IMU centre
  core::Attitude attitude;  ///< of body; heading in [0, 2 pi)
};

/// Pose with its exact time derivatives.
struct Motion {
  Pose pose;
  Eigen::Vector3d velocity;       ///< north, east, down, m/s
  Eigen::Vector3d acceleration;   ///< d/dt of those three components, m/s^2
  Eigen::Vector3d attitude_rate;  ///< d/dt of roll, pitch, heading, rad/s
};

/// One surveyed line, seconds from the start of the flight.
struct Line {
  int id;
  std::string name;
  double start, end;
  bool scans = true;  ///< false: the mirror stands still at nadir
};

/// A motion whose pose is a function of time with two continuous derivatives at least, all of them known exactly.
class Flight {
 public:
  virtual ~Flight() = default;

  /// A whole number of seconds, so that records of every usual rate end together.
  virtual double duration() const = 0;
  virtual const std::vector<Line>& lines() const = 0;
  virtual Pose pose(double t) const = 0;
  virtual Motion motion(double t) const = 0;
};

/// Latitude and longitude times constants (the radii at one place): a plane whose lines are straight to 0.1 m per km and in which every
/// derivative is closed.
class LocalPlane {
 public:
  /// Radii at the origin's latitude, for the given height.
  LocalPlane(const core::Geodetic& origin, double height);

  /// `plane`: north, east from the origin, height above the ellipsoid; m.
  core::Geodetic geodetic_of(const Eigen::Vector3d& plane) const;
  Eigen::Vector3d plane_of(const core::Geodetic& position) const;

  /// What is moved: plane coordinates and roll, pitch, heading, with their derivatives.
  struct State {
    Eigen::Vector3d position, velocity, acceleration;  ///< m, m/s, m/s^2
    Eigen::Vector3d attitude, attitude_rate;           ///< rad, rad/s
  };
  Motion motion_of(const State& state) const;

 private:
  core::Geodetic origin_;
  double metres_per_latitude_, metres_per_longitude_;
};

}  // namespace swath::simulate
