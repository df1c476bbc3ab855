// SPDX-License-Identifier: GPL-3.0-or-later
// A calibration report of made-up numbers, of the sizes that a small flight has.
#pragma once

#include "calib/report/calibration_report.h"
#include "calib/target/flat_target.h"

namespace swath::calib {

/// Six lines at two heights over a town with gable roofs and two surveyed targets. Some groups and one surveyed point are taken out, the
/// lever arm is held, the range scale is refused where `refused`. Deterministic.
CalibrationReport made_report(bool refused = false);

/// A flat target that line 4 has seen and line 5 has not.
FlatTarget made_target();

}  // namespace swath::calib
