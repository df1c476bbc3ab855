// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <vector>

#include "core/records/trajectory_data.h"
#include "simulate/flight.h"
#include "simulate/smooth_spline.h"

namespace swath::simulate {

/// A flight along a recorded trajectory: splines through its position (in a local plane) and attitude. Records and truth come from the
/// splines, so that they agree exactly; departure() returns how far they are from the file.
class RecordedFlight : public Flight {
 public:
  /// Checked records (rising times, finite values) and the splines' knot spacing, s. The flight begins at the first record and ends a
  /// whole number of seconds later; it is one line. Throws Error where the records last less than two seconds, or pass a pole.
  RecordedFlight(const core::TrajectoryData& records, double knot_spacing);

  double duration() const override { return duration_; }
  const std::vector<Line>& lines() const override { return lines_; }
  Pose pose(double t) const override { return motion(t).pose; }
  Motion motion(double t) const override;

  /// Splines minus records: north, east, up (m), roll, pitch, heading (rad).
  struct Departure {
    std::array<double, 6> rms{}, worst{};
  };
  const Departure& departure() const { return departure_; }

 private:
  LocalPlane plane_;  // before the spline, which is fitted in it
  SmoothSpline spline_;
  double duration_;
  std::vector<Line> lines_;
  Departure departure_;
};

}  // namespace swath::simulate
