// SPDX-License-Identifier: GPL-3.0-or-later
// Observed attitudes against those of the adjusted images: conventions of angles that differ too little for start values to show.
#pragma once

#include "calib/block/block_reading.h"

namespace swath::calib {

/// Throws core::Error where observed attitudes differ from the adjusted ones by three of their sigmas or more, and angles read another way
/// by a third of that at most: omega phi kappa for phi omega kappa, small angles with the other sign. `stated`: before the adjustment.
void refuse_wrong_attitudes(const ReadBlock& stated, const ReadBlock& adjusted, const BlockConfig& config);

}  // namespace swath::calib
