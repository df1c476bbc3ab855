// SPDX-License-Identifier: GPL-3.0-or-later
// The files of numbers behind a calibration report.
#pragma once

#include <string>

#include "calib/report/report_data.h"

namespace swath::calib {

// CSV with a header whose names end in the unit; numbers as short as they can be to read back the same.
/// One row per group of returns: the plane (index from 0), line id, time since the first line's first return.
std::string residuals_csv(const CalibrationReport& report);
/// One row per line and knot.
std::string corrections_csv(const CalibrationReport& report);
/// One row per tie plane, local frame east, north, up (its origin: calibration.json).
std::string planes_csv(const CalibrationReport& report);
/// One row per return of a section, before and after.
std::string sections_csv(const CalibrationReport& report);

/// With what the maps of differences were made, as a sentence.
std::string differences_after(const CalibrationReport& report);

/// The report as a tree: calibration.json, strips.json or adjustment.json.
const char* tree_file(const CalibrationReport& report);

/// "differences/1_2_before.tif": names of the files of one pair.
std::string difference_file(const LineDifference& difference, bool before);

}  // namespace swath::calib
