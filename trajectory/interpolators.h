// SPDX-License-Identifier: GPL-3.0-or-later
// The ways of getting a position between fixes, each with the sigma of its error.
#pragma once

#include <array>
#include <string_view>
#include <vector>

#include "core/config/option.h"
#include "core/records/gnss_data.h"
#include "trajectory/flight_pieces.h"
#include "trajectory/kinematic.h"
#include "trajectory/point_smoother.h"

namespace swath::trajectory {

enum class Interpolator { kalman, line, parabola, rts };
constexpr std::array<Interpolator, 4> interpolators{Interpolator::kalman, Interpolator::line, Interpolator::parabola, Interpolator::rts};
/// As tables head their columns: "Kalman", "straight line" ...
std::string_view title_of(Interpolator i);

/// A record of fixes, cut into pieces, with the motion that they show.
struct PointTrack {
  PointFixes fixes;
  double longest_step = 0.0;  ///< between fixes, that is not a gap, s
  std::vector<FlightPiece> pieces;
  PointSmoother smoother;

  const MotionModel& model() const { return smoother.model(); }
};
/// Three fixes or more. `lines`: the stated flight lines, or none: then pieces are by course.
PointTrack track_of(PointFixes fixes, const std::vector<LineSpan>& lines, const KinematicOptions& options);

struct Estimate {
  /// With the covariance that the interpolator itself states: the Kalman filter's follows from its noise rule, not from the flight.
  PointState state;
  /// Mean square of its error, given all fixes, without their slow error: the smoother's covariance and the square of what the interpolator
  /// is off the smoother.
  PointState::Matrix6 error;
};
/// At t in a window that is reached().
Estimate estimate_at(const PointTrack& track, const FixWindow& window, double t, Interpolator method, const KinematicOptions& options);
/// At fix i from the others; `window`: without it.
Estimate estimate_without(const PointTrack& track, size_t i, const FixWindow& window, Interpolator method, const KinematicOptions& options);

/// The stated covariance of the fixes at t, from the two around it.
Eigen::Matrix3d stated_at(const PointFixes& fixes, double t);

}  // namespace swath::trajectory

namespace swath::core {
template <>
struct Choices<trajectory::Interpolator> {
  static constexpr std::array<std::string_view, 4> names{"kalman", "line", "parabola", "rts"};
};
}  // namespace swath::core
