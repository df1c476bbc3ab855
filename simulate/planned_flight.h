// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <string>
#include <vector>

#include "simulate/flight.h"
#include "simulate/line_plan.h"
#include "simulate/options.h"

namespace swath::simulate {

/// A flight along straight lines joined by turns whose bank grows and falls smoothly (course three times differentiable), with wind,
/// crab and turbulence as sums of sines: an analytic function of time. Between lines of different heights it climbs or sinks by a smooth
/// step, on the way from one line to the next, in as many full circles before that as the steepest climb needs. With `still` it begins at
/// rest on the ground, its centre 2 m above it: speed grows by a smooth step, then height does, and wind and turbulence set in; all on the
/// first line's course.
class PlannedFlight : public Flight {
 public:
  /// The plane's origin; height of lines of level 0 above the ellipsoid; lines in their order.
  PlannedFlight(const FlightOptions& options, const core::Geodetic& origin, double height, const std::vector<LinePlan>& plan,
                double wind_from, std::int64_t seed);

  double duration() const override { return duration_; }
  const std::vector<Line>& lines() const override { return lines_; }
  Pose pose(double t) const override;
  Motion motion(double t) const override;

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
  /// A value with its derivatives.
  struct Swing {
    double value = 0, rate = 0, acceleration = 0;
  };
  /// From rest to the first line: seconds of its parts.
  struct Departure {
    double still = 0, run = 0, climb = 0;
    double duration() const { return still + run + climb; }
  };
  /// A smooth step of height, m above the lines of level 0.
  struct Climb {
    double start, duration, from, to;
  };

  static Course course_of(const Piece& piece, double since);
  Eigen::Vector2d advance(const Piece& piece, double from, double to) const;
  void add_departure(const Eigen::Vector2d& entry, double course, double level);
  void add_piece(double duration, double r0, double r1);
  void add_turn(double angle);
  std::vector<double> turn_plan(double angle) const;
  Eigen::Vector2d turn_displacement(double angle, double& seconds) const;
  void fly_to(const Eigen::Vector2d& target, double course);
  void climb_to(const Eigen::Vector2d& target, double course, double from, double to);
  const Piece& piece_at(double t) const;
  static Swing swing_of(const std::vector<Wave>& waves, double t);
  /// Speed, height above level 0 and share of wind and turbulence, with their derivatives.
  Swing speed_at(double t) const;
  Swing climb_at(double t) const;
  Swing share_at(double t) const;
  Eigen::Vector2d plane_position(const Piece& piece, double t) const;

  FlightOptions options_;
  LocalPlane plane_;
  double height_, wind_from_;
  double turn_rate_, ramp_ = 4.0;
  Departure departure_;
  std::vector<Piece> pieces_;
  std::vector<Climb> climbs_;  // by start
  double first_level_ = 0.0;
  Eigen::Vector2d at_ = Eigen::Vector2d::Zero();  // end of the pieces so far
  double course_ = 0.0, duration_ = 0.0;
  std::vector<Line> lines_;
  std::vector<Wave> shake_[6];  // north, east, up, roll, pitch, heading
};

}  // namespace swath::simulate
