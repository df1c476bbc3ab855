// SPDX-License-Identifier: GPL-3.0-or-later
// The drawings of a calibration report. A flight line has one colour in all of them.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "calib/report/report_data.h"
#include "calib/report/residual_bins.h"
#include "core/picture.h"
#include "report/chart.h"
#include "report/correlation.h"

namespace swath::calib {

/// Distances of the groups' means from their planes, before and after, by line, scan angle, range or time; those taken out in grey.
report::Chart residual_chart(const CalibrationReport& report, BinBy by);
/// Corrections of position (cm) and attitude (arcsec) over time with their sigmas; none where there are no corrections.
std::optional<report::Chart> correction_chart(const CalibrationReport& report);
/// Of the estimated parameters; none where fewer than two are.
std::optional<report::CorrelationChart> correlation_chart(const CalibrationReport& report);
/// Before above, after below. Of a line with more than `most` returns every k-th is drawn.
report::Chart section_chart(const CalibrationReport& report, const CrossSection& section, size_t most = 800);
core::Picture difference_map(const LineDifference& difference, bool before);

/// Index into the chart's palette for the k-th line of the flight: never that of what was taken out.
int line_colour(size_t k);

}  // namespace swath::calib
