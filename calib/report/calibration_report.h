// SPDX-License-Identifier: GPL-3.0-or-later
// The report of a calibration: calibration.json for the survey's run, report.html to be read, and the numbers behind every figure in it.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "calib/report/report_data.h"

namespace swath::calib {

/// Writes into the folder, which it makes:
///   calibration.json     what io::load_calibration() reads, and the whole report as a tree (SI units, GPS time); of a strip adjustment
///                        strips.json, the report alone
///   report.html          self-contained
///   residuals.csv        one row per group of returns (line on plane)
///   corrections.csv      one row per line and knot
///   planes.csv           one row per tie plane
///   sections.csv         one row per return of a section
///   figures/*.png        every chart and map of the report
///   differences/A_B_before.tif, _after.tif    height differences per pair of lines
/// Returns the names of the files, relative to the folder, in the order written. Throws core::Error where a file cannot be written.
std::vector<std::string> write_calibration_report(const CalibrationReport& report, const std::filesystem::path& folder);

}  // namespace swath::calib
