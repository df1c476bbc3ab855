// SPDX-License-Identifier: GPL-3.0-or-later
// One strip whose stations are those of the neighbouring image, from one of its images on.
#pragma once

#include "calib/block/block_reading.h"

namespace swath::calib {

/// Throws core::Error that names the strip and the image where the residuals of the points on the moved images fall to less than one part
/// in `times` of what they are as stated.
void refuse_shifted_strip(const ReadBlock& read, const BlockConfig& config, double times);

}  // namespace swath::calib
