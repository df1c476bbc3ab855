// SPDX-License-Identifier: GPL-3.0-or-later
// What IMU and GNSS say of a flight, as parts of one system of equations: the smoother's own model, node for node.
#pragma once

#include <functional>
#include <vector>

#include "calib/network/flight_states.h"
#include "trajectory/ins/ins_steps.h"

namespace swath::calib {

/// What is known of the first instant and of the constants before any measurement.
struct NavigationPrior {
  trajectory::StateMatrix covariance;
  /// Mean of the errors about an estimate of the first instant.
  std::function<trajectory::StateVector(const trajectory::Estimate&)> mean;
};
NavigationPrior prior_of(const trajectory::SmoothedFlight& flight);

/// fix_error: rows of a passage, the last three where the fixes' correlated error is an unknown; each_navigation() gives them with `imu`.
enum class NavigationKind { start, imu, fix_error, position, velocity, standstill, wheels };

/// One observation, linearised: its kind, the derivatives by nodes, its weight, and what is left of it.
using NavigationVisit = std::function<void(NavigationKind kind, const std::vector<NetworkNormals::Part>& parts,
                                           const Eigen::MatrixXd& weight, const Eigen::VectorXd& left)>;

/// The prior, the passages from instant to instant and what was measured at each, one after another; as add_navigation().
void each_navigation(const trajectory::Problem& problem, const FlightStates& states, const std::vector<trajectory::Estimate>& estimates,
                     const std::vector<trajectory::FixOutcome>& outcomes, const NavigationPrior& prior, const NavigationVisit& visit);

/// Adds the prior, the passages from instant to instant and what was measured at each, linearised about `estimates` (their constants must
/// be alike). `outcomes`: of the smoother, empty or per instant; fixes that it weighed down are weighed down here: its gate is one of
/// innovations, which a system of all instants does not have.
void add_navigation(const trajectory::Problem& problem, const FlightStates& states, const std::vector<trajectory::Estimate>& estimates,
                    const std::vector<trajectory::FixOutcome>& outcomes, const NavigationPrior& prior, NetworkNormals& into);

}  // namespace swath::calib
