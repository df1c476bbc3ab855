// SPDX-License-Identifier: GPL-3.0-or-later
// The fixed-interval smoother in the form of Bryson and Frazier (Bierman 1973), which is equal to Rauch, Tung and Striebel's and inverts no
// covariance: states without noise or with none of their own variance do no harm.
#pragma once

#include <vector>

#include "core/records/trajectory_data.h"
#include "trajectory/ins/ins_filter.h"

namespace swath::trajectory {

/// The estimate from all measurements at one node.
struct SmoothedNode {
  Estimate estimate;
  core::CovarianceSeries::Packed covariance;  ///< of north, east, down, their velocities, roll, pitch, heading
  StateVector sigma;                          ///< of every state, sqrt of the diagonal
};

/// Where one filter pass stood at a node.
struct FilterNode {
  Eigen::Vector3d position, roll_pitch_heading;
  Eigen::Matrix3d position_covariance;  ///< ecef, m^2
  Eigen::Matrix3d attitude_covariance;  ///< roll, pitch, heading, rad^2
};

struct SmootherRun {
  std::vector<SmoothedNode> nodes;
  std::vector<FilterNode> forward;   ///< after the node's updates
  std::vector<FixOutcome> outcomes;  ///< per node; those without a fix are empty
  core::ErrorLinks errors;           ///< at nodes some error_spacing apart, the first and the last among them
};

/// Runs the filter over the nodes and the smoother back, in stretches of `stretch` nodes: the forward pass leaves the filter as it was at
/// the beginning of each, from where the stretch is filtered once more when the smoother comes to it. Memory: 18 kB per node of a stretch,
/// 1 kB per node of the whole, 8 kB per error link. Without `covariances` only the first and the last node get sigmas, and there are no
/// error links.
SmootherRun run_smoother(const Problem& problem, const InsFilter& start, bool covariances = true, size_t stretch = 20000);

/// The outcome of each node's fix in one forward pass alone.
std::vector<FixOutcome> run_forward(const Problem& problem, InsFilter filter);

/// A pass of the filter from the last node to the first; at each node before the node's own updates, so that it shares no fix with
/// the forward pass after them.
std::vector<FilterNode> run_backward(const Problem& problem, InsFilter last);

/// Takes position, velocity and psi in ecef to north, east, down, their velocities, roll, pitch, heading.
core::CovarianceSeries::Matrix9 local_by_ecef(const NavState& nav);
/// Covariance of north, east, down, velocities, roll, pitch, heading from that of position, velocity and psi in ecef.
core::CovarianceSeries::Matrix9 local_covariance(const NavState& nav, const Eigen::Matrix<double, 9, 9>& ecef);

}  // namespace swath::trajectory
