// SPDX-License-Identifier: GPL-3.0-or-later
// The body's front, as mount and boresight of a camera have it, against the direction of flight.
#pragma once

#include <string>
#include <vector>

#include "calib/block/block_reading.h"

namespace swath::calib {

/// One sentence for each camera whose images have the body fly sideways or backwards, where attitudes are those of the camera, so that no
/// residual shows a wrong mount. Nothing where they are the body's, or level along the strips.
std::vector<std::string> mount_findings(const ReadBlock& adjusted, const BlockConfig& config);

}  // namespace swath::calib
