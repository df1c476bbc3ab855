// SPDX-License-Identifier: GPL-3.0-or-later
// Which contour interval a model carries, by its own sigma.
#pragma once

#include "core/config/value.h"
#include "core/grid.h"
#include "stages/stage.h"

namespace swath::stages {

/// What a tile says of its surface besides the segments; plain data, the file holds it and then the spot heights.
struct SurfaceFacts {
  double sum_of_heights = 0.0, sum_of_variances = 0.0;
  std::uint64_t heights = 0, sigmas = 0;
  std::uint64_t beyond = 0;  ///< cells whose own sigma keeps no class of maps at the interval
};

/// Of the cells of `own`.
SurfaceFacts facts_of(const core::Grid& grid, const core::Lattice& own, double interval);

/// The interval against the model's sigma: findings and, where it is too small, words.
void judge_interval(const Context& context, const SurfaceFacts& f, double interval, core::Value& findings);

}  // namespace swath::stages
