// SPDX-License-Identifier: GPL-3.0-or-later
// What the stages have in common that smooth IMU and GNSS records.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "io/survey/survey.h"
#include "trajectory/compare.h"
#include "trajectory/ins/ins_gnss.h"

namespace swath::stages {

/// Throws a usage error where the survey does not say how good its IMU is; `stage`: who asks.
void require_imu_spec(const io::Survey& survey, const std::string& stage);

/// States that the smoother has over the records.
double smoother_nodes(const core::ImuData& imu, const trajectory::InsGnssOptions& o);

/// About the bytes that smooth_records() takes beside its records (docs/performance.md, measured for an hour and for four).
double smoothing_memory(const core::ImuData& imu, const trajectory::InsGnssOptions& o);

/// trajectory::smooth() with what the survey states of antenna, IMU and clocks.
trajectory::InsGnssResult smooth_records(core::ImuData imu, const core::GnssData& gnss, const io::Survey& survey,
                                         const trajectory::InsGnssOptions& options, const core::OnProgress& progress,
                                         trajectory::SmoothedFlight* left = nullptr);

/// As a function of time: records of `rate` per second; a few of them missing are interpolated over.
trajectory::Trajectory as_flown(core::TrajectoryData data, double rate, const std::string& where);

/// The true trajectory of a simulated survey, where there is one; weeks as in `flown`.
std::optional<trajectory::Trajectory> truth_of(const io::Survey& survey, const core::TrajectoryData& flown);
std::vector<std::filesystem::path> true_trajectory(const io::Survey& survey);
/// Over all and over the flight lines.
trajectory::TruthComparison compare_with_truth(const io::Survey& survey, const core::TrajectoryErrors& errors);

}  // namespace swath::stages
