// SPDX-License-Identifier: GPL-3.0-or-later
// The steps of the error model that a filter and a joint adjustment share: how errors pass from node to node, and what is measured at one.
#pragma once

#include <optional>

#include "trajectory/ins/ins_problem.h"
#include "trajectory/ins/measurement.h"

namespace swath::trajectory {

constexpr double virtual_interval = 0.2;  ///< s between updates by standstill or wheels that count as independent

/// From one instant to the next: errors pass by `transition`, with half of the variance `gained` before it and half after.
struct Passage {
  Estimate carried;  ///< at the end
  StateMatrix transition;
  StateVector gained;                   ///< variances
  std::optional<Eigen::Vector3d> rate;  ///< body against inertial space at the end, rad/s; nothing where no time passes

  StateMatrix noise() const;  ///< covariance that is added over the whole passage
};

/// What a level adds to the variance of the fixes' correlated error, in units of the stated one. The share must not be zero.
Eigen::Vector3d level_variance(const Problem& problem, const FixLevel& level);

/// Carries an estimate to another instant, on either side.
Passage passage_to(const Problem& problem, const Estimate& from, ImuWalk& walk, double until);

/// A measurement at a node: residual (measured less expected) = design * error + noise.
template <int Rows>
struct Observation {
  Eigen::Matrix<double, Rows, Eigen::Dynamic, 0, Rows, most_states> design;
  Eigen::Matrix<double, Rows, 1> residual;
  Eigen::Matrix<double, Rows, Rows> noise;
};

/// A fix's position. Its correlated share is in the design, the rest is noise.
Observation<3> observed_position(const Problem& problem, size_t fix, const Estimate& at, const Eigen::Vector3d& rate);
/// A fix's velocity, where there is one and it is used.
std::optional<Observation<3>> observed_velocity(const Problem& problem, size_t fix, const Estimate& at, const Eigen::Vector3d& rate);
/// The body stands still.
Observation<3> observed_standstill(const Problem& problem, const Estimate& at);
/// Wheels that do not slip; nothing where the vehicle is slow or turns fast.
std::optional<Observation<2>> observed_wheels(const Problem& problem, const Estimate& at, const Eigen::Vector3d& rate);

/// Axes of north, east, down at a point.
Eigen::Matrix3d ned_at(const Eigen::Vector3d& ecef);

}  // namespace swath::trajectory
