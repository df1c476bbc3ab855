// SPDX-License-Identifier: GPL-3.0-or-later
// Sigmas by leaving out one line, or one region of planes, at a time.
#pragma once

#include <vector>

#include "calib/adjust/tie_system.h"

namespace swath::calib {

struct Jackknife {
  Eigen::VectorXd sigma;    ///< of each global unknown: sqrt((J - 1) / J sum (x_j - x)^2)
  Eigen::VectorXd ratio;    ///< to what it should be if the covariances are true; 0 where nothing can be left out
  Eigen::VectorXd freedom;  ///< of that ratio
  int replicates = 0;
};

/// `out`: the groups of each replicate that are left out (numbers into TieSet::groups). `full`: normal equations with the prior, whose
/// solution is `solution`.
Jackknife jackknife(const TieProblem& problem, const TieSystem& system, const TieSelection& use, const Normals& full,
                    const TieSolution& solution, const std::vector<std::vector<size_t>>& out);

/// The groups in use of each line.
std::vector<std::vector<size_t>> groups_by_line(const TieSet& ties, const TieSelection& use);
/// Those of `count` regions of about equally many planes, halved across their longer side until there are enough.
std::vector<std::vector<size_t>> groups_by_region(const TieSet& ties, const TieSelection& use, int count);

/// Factor on the formal sigma: 1 unless the jackknife's ratio is larger than chance makes it with probability `significance`; then the
/// ratio divided by what chance makes it.
double enlargement(double ratio, double freedom, double significance);

}  // namespace swath::calib
