// SPDX-License-Identifier: GPL-3.0-or-later
// Bundle adjustment of a block: collinearity, control, stations with shift and drift, attitudes, self-calibration; robust weights, variance
// components, covariance and tests.
//
// Sources: Ackermann, eq 1 (stations); Brown 1971 (camera); Baarda 1968 (tests); Foerstner 1979 (components). Stations and attitudes of
// different images are independent beside the unknown shift and drift of their sets, or correlated as a chain says (navigation/).
#pragma once

#include <string>
#include <vector>

#include "calib/block/block_inference.h"
#include "core/config/option.h"

namespace swath::calib {

struct BlockOptions {
  bool robust = true;
  double full_weight = 3.0, no_weight = 8.0;
  bool components = true;
};

template <class V>
void describe(BlockOptions& o, V& v) {
  v.option("robust", o.robust, "Weights that fall with the residual, so that wrong image points do not count.", "Baarda1968");
  v.option("full_weight", o.full_weight, core::above(0), "Residual up to which an image point has its full weight, in robust sigmas.");
  v.option("no_weight", o.no_weight, core::above(0), "Residual from which on it has none.");
  v.option("components", o.components, "Factors on the sigmas of image points, stations, attitudes and control from their residuals.",
           "Foerstner1979");
  v.check(o.no_weight > o.full_weight, "no_weight must be larger than full_weight");
}

struct BlockSolution {
  BlockConvergence convergence;
  BlockInference inference;
  LinearBlock linear;  ///< observations and residuals at the solution; derivatives are dropped
  BlockWeights weights;
  size_t observations = 0, unknowns = 0;
  double square_sum = 0.0;  ///< v' P v of all that has a weight
  int rounds = 0;
  size_t without_weight = 0;              ///< image points
  size_t points_left_out = 0;             ///< seen too rarely, or of parallel rays
  std::vector<char> component_estimated;  ///< rays, stations, attitudes, control

  /// Observations less unknowns, and less what image points without weight have of it.
  double redundancy() const { return static_cast<double>(observations) - static_cast<double>(unknowns) - inference.redundancy_lost; }
  double sigma0() const;  ///< root of the variance factor; 1 where sigmas and residuals agree
};

/// Adjusts; `block` holds the adjusted values afterwards. Start values must be within the range of convergence. Throws core::Error where
/// the block is not determined, naming what is not.
BlockSolution adjust_block(ImageBlock& block, const BlockOptions& options);

}  // namespace swath::calib
