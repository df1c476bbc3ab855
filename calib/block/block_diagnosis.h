// SPDX-License-Identifier: GPL-3.0-or-later
// What the observations of a block do not determine, in words, and what would.
#pragma once

#include <string>
#include <vector>

#include "calib/block/block_normals.h"

namespace swath::calib {

/// A combination of unknowns that the observations say nothing about.
struct UndeterminedMode {
  double eigenvalue = 0.0;  ///< of the normal equations scaled to a unit diagonal
  std::string what, hint;
};

/// The modes below `limit`, at most eight, the least determined first.
std::vector<UndeterminedMode> undetermined_modes(const ImageBlock& block, const LinearBlock& linear, double limit = 1e-10);

/// Throws core::Error with what is not determined and what would determine it, where infer() finds that the block is not.
[[noreturn]] void refuse_undetermined(const ImageBlock& block, const LinearBlock& linear, const std::vector<std::uint32_t>& unsound_points);

}  // namespace swath::calib
