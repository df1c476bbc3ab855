// SPDX-License-Identifier: GPL-3.0-or-later
// From returns to normal equations: one small dense block per group of returns (one line on one plane), all that later steps need.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "calib/adjust/correction_knots.h"
#include "calib/adjust/robust_weight.h"
#include "calib/terms.h"
#include "calib/ties/tie_set.h"
#include "georef/shot_geometry.h"
#include "trajectory/trajectory.h"

namespace swath::calib {

/// The value of a calibration parameter (boresight_roll .. latency).
double value_of(const core::Calibration& c, Parameter p);
void set_value(core::Calibration& c, Parameter p, double value);

/// Moves a plane by its unknowns: along its normal by d[0], tilted by the slopes d[1] along u and d[2] along v.
void move_plane(TiePlane& plane, const Eigen::Vector3d& d);

/// Where the adjustment stands.
struct TieState {
  core::Calibration calibration;
  Eigen::VectorXd correction;     ///< unknowns of CorrectionKnots
  std::vector<TiePlane> planes;   ///< centre and normal move; the unknowns d0, d1, d2 are zero at every linearisation
  std::vector<double> roughness;  ///< of each plane beyond that of most, m: noise of its own
};

/// Sigmas of single records.
struct TieNoise {
  double range = 0.02;    ///< m
  double angle = 0.0;     ///< rad, as recorded
  double pointing = 0.0;  ///< rad, about both axes across the beam
  double time = 0.0;      ///< s
};

/// The normal equations of one group: minimise sum w (f + a . x)^2 over x = (global unknowns, corrections, d0, d1, d2), f the distance
/// from the plane in m, 1 / w its variance.
struct GroupBlock {
  std::vector<int> index;                       ///< numbers of the unknowns but the plane's three, which come last in N and b
  Eigen::MatrixXd N;                            ///< sum w a a^T; symmetric, filled
  Eigen::VectorXd b;                            ///< sum w a f
  double c = 0.0;                               ///< sum w f^2
  std::uint32_t used = 0;                       ///< returns with a weight
  std::uint32_t rejected = 0, outside = 0;      ///< without: far from their group; at a time without trajectory
  double angle = 0.0, range = 0.0, time = 0.0;  ///< means over the used
  double depth = 0.0;                           ///< mean distance along the vertical from scanner to point, m
  double noise = 0.0;                           ///< mean variance of the records alone, m^2
  double moment[5] = {};  ///< for range and angle sigma: sums over returns of q_r^2, q_r q_a, q_a^2, q_r (e - q_0), q_a (e - q_0)

  double weight() const { return N(index.size(), index.size()); }  ///< sum of w
};

/// Everything that stays the same from round to round.
struct TieProblem {
  const TieSet* ties = nullptr;
  const core::Scanner* scanner = nullptr;
  const trajectory::Trajectory* trajectory = nullptr;
  const CorrectionKnots* knots = nullptr;
  std::vector<Parameter> globals;  ///< the unknown calibration values, rising
  RobustWeight robust{2.5, 6.0};
  int threads = 1;

  int size() const { return static_cast<int>(globals.size()) + knots->size(); }
};

struct TiePass {
  std::vector<GroupBlock> blocks;  ///< in the order of TieSet::groups
  std::vector<float> deviation;    ///< of each return from its group's median, in sigmas as stated; NaN outside the trajectory
  double scale = 1.0;              ///< robust sigma of the deviations
};

/// Linearises every return at `state`. Weights of single returns by their deviation from the group's median, in sigmas times `scale`.
TiePass linearise(const TieProblem& problem, const TieState& state, const TieNoise& noise, double scale);

/// One return at a state: distance from its plane, its derivatives and its variance.
struct Condition {
  double f = 0.0;                                   ///< m
  Eigen::Matrix<double, 1, parameter_count> by;     ///< per unit of each parameter
  double u = 0.0, v = 0.0;                          ///< place in the plane's axes, m
  double range = 0.0, angle = 0.0, constant = 0.0;  ///< parts of its variance, m^2: ranges; angles and pointing; time and roughness
  double depth = 0.0;                               ///< along the vertical from scanner to point, m
  double variance() const { return range + angle + constant; }
};
/// Squares of the deviations from a group's mean, against the shares of ranges and angles in the variance: fills block.moment. Conditions
/// whose f is not finite take no part; `deviation`: of each from the group's median in sigmas, `scale` their robust sigma.
void add_moments(const RobustWeight& robust, const std::vector<Condition>& conditions, const float* deviation, double scale, double mean,
                 GroupBlock& block);
/// `cursor` at any time; false where the trajectory does not reach.
bool condition_of(const TieProblem& problem, const ShotGeometry& geometry, const TieState& state, const TieNoise& noise,
                  trajectory::Cursor& cursor, const TieGroup& group, size_t row, Condition& out);

}  // namespace swath::calib
