// SPDX-License-Identifier: GPL-3.0-or-later
// What the filter, the smoother and a joint adjustment of the same records share.
#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "core/records/gnss_data.h"
#include "trajectory/ins/error_state.h"
#include "trajectory/ins/ins_options.h"

namespace swath::trajectory {

/// An instant at which the filter stops.
struct Node {
  double time = 0.0;
  std::int32_t fix = -1;  ///< number of the GNSS fix, or -1
  bool still = false;     ///< the body stands on the ground
};

/// The fixes' error between two steps.
struct FixLevel {
  Eigen::Vector3d beside = Eigen::Vector3d::Zero();  ///< distance from the level of most of the time, north east down, m
  Eigen::Vector3d stated = Eigen::Vector3d::Ones();  ///< median of the variances stated for its fixes, m^2
};

/// A step of the fixes' error, from one level to another.
struct FixStep {
  double time = 0.0, first = 0.0;                                ///< of the step, and of the first fix after it; GPS time, s
  Eigen::Vector3d size = Eigen::Vector3d::Zero(), sigma = size;  ///< north east down, m
  double chi_square = 0.0;                                       ///< of three degrees of freedom
  FixLevel before{}, after{};
};

/// What one GNSS fix did.
struct FixOutcome {
  Eigen::Vector3d innovation, innovation_sigma;  ///< north east down, m
  double nis = 0.0, velocity_nis = -1.0;         ///< -1: no velocity
  double weight = 1.0;
};

/// What all passes share. References stay with the caller.
struct Problem {
  const ImuPath& path;
  const core::GnssData& gnss;
  const std::vector<Node>& nodes;
  Layout layout;
  ProcessNoise noise;
  InsGnssOptions options;
  double share = 0.4;            ///< of the fixes' variance that is correlated in time
  double variance = 1.0;         ///< factor on the fixes' stated covariances
  double roughness = 1.0;        ///< factor on the IMU's stated noise: what vibration adds
  double gate = 21.1;            ///< NIS of three degrees of freedom beyond which a fix is down-weighted
  std::vector<FixStep> steps{};  ///< in the order of time; each begins a correlated error of its own
  /// Called at every node that a pass comes to, for the progress.
  std::function<void()> at_node = [] {};
};

/// What a run of the smoother leaves to an adjustment that goes on from it.
struct SmoothedFlight {
  ImuPath path;
  core::GnssData gnss;
  std::vector<Node> nodes;
  Layout layout;
  ProcessNoise noise;
  InsGnssOptions options;
  double share = 0.0, variance = 1.0, roughness = 1.0, gate = 0.0;
  std::vector<FixStep> steps;
  std::vector<Estimate> estimates;   ///< per node
  std::vector<FixOutcome> outcomes;  ///< per node; those without a fix are empty
  Estimate stated;                   ///< of the beginning, before any measurement
  StateMatrix covariance;            ///< of its errors
  bool attitude_given = false;       ///< the stated attitude counts with its sigmas

  /// Points at the members above.
  Problem problem() const { return {path, gnss, nodes, layout, noise, options, share, variance, roughness, gate, steps}; }
};

}  // namespace swath::trajectory
