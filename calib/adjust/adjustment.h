// SPDX-License-Identifier: GPL-3.0-or-later
// Result of the rigorous adjustment: what was estimated, how well, and what could not be determined.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <limits>
#include <string>
#include <string_view>
#include <vector>

#include "calib/terms.h"
#include "calib/ties/tie_set.h"
#include "core/records/sensor.h"
#include "georef/shot_geometry.h"

namespace swath::calib {

/// A value that still moves by more than this share of its sigma is not settled.
constexpr double settled_step = 0.5;

constexpr double not_known = std::numeric_limits<double>::quiet_NaN();

/// What an estimated value is worth.
enum class Grade {
  held,          ///< not estimated
  good,          ///< sigma within the limits
  coarse,        ///< determined, sigma beyond the limits
  undetermined,  ///< the flight adds too little to the start value: not delivered
  unsettled,     ///< still moving when the rounds ended: not delivered
};
std::string_view name_of(Grade grade);

/// One calibration parameter (boresight_roll .. latency of calib::Parameter). Units m, rad, s or none.
struct Estimate {
  Parameter parameter = boresight_roll;
  bool estimated = false;  ///< false: held at `start`
  bool delivered = false;  ///< false: not determined or not settled (see the findings), `value` is that of the start
  Grade grade = Grade::held;
  double start = 0.0, value = 0.0;
  double found = 0.0, found_sigma = 0.0;                     ///< what the adjustment found, delivered or not
  double apriori = std::numeric_limits<double>::infinity();  ///< sigma of `start` as an observation; infinite: free
  double formal = 0.0;                                       ///< sigma with the trajectory's errors correlated in time
  double white = 0.0;  ///< sigma if every return were independent and the trajectory without error: for comparison only
  double jackknife_lines = not_known, jackknife_planes = not_known;  ///< sigma by leaving out one line, one region of planes at a time
  double held = 0.0;   ///< sigma by the calibration values that are held: what their stated sigmas do to this one
  double sigma = 0.0;  ///< of `value`: the larger of formal and jackknife_lines (of four lines or more), or more where regions say so, with
                       ///< `held`; not delivered: `apriori`
  double determined = 0.0;  ///< 1 - (formal / apriori)^2: share of the knowledge that is the data's; 1 for free parameters
};

/// Corrections to the trajectory along one line, linear in time between the knots: add them to the trajectory.
struct LineCorrection {
  int line = 0;                                              ///< id
  std::vector<double> time;                                  ///< knots, GPS time, s
  std::vector<std::array<double, 6>> value, sigma, apriori;  ///< north, east, down (m), roll, pitch, heading (rad)
  /// What an error of each calibration value that was held moves `value` by, per unit of it: columns boresight_roll .. latency. `sigma`
  /// holds what the stated sigmas of those values do.
  std::vector<Eigen::Matrix<double, 6, latency + 1>> response;
};

/// What is left of one group of returns (one line on one plane) after the adjustment.
struct GroupResidual {
  std::uint32_t plane = 0, line = 0, returns = 0;
  double time = 0.0;        ///< mean, s
  double angle = 0.0;       ///< mean calibrated scan angle, rad
  double range = 0.0;       ///< mean, m
  double before = 0.0;      ///< mean distance from the plane with the start values (plane of all lines, refitted), m
  double after = 0.0;       ///< mean distance from the adjusted plane, m
  double rms = 0.0;         ///< of the returns about the adjusted plane, m
  double redundancy = 0.0;  ///< of the group's mean as one observation, 0 to 1
  double w = 0.0;           ///< its standardised residual (Baarda's w)
  bool rejected = false;    ///< taken out by data snooping
};

struct ControlResidual {
  std::string name;
  std::uint32_t plane = 0;
  double residual = 0.0, sigma = 0.0, redundancy = 0.0, w = 0.0;  ///< m; w standardised
  bool rejected = false;
};

struct VarianceComponent {
  std::string name;     ///< "range", "angle", "surface", "trajectory position" (perhaps by scale), "trajectory attitude", "control"
  double stated = 0.0;  ///< sigma as stated (m, rad; surface: start value; trajectory: rms over the knots)
  double factor = 1.0;  ///< estimated sigma / stated
  double redundancy = 0.0;
  bool estimated = false;  ///< false: too little redundancy, the stated one was kept
};

/// One return after the adjustment: for plots.
struct ResidualSample {
  std::uint32_t group = 0;                      ///< number in TieSet::groups
  double time = 0.0, angle = 0.0, range = 0.0;  ///< s, rad and m, calibrated
  double residual = 0.0;                        ///< distance from the adjusted plane, m
  double sigma = 0.0;                           ///< of that distance by ranges, angles and roughness, m
};

/// One thing that the flight does not show, or that looks wrong, in words.
struct Finding {
  std::string what;                   ///< "pitch and along-track shift cannot be separated: only one line direction"
  std::string cure;                   ///< "fly one line in the opposite direction ..."
  std::vector<Parameter> parameters;  ///< concerned
  bool refuses = false;               ///< true: the values of those parameters are not delivered
};
/// "WHAT: CURE", each.
std::vector<std::string> sentences(const std::vector<Finding>& findings);

struct Adjustment {
  core::Calibration calibration;                  ///< start values with the estimates put in
  std::array<Estimate, latency + 1> estimates{};  ///< by Parameter
  Eigen::MatrixXd correlation;                    ///< of the estimated ones, in the order of Parameter; 1 on the diagonal
  /// Of the found values by themselves, 11 x 11 by Parameter, 0 where not estimated; and what each calibration value is moved by where a
  /// held one (column) is one sigma larger: the sigma itself on the diagonal of those held. Empty: nothing was adjusted.
  Eigen::MatrixXd formal, held;
  Eigen::MatrixXd held_correlation;          ///< of the held ones, 11 x 11
  double condition = 0.0;                    ///< of the normal matrix scaled to ones on its diagonal, estimated parameters alone
  std::vector<LineCorrection> corrections;   ///< in the order of TieSet::lines
  std::vector<TiePlane> planes;              ///< centre and normal adjusted
  std::vector<Eigen::Vector3d> plane_sigma;  ///< of d0 (m), d1, d2
  std::vector<GroupResidual> groups;         ///< in the order of TieSet::groups
  std::vector<ControlResidual> control;
  std::vector<VarianceComponent> components;
  std::vector<Finding> findings;
  std::vector<ResidualSample> samples;  ///< every n-th return of the groups in use, so that there are 20 000 at most
  double sigma0 = 0.0;                  ///< of unit weight after the variance components
  std::uint64_t observations = 0, unknowns = 0, rejected_returns = 0;
  double knot_spacing = 0.0;   ///< of the corrections, s: as stated or wider
  bool waves_between = false;  ///< what is left on the planes goes together within half of it (calib/adjust/short_waves.h)
  int iterations = 0;
  bool converged = false;
  double last_step = 0.0;  ///< largest step of a calibration value in the last linearisation, in its sigmas
};

/// Covariance of the errors of the delivered calibration, 11 x 11 by Parameter: estimated values with their sigmas, held ones with theirs,
/// those that were withdrawn with that of their start.
Eigen::MatrixXd delivered_covariance(const Adjustment& adjustment);

/// Values that are not delivered: back to the start with its a-priori sigma. What was found stays in `found` and `found_sigma`.
void withdraw(Adjustment& adjustment, const std::vector<Parameter>& parameters, Grade grade);

}  // namespace swath::calib
