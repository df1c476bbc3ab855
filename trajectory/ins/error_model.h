// SPDX-License-Identifier: GPL-3.0-or-later
// How the errors of a smoothed trajectory at different instants are correlated.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "core/config/option.h"
#include "core/records/trajectory_data.h"

namespace swath::trajectory {

/// For trajectories that state sigmas alone: correlation times of exp(-|dt| / tau). Defaults: what bench/error_bench finds for the means
/// over lines of 25 s of tactical, compact and mems flights (position 150-340 s, roll 130-390 s, pitch 24-36 s, heading 80-210 s). Roll
/// goes with the bias of the accelerometer across, which coordinated turns hardly show.
struct ErrorModelOptions {
  core::Seconds position_correlation{150.0}, roll_correlation{200.0}, pitch_correlation{30.0}, heading_correlation{120.0};
  // Sigmas where the trajectory states none.
  core::Metres horizontal{0.03}, vertical{0.05};
  core::Radians roll_pitch = core::degrees(0.003), heading = core::degrees(0.008);
};

template <class V>
void describe(ErrorModelOptions& o, V& v) {
  v.option("position_correlation", o.position_correlation, core::above(0),
           "Correlation time of position errors, for a trajectory with sigmas alone (a file).");
  v.option("roll_correlation", o.roll_correlation, core::above(0), "The same of roll.");
  v.option("pitch_correlation", o.pitch_correlation, core::above(0), "The same of pitch.");
  v.option("heading_correlation", o.heading_correlation, core::above(0), "The same of heading.");
  v.option("horizontal", o.horizontal, core::above(0), "Sigma of north and of east, where the trajectory states none.");
  v.option("vertical", o.vertical, core::above(0), "Sigma of the height, where the trajectory states none.");
  v.option("roll_pitch", o.roll_pitch, core::above(0), "Sigma of roll and of pitch, where the trajectory states none.");
  v.option("heading", o.heading, core::above(0), "Sigma of heading, where the trajectory states none.");
}

class ErrorModel {
 public:
  /// The data must outlive it.
  explicit ErrorModel(const core::TrajectoryData& data, const ErrorModelOptions& options = {});
  /// Covariance of the errors at n instants (GPS time, s; any order): 6n x 6n, per instant north, east, down (m), roll, pitch, heading
  /// (rad). Symmetric, positive definite by 1e-9 of each variance. Outside the trajectory's time the errors are those of its first or last
  /// instant.
  Eigen::MatrixXd covariance(const std::vector<double>& times) const;
  /// True where the smoother's own covariances between instants are used, false where sigmas and correlation times are.
  bool is_of_smoother() const;

 private:
  using Matrix6 = Eigen::Matrix<double, 6, 6>;
  Eigen::MatrixXd of_links(const std::vector<double>& times) const;
  Eigen::MatrixXd of_sigmas(const std::vector<double>& times) const;
  Matrix6 root_at(double time) const;

  const core::TrajectoryData* data_;
  ErrorModelOptions options_;
};

}  // namespace swath::trajectory
