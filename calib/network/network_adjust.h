// SPDX-License-Identifier: GPL-3.0-or-later
// IMU, GNSS and the laser's surfaces in one adjustment.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "calib/adjust/calibrate.h"
#include "calib/network/network_components.h"
#include "calib/network/network_options.h"
#include "calib/network/plane_factors.h"
#include "trajectory/ins/ins_problem.h"

namespace swath::calib {

/// A calibration value that was an unknown.
struct NetworkValue {
  Parameter parameter = boresight_roll;
  double start = 0.0, apriori = 0.0;  ///< with its sigma; infinite: free
  double value = 0.0, sigma = 0.0;
};

/// Biases of the IMU at one instant, with their sigmas: rad/s, m/s^2, body axes.
struct SensorBias {
  double time = 0.0;
  Eigen::Vector3d gyro, gyro_sigma, force, force_sigma;
};

struct AdjustedNetwork {
  core::TrajectoryData trajectory;  ///< with covariances at the instants
  core::Calibration calibration;    ///< the start with the values found
  std::vector<NetworkValue> values;
  Eigen::MatrixXd covariance;  ///< of the values, in their order
  TieSet ties;                 ///< of the last round
  /// In the order of TieSet::groups: with the smoother's trajectory and the start calibration, and after.
  std::vector<PlaneMisfit> before, after;
  std::uint64_t instants = 0, unknowns = 0, left_out = 0;
  int rounds = 0, iterations = 0;
  double noise_factor = 1.0;                      ///< scatter of single returns about their group, in the sigmas that were used
  std::vector<VarianceComponent> sigmas;          ///< of ranges, angles and surfaces: stated, and as estimated
  double surface_sigma = 0.0;                     ///< by which a plane seen in one line departs from that of all, m
  double range_factor = 1.0, angle_factor = 1.0;  ///< sigmas of ranges, and of scan angles and pointing, over the stated ones
  bool surface_estimated = false;                 ///< false: as stated
  PlaneTests tests;                               ///< groups as `after`
  std::uint64_t displaced = 0;                    ///< groups that the tests left out
  std::vector<NetworkComponent> components;
  double last_move = 0.0;  ///< rms by which the last round moved the groups, m
  bool settled = false;
  std::vector<TiePlane> planes;  ///< centre and normal adjusted
  std::vector<SensorBias> biases;
};

/// `flight.trajectory` is that of the smoother that left `smoothed`. Throws core::Error where no two lines see the same planes.
AdjustedNetwork adjust_network(const CalibrationFlight& flight, const trajectory::SmoothedFlight& smoothed, const NetworkOptions& options,
                               core::Tally& tally, const core::OnProgress& progress = core::unwatched);

/// How two lines differ on the planes that both see, rms over planes and pairs, m.
struct PlaneAgreement {
  std::uint64_t pairs = 0;
  double before = 0.0, after = 0.0;
};
PlaneAgreement agreement_on_planes(const AdjustedNetwork& network);

}  // namespace swath::calib
