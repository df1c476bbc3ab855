// SPDX-License-Identifier: GPL-3.0-or-later
// Values of cameras that are stated with a sigma against what the block makes of them.
#pragma once

#include <string>
#include <vector>

#include "calib/block/block_findings.h"

namespace swath::calib {

/// One sentence for each value, boresight angle and coordinate of an antenna (of a run: of the lever arm) that lies four standard
/// deviations of the difference or more from what is stated; with its sign where the opposite one explains it. `stated`: before the
/// adjustment.
std::vector<std::string> stated_value_findings(const ReadBlock& stated, const BlockConfig& config, const BlockFound& found);

}  // namespace swath::calib
