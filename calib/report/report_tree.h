// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "calib/report/report_data.h"
#include "core/config/value.h"

namespace swath::calib {

/// calibration.json: "calibration" and "sigma" as io::load_calibration() reads them, then the report. SI units; times GPS; angles rad.
core::Value calibration_report_tree(const CalibrationReport& report);

}  // namespace swath::calib
