// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "calib/adjust/calibrate.h"
#include "calib/adjust/flown_lines.h"
#include "io/survey/survey.h"
#include "trajectory/ins/error_model.h"

namespace swath::calib {

/// The flight of a survey, ready to be adjusted. It must not outlive the shots or the trajectory.
struct PreparedFlight {
  /// Reads the flight and its control once; what looks wrong with the lines is counted, or refused (core::Error).
  PreparedFlight(const io::Survey& survey, ShotStream shots, int threads, const trajectory::Trajectory& flown,
                 const trajectory::ErrorModelOptions& options, core::Tally& tally);

  trajectory::ErrorModel errors;
  std::vector<FlownLine> lines;
  CalibrationFlight flight;  ///< points at the members above
  PreparedFlight(const PreparedFlight&) = delete;

  /// Side of cells wide enough for a plane through one line's returns, in whole half metres.
  double cell() const;
};

}  // namespace swath::calib
