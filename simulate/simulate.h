// SPDX-License-Identifier: GPL-3.0-or-later
// A survey whose truth is known: an analytic world, an exact flight, an ideal scanner with given errors. Independent of the rooms that
// process surveys, so that it can test them.
#pragma once

#include <filesystem>
#include <functional>

#include "simulate/made.h"
#include "simulate/options.h"
#include "simulate/preset.h"

namespace swath::simulate {

/// Called with the share done, 0 to 1, from the calling thread.
using Progress = std::function<void(double)>;

/// Writes into `out_folder` (made where it is not there):
///   survey.toml (first format) and survey_FORMAT.toml (each further one), laser.FORMAT, sbet.out + smrmsg.out or trajectory.csv,
///   imu.csv, gnss.csv, events_pc.csv, events_marks.csv, loopstats, pps.log,
///   with camera.file images.csv, image_points.csv, block_control.csv, block_check.csv, block.toml (for `swath block`) and their truth,
///   control.csv (targets) and check.csv (ground points),
///   truth/: planes.csv (facets of buildings), control.csv (exact places of what was surveyed), sbet.out (200 Hz), returns.npy (see
///   TruthFile), dtm.tif, calibration.json, imu.json and imu_drift.csv (errors of the IMU), gnss.csv (errors of each fix), events.csv,
///   simulation.json (options and what was made).
/// The same options give the same bytes, whatever the number of threads. Memory is bounded whatever the number of returns (the
/// trajectory, 100 bytes per 5 ms, and the truth's grid are held whole).
/// Throws Error where the options do not go together or a file cannot be written.
Made run(const Options& options, const std::filesystem::path& out_folder, const Progress& progress = {});

}  // namespace swath::simulate
