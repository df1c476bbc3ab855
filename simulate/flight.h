// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <string>
#include <vector>

#include "core/frames.h"
#include "core/geodesy.h"
#include "simulate/options.h"

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
};

/// A line to fly in the local plane (true north, east; m).
struct LinePlan {
  Eigen::Vector2d from, to;
  std::string name;
};

/// The lines of the options about the area's middle. `convergence`: bearing of grid north from true north, rad.
std::vector<LinePlan> plan_lines(const FlightOptions& flight, const WorldOptions& world, double half_angle, double convergence);

/// A flight along straight lines joined by turns whose bank grows and falls smoothly (course three times differentiable), with wind,
/// crab and turbulence as sums of sines: an analytic function of time.
class Flight {
 public:
  /// Height above the ellipsoid; the plane's origin; lines in their order.
  Flight(const FlightOptions& options, const core::Geodetic& origin, double height, const std::vector<LinePlan>& plan, double wind_from,
         std::int64_t seed);

  double duration() const { return duration_; }
  const std::vector<Line>& lines() const { return lines_; }
  Pose pose(double t) const;
  Motion motion(double t) const;

 private:
  /// Stretch on which the course rate goes from r0 to r1 by a smooth step of degree 7.
  struct Piece {
    double start, duration, course, r0, r1;
    std::vector<Eigen::Vector2d> knots;  // position at whole steps of the piece; only the first where it is straight
  };
  struct Course {
    double angle, rate, acceleration;
  };
  struct Wave {
    double amplitude, omega, phase;
  };
  struct Swing {
    double value = 0, rate = 0, acceleration = 0;
  };

  static Course course_of(const Piece& piece, double since);
  Eigen::Vector2d advance(const Piece& piece, double from, double to) const;
  void add_piece(double duration, double r0, double r1);
  void add_turn(double angle);
  std::vector<double> turn_plan(double angle) const;
  Eigen::Vector2d turn_displacement(double angle, double& seconds) const;
  void fly_to(const Eigen::Vector2d& target, double course);
  const Piece& piece_at(double t) const;
  static Swing swing_of(const std::vector<Wave>& waves, double t);
  Eigen::Vector2d plane_position(const Piece& piece, double t) const;

  FlightOptions options_;
  core::Geodetic origin_;
  double height_, wind_from_, metres_per_latitude_, metres_per_longitude_;
  double turn_rate_, ramp_ = 4.0;
  std::vector<Piece> pieces_;
  Eigen::Vector2d at_ = Eigen::Vector2d::Zero();  // end of the pieces so far
  double course_ = 0.0, duration_ = 0.0;
  std::vector<Line> lines_;
  std::vector<Wave> shake_[6];  // north, east, up, roll, pitch, heading
};

}  // namespace swath::simulate
