// SPDX-License-Identifier: GPL-3.0-or-later
// The error-state Kalman filter over nodes: instants of fixes and some between them. The same code runs forward and backward in time.
#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "core/records/gnss_data.h"
#include "trajectory/ins/error_state.h"
#include "trajectory/ins/ins_options.h"
#include "trajectory/ins/measurement.h"

namespace swath::trajectory {

/// An instant at which the filter stops.
struct Node {
  double time = 0.0;
  std::int32_t fix = -1;  ///< number of the GNSS fix, or -1
  bool still = false;     ///< the body stands on the ground
};

/// One update as the smoother needs it.
struct Update {
  Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, 3, most_states> design;  ///< H
  Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, most_states, 3> gain;    ///< K
  Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, 3, 3> weight;            ///< S^-1
  Eigen::Matrix<double, Eigen::Dynamic, 1, 0, 3, 1> innovation;                     ///< y
};

/// What the filter knew at a node, after its updates.
struct NodeRecord {
  StateMatrix transition;  ///< from the node before
  std::vector<Update> updates;
  StateMatrix covariance;
  Estimate estimate;  ///< what the errors count from
  StateVector mean;   ///< of the errors about `estimate`
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
  double share = 0.4;      ///< of the fixes' variance that is correlated in time
  double variance = 1.0;   ///< factor on the fixes' stated covariances
  double roughness = 1.0;  ///< factor on the IMU's stated noise: what vibration adds
  double gate = 21.1;      ///< NIS of three degrees of freedom beyond which a fix is down-weighted
  /// Called at every node that a pass comes to, for the progress.
  std::function<void()> at_node = [] {};
};

/// Without a reference the filter feeds each correction back at once and linearises about its own estimate. With one, a trajectory near
/// the truth from an earlier pass, it linearises about that and carries the mean of the errors beside it: one step of Gauss and Newton for
/// the whole record, free of what the filter's first minutes did not know yet.
class InsFilter {
 public:
  /// `start`: at any instant of the path, with the mean and covariance of its errors; `reference`: per node, or nullptr.
  InsFilter(const Problem& problem, Estimate start, StateVector mean, StateMatrix covariance, const std::vector<Estimate>* reference);

  /// Carries estimate and covariance to the next node; no measurement is used. `record` receives the transition.
  void predict(size_t node, NodeRecord* record);
  /// Uses what was measured at the node.
  void update(size_t node, NodeRecord* record, FixOutcome* outcome);

  /// The mean of the errors put in.
  Estimate estimate() const;
  const StateMatrix& covariance() const { return covariance_; }

 private:
  template <int Rows>
  double apply(const Eigen::Matrix<double, Rows, Eigen::Dynamic, 0, Rows, most_states>& design,
               const Eigen::Matrix<double, Rows, 1>& innovation, const Eigen::Matrix<double, Rows, Rows>& noise, double gate,
               NodeRecord* record, double* weight);
  void use_position(const Node& node, NodeRecord* record, FixOutcome* outcome);
  void use_velocity(const Node& node, NodeRecord* record, FixOutcome* outcome);
  void use_standstill(NodeRecord* record);
  void use_wheels(NodeRecord* record);

  const Problem* problem_;
  const std::vector<Estimate>* reference_;
  Estimate estimate_;
  StateVector mean_;
  StateMatrix covariance_;
  ImuWalk walk_;
  Eigen::Vector3d rate_ = Eigen::Vector3d::Zero();  // body against inertial space at the node, rad/s
  double last_virtual_ = -1e300;                    // of the last standstill or wheel update
};

}  // namespace swath::trajectory
