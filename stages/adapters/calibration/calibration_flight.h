// SPDX-License-Identifier: GPL-3.0-or-later
// What the stages that adjust a flight have in common.
#pragma once

#include <string>
#include <vector>

#include "calib/adjust/flown_lines.h"
#include "calib/report/report_data.h"
#include "calib/ties/line_heights.h"
#include "stages/stage.h"
#include "trajectory/ins/error_model.h"

namespace swath::stages {

/// What the report shows of a flight's lines.
struct FlightViewOptions {
  calib::LineHeightOptions differences;
  int sections = 4;
};

template <class V>
void describe(FlightViewOptions& o, V& v) {
  v.table("differences", o.differences, "Maps of the differences of overlapping lines.");
  v.option("sections", o.sections, core::within(0, 50), "Cross sections drawn in the report.");
}

/// Options that stages share which adjust a flight with a given trajectory and report on it.
struct FlightStageOptions : FlightViewOptions {
  trajectory::ErrorModelOptions errors;
};

template <class V>
void describe(FlightStageOptions& o, V& v) {
  v.table("errors", o.errors, "Errors of trajectories that state no covariances between instants.");
  describe(static_cast<FlightViewOptions&>(o), v);
}

/// Names of a stage's products: its own, and those of the report.
std::vector<std::string> with_report(std::vector<std::string> own);

/// A report that shows survey and lines so far.
calib::CalibrationReport report_on(const Context& context, const std::vector<calib::FlownLine>& lines);

}  // namespace swath::stages
