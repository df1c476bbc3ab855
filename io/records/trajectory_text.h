// SPDX-License-Identifier: GPL-3.0-or-later
// Trajectories as delimited text.
#pragma once

#include <filesystem>

#include "core/records/trajectory_data.h"
#include "core/time.h"

namespace swath::io {

/// One line per record under a header that names columns and units: time, latitude, longitude, height, roll, pitch, heading, then velocity
/// and sigmas where the trajectory has them. Angles and their sigmas in degrees. Time in `scale`; gps_week has a column of weeks, utc_day
/// counts on past midnight. Throws core::Error (file; a scale that is unstated or a device's own).
void write_trajectory_text(const std::filesystem::path& file, const core::TrajectoryData& trajectory, core::TimeScale scale);

/// One line per node of the trajectory's covariance series: time, then the upper triangle of the 9 x 9 covariance, row by row, of north,
/// east, down (m), v_north, v_east, v_down (m/s), roll, pitch, heading (rad). The trajectory must have the series. Throws core::Error.
void write_covariance_text(const std::filesystem::path& file, const core::TrajectoryData& trajectory, core::TimeScale scale);

}  // namespace swath::io
