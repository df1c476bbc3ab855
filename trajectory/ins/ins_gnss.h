// SPDX-License-Identifier: GPL-3.0-or-later
// The trajectory from IMU and GNSS records: strapdown mechanisation, error-state Kalman filter, smoother.
#pragma once

#include <Eigen/Core>

#include "core/on_progress.h"
#include "core/records/gnss_data.h"
#include "core/records/imu_data.h"
#include "core/records/imu_spec.h"
#include "core/records/smoother_series.h"
#include "core/records/trajectory_data.h"
#include "trajectory/ins/ins_options.h"
#include "trajectory/ins/ins_results.h"

namespace swath::trajectory {

struct SmoothedFlight;  // ins_problem.h

struct InsGnssResult {
  core::TrajectoryData trajectory;  ///< of the IMU centre, with sigmas, covariances at the nodes and error links
  InsReport report;                 ///< estimates with sigmas, counts, NIS, separation, warnings
  core::SmootherSeries series;
};

/// `lever_arm`: IMU centre to antenna, body, m, with the sigma of each component. `stated`: offsets of the clocks that the records were
/// read with, for the advice on them. `left`: receives what an adjustment needs to go on from here. Throws core::Error: no overlap in time,
/// every fix rejected, attitude not to be found, a gap longer than max_gap, an IMU whose values cannot be (units, axes); with the clocks'
/// offset in the hint where that may be the reason.
InsGnssResult smooth(core::ImuData imu, core::GnssData gnss, const core::ImuErrorModel& spec, const Eigen::Vector3d& lever_arm,
                     double lever_arm_sigma, const InsGnssOptions& options = {}, const StatedClocks& stated = {},
                     const core::OnProgress& progress = core::unwatched, SmoothedFlight* left = nullptr);

}  // namespace swath::trajectory
