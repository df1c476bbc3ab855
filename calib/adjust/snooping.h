// SPDX-License-Identifier: GPL-3.0-or-later
// Data snooping: is this plane displaced in this line, is this control point wrong?
#pragma once

#include <vector>

#include "calib/adjust/adjust_options.h"
#include "calib/adjust/tie_system.h"

namespace swath::calib {

/// Test of one group of returns (its common displacement along the normal) or of one control observation.
struct TieTest {
  double w = 0.0;             ///< standardised; 0 where the others do not control it
  double redundancy = 0.0;    ///< share of a displacement that shows in the residuals, 0 to 1 (1 for what takes no part)
  double displacement = 0.0;  ///< estimate of it, m
  double information = 0.0;   ///< its inverse variance, 1 / m^2
};

struct TieTests {
  std::vector<TieTest> group, control;
};
/// For all groups and control; what is not in `use` is compared with its prediction.
TieTests tests_of(const TieSystem& system, const TieSolution& solution, const std::vector<PlaneRest>& rests, const TieSelection& use);

/// Takes the largest |w| above the critical value out of `use`, and with it all others over half of that size, one per plane. At most
/// `share` of all may be out. Returns how many were taken out now; `full`: more would have gone.
int reject_worst(const TieSystem& system, const TieTests& tests, const SnoopingOptions& options, TieSelection& use, bool& full);

/// Does control as a whole lie elsewhere? From its misfits before it took part.
struct ControlShift {
  bool shifted = false;
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();  ///< east, north, up: control less planes, m
  std::array<bool, 3> known{};                     ///< the planes' directions determine this component
};
ControlShift control_shift(const TieSystem& system, const std::vector<TiePlane>& planes, const TieSolution& solution,
                           const std::vector<PlaneRest>& rests);

}  // namespace swath::calib
