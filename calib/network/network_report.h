// SPDX-License-Identifier: GPL-3.0-or-later
// A joint adjustment in the form of the calibration's report.
#pragma once

#include "calib/network/network_adjust.h"
#include "calib/report/report_data.h"

namespace swath::calib {

/// Puts the adjustment into a report that has survey and lines: groups, planes, values, kinds of observation, corrections of the smoother's
/// trajectory `before` along the lines, what they should be as large as, and the IMU's biases. Both trajectories have covariances.
void put_network(const AdjustedNetwork& network, const trajectory::Trajectory& before, const trajectory::Trajectory& after,
                 CalibrationReport& report);

}  // namespace swath::calib
