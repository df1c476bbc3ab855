// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>

#include "core/records/trajectory_data.h"
#include "core/time.h"
#include "io/survey/survey.h"
#include "simulate/flight.h"
#include "simulate/options.h"

namespace swath::simulate {

/// The flight at 200 Hz from its first to its last instant, exact at each record's time.
core::TrajectoryData true_trajectory(const Flight& flight, core::GpsTime start);

/// Writes the delivered trajectory, the true one with errors of the options' sigmas: sbet.out and (unless noise-free) smrmsg.out, or
/// trajectory.csv. Returns what survey.toml says of it.
io::TrajectoryFile write_trajectory(const std::filesystem::path& folder, const Flight& flight, core::GpsTime start, const Options& options);

}  // namespace swath::simulate
