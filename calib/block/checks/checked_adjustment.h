// SPDX-License-Identifier: GPL-3.0-or-later
// A block that was read, on to what is written of it.
#pragma once

#include "calib/block/block_findings.h"

namespace swath::calib {

struct CheckedAdjustment {
  ReadBlock stated;  ///< before the adjustment
  BlockSolution solution;
  BlockFound found;
};

/// Refuses mistakes, adjusts `read`, refuses what only the adjusted block shows, and sums up. Throws core::Error as refuse_mistakes(),
/// adjust_block() and refuse_wrong_stations() do.
CheckedAdjustment adjust_checked(ReadBlock& read, const BlockConfig& config);

}  // namespace swath::calib
