// SPDX-License-Identifier: GPL-3.0-or-later
// What the stages that adjust a flight do alike before and after.
#pragma once

#include <filesystem>
#include <vector>

#include "calib/adjust/calibrate.h"
#include "calib/adjust/flown_lines.h"
#include "calib/report/calibration_report.h"
#include "calib/ties/line_heights.h"
#include "stages/calibration_views.h"
#include "stages/stage.h"
#include "trajectory/ins/error_model.h"

namespace swath::stages {

/// Options that stages share which adjust a flight and report on it.
struct FlightStageOptions {
  trajectory::ErrorModelOptions errors;
  calib::LineHeightOptions differences;
  int sections = 4;
};

template <class V>
void describe(FlightStageOptions& o, V& v) {
  v.table("errors", o.errors, "Errors of trajectories that state no covariances between instants.");
  v.table("differences", o.differences, "Maps of the differences of overlapping lines.");
  v.option("sections", o.sections, core::within(0, 50), "Cross sections drawn in the report.");
}

std::vector<std::filesystem::path> control_files(const io::Survey& survey);

/// The flight of a context as calib/ takes it. It must not outlive the context or the trajectory.
struct PreparedFlight {
  /// Reads the flight and its control once; what looks wrong with the lines is counted, or refused (core::Error).
  PreparedFlight(const Context& context, const trajectory::Trajectory& flown, const trajectory::ErrorModelOptions& options,
                 core::Tally& tally);

  trajectory::ErrorModel errors;
  std::vector<calib::FlownLine> lines;
  calib::CalibrationFlight flight;  ///< points at the members above
  PreparedFlight(const PreparedFlight&) = delete;
};

/// Side of cells wide enough for a plane through one line's returns, in whole half metres.
double cell_for(const std::vector<calib::FlownLine>& lines);

/// A report that shows survey and lines so far.
calib::CalibrationReport report_on(const Context& context, const std::vector<calib::FlownLine>& lines);
/// Adds sections, maps of differences and check points.
void add_views(calib::CalibrationReport& report, CalibrationViews views);

}  // namespace swath::stages
