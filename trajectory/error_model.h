// SPDX-License-Identifier: GPL-3.0-or-later
// How the errors of a smoothed trajectory at different instants hang together.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "core/option.h"
#include "core/trajectory_data.h"

namespace swath::trajectory {

/// For trajectories that state sigmas alone: correlation times of exp(-|dt| / tau).
struct ErrorModelOptions {
  core::Seconds position_correlation{60.0}, attitude_correlation{30.0}, heading_correlation{120.0};
  // Sigmas where the trajectory states none.
  core::Metres horizontal{0.03}, vertical{0.05};
  core::Radians roll_pitch = core::degrees(0.003), heading = core::degrees(0.008);
};

class ErrorModel {
 public:
  /// The data must outlive it.
  explicit ErrorModel(const core::TrajectoryData& data, const ErrorModelOptions& options = {});
  /// Covariance of the errors at n instants (GPS time, s; any order): 6n x 6n, per instant north, east, down (m), roll, pitch, heading
  /// (rad). Symmetric, positive semi-definite.
  Eigen::MatrixXd covariance(const std::vector<double>& times) const;
  /// True where the smoother's own covariances between instants are used, false where sigmas and correlation times are.
  bool is_of_smoother() const;

 private:
  const core::TrajectoryData* data_;
  ErrorModelOptions options_;
};

}  // namespace swath::trajectory
