// SPDX-License-Identifier: GPL-3.0-or-later
// The state that the filter begins with: attitude, motion and constants with what is known of each.
#pragma once

#include <vector>

#include "core/records/gnss_data.h"
#include "core/records/imu_spec.h"
#include "trajectory/ins/alignment.h"
#include "trajectory/ins/error_state.h"
#include "trajectory/ins/ins_options.h"

namespace swath::trajectory {

/// The attitude to begin with, by options.alignment. Throws core::Error where it is not to be found.
Alignment align(const ImuPath& path, const core::GnssData& gnss, const core::ImuErrorModel& spec, const Eigen::Vector3d& lever,
                const std::vector<Span>& standstills, const InsGnssOptions& options);

struct Start {
  Estimate estimate;
  StateMatrix covariance;
  bool attitude_given = false;  ///< the attitude is a measurement with its sigma, not only a place to begin
};

/// The state at the path's beginning with the sigmas it is stated with.
Start start_of(const ImuPath& path, const core::GnssData& gnss, const Alignment& alignment, const core::ImuErrorModel& spec,
               const Layout& layout, const Eigen::Vector3d& lever, double lever_sigma, const InsGnssOptions& options);

/// The mean of the errors about a reference that the stated constants give. Position and velocity count as unknown, and so does the
/// attitude unless `attitude`.
StateVector stated_mean(const Estimate& stated, const Estimate& reference, const Layout& layout, bool attitude);

/// Position, velocity and attitude to begin with count as unknown: ten of their smoothed sigmas add a hundredth of the information they
/// have, and keep the numbers of the smoother small. With `attitude` its stated covariance stays.
StateMatrix widened(const StateMatrix& stated, const StateVector& smoothed_sigma, bool attitude);

}  // namespace swath::trajectory
