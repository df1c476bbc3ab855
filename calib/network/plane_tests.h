// SPDX-License-Identifier: GPL-3.0-or-later
// What the residuals of groups of returns (one line on one plane) say of the groups and of the surfaces' sigma.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "calib/network/plane_factors.h"
#include "calib/sparse/node_matrix.h"

namespace swath::calib {

/// Test of one group's displacement along the normal.
struct GroupTest {
  double w = 0.0;             ///< standardised; 0 where the others do not control it
  double redundancy = 0.0;    ///< share of a displacement that shows in the residual, 0 to 1
  double displacement = 0.0;  ///< estimate of it, m
};

/// A surveyed point against its plane.
struct ControlTest {
  std::string name;
  std::uint32_t plane = 0;
  double residual = 0.0, sigma = 0.0;  ///< m; its sigma
  double redundancy = 0.0, w = 0.0;
};

/// Sums over one kind of observation.
struct KindSums {
  std::uint64_t observations = 0;
  double redundancy = 0.0, squares = 0.0;  ///< squares of weighted residuals
};

struct PlaneTests {
  std::vector<GroupTest> group;
  std::vector<ControlTest> points;
  std::vector<Eigen::Vector3d> plane_sigma;  ///< of each plane's step: m along the normal, slopes; NaN where no group takes part
  std::uint64_t planes = 0;                  ///< that take part
  KindSums means, returns, control;          ///< of groups; of single returns about their groups; of surveyed points
  /// Derivative of the restricted log-likelihood by the surfaces' variance, times two, and its expected square: a step is their ratio.
  double score = 0.0, information = 0.0;
};

/// Of a solution: the normal equations' factor, inverted, and its step; the planes' part as it was added to them.
PlaneTests test_planes(const PlaneFactors& planes, const FlightStates& states, const NodeFactor& factor, const Eigen::VectorXd& step);

/// True where the groups have 10 degrees of freedom or more: fewer do not determine the surfaces' sigma, and could bring it to nothing.
bool surface_is_known(const PlaneTests& tests);

/// Moves the surfaces' sigma to where the residuals are as large as expected, by a factor of 2 at most; not where it is not known. True
/// where the groups' variances change by 2 % or more.
bool update_surface(PlaneFactors& planes, const PlaneTests& tests);

/// Leaves out groups with |w| above the critical value of `alpha`, one per plane, the largest first, not more than `share` of all together;
/// none goes twice. Returns the number of those that went now.
int reject_groups(PlaneFactors& planes, const PlaneTests& tests, double alpha, double share);

}  // namespace swath::calib
