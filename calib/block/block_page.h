// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>

#include "calib/block/block_findings.h"

namespace swath::calib {

/// report.html of a block: verdict, precision, check points, plan with ellipses, residuals on the image plane, drifts, cameras with their
/// correlation, tests.
std::string block_page(const ReadBlock& read, const BlockConfig& config, const BlockSolution& solution, const BlockFound& found);

}  // namespace swath::calib
