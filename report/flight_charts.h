// SPDX-License-Identifier: GPL-3.0-or-later
// What a smoothed trajectory's quality looks like: charts of the smoother's results.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/records/gnss_data.h"
#include "core/records/smoother_series.h"
#include "core/records/trajectory_data.h"
#include "core/records/trajectory_errors.h"
#include "report/chart.h"

namespace swath::report {

struct NamedChart {
  std::string name;  ///< of its file, without ending
  Chart chart;
};

/// track (local east and north of the first fix, fixes by quality), sigma, separation and separation_attitude (forward minus backward),
/// innovations with their sigmas (down-weighted fixes marked) and NIS, residuals, attitude, biases with their sigmas, heading (forward
/// filter minus smoothed); where the truth is known errors_position and errors_attitude with the printed sigmas. Position errors in m,
/// attitude in arc seconds or degrees, gyros in deg/h, accelerometers in micro-g; time in seconds of the first record's GPS week.
std::vector<NamedChart> flight_charts(const core::TrajectoryData& trajectory, const core::SmootherSeries& series,
                                      const core::GnssData& gnss, const std::optional<core::TrajectoryErrors>& errors = std::nullopt);

}  // namespace swath::report
