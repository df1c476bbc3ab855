// SPDX-License-Identifier: GPL-3.0-or-later
// The error-state Kalman filter over nodes: instants of fixes and some between them. The same code runs forward and backward in time.
#pragma once

#include <vector>

#include "trajectory/ins/ins_problem.h"
#include "trajectory/ins/ins_steps.h"

namespace swath::trajectory {

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
  double apply(const Observation<Rows>& observation, NodeRecord* record, double* weight);
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
