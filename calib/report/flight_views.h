// SPDX-License-Identifier: GPL-3.0-or-later
// What a calibration's report shows of the points themselves: differences of lines, sections, check points, with the start values and with
// the result.
#pragma once

#include "calib/adjust/calibrate.h"
#include "calib/report/report_data.h"
#include "calib/ties/line_heights.h"
#include "core/config/result.h"
#include "core/geo/crs.h"

namespace swath::calib {

/// The map of a run.
struct FlightMap {
  const core::Crs& crs;
  double unit = 1.0;       ///< metres per horizontal unit of the CRS
  Eigen::Vector3d origin;  ///< of blocks, m
};

/// A way to georeference the flight.
struct Geometry {
  const core::Calibration& calibration;
  const trajectory::Trajectory& trajectory;
};

/// RMS of the differences of lines, m.
struct BeforeAndAfter {
  double before = 0.0, after = 0.0;
};

template <class V>
void describe(const BeforeAndAfter& r, V& v) {
  v.result("rms_before", r.before, core::metres().in_summary().always(), "RMS with the trajectory as it was given.");
  v.result("rms_after", r.after, core::metres().in_summary().always(), "RMS with the corrected trajectory.");
}

/// Reads the flight once, georeferences it as it was and with the result, and adds to a report whose ties are known. `cell`: for the
/// differences, where the options state none, m. The flight's targets of use `check` are compared with the result.
BeforeAndAfter add_views(const CalibrationFlight& flight, const FlightMap& map, const Geometry& result, const LineHeightOptions& heights,
                         double cell, int sections, CalibrationReport& report);

}  // namespace swath::calib
