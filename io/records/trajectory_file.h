// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <string>

#include "core/records/trajectory_data.h"
#include "core/report.h"
#include "io/survey/survey.h"

namespace swath::io {

/// What every trajectory must keep, whatever its format: values finite, latitudes and pitches within a quarter turn, time rising.
/// Throws Error "name: record N" where it does not, and where time goes back (nothing is sorted silently). Records at a repeated time are
/// left out and counted; gaps (over 5 times the median step and over 0.05 s) are counted with their length.
void check_trajectory(core::TrajectoryData& trajectory, const std::string& name, core::Tally& tally);

/// Reads one trajectory file of the survey by its format, checked, with sigmas: the file's own, else those that the survey states for it.
core::TrajectoryData read_trajectory(const Survey& survey, const TrajectoryFile& file, core::Tally& tally);

/// All trajectory files of the survey, joined in time order (velocities only where all have them). Throws Error naming both files where two
/// overlap in time.
core::TrajectoryData read_trajectory(const Survey& survey, core::Tally& tally);

}  // namespace swath::io
