// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>

#include "calib/report/page_parts.h"

namespace swath::calib {

/// report.html. Every table has an id, and every number in it follows from the files beside it (calib/report/tables.h, the
/// difference grids). Line drawings stand in it as SVG, maps as PNG; all of them go through `keep`.
std::string calibration_page(const CalibrationReport& report, const KeepFigure& keep);

}  // namespace swath::calib
