// SPDX-License-Identifier: GPL-3.0-or-later
// Values of a camera that are held: would the image points fit better with the distortion of the other point, or with the other sign of the
// principal point?
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "calib/block/block_system.h"

namespace swath::calib {

/// One sentence for each camera whose image points fit clearly better so, by the squares of all residuals once everything is adjusted anew.
/// `adjusted`: at its solution with these weights.
std::vector<std::string> held_value_findings(ImageBlock adjusted, const BlockWeights& weights);

/// Squares of each column of residuals (rows of `linear`) once the unknowns have taken up what they can, by the linear equations.
Eigen::VectorXd adjusted_squares(const LinearBlock& linear, const Eigen::MatrixXd& residuals);

}  // namespace swath::calib
