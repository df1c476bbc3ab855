// SPDX-License-Identifier: GPL-3.0-or-later
// Parts of a block for tests of its start values: some of the points, all control, all images.
#pragma once

#include "calib/block/block_reading.h"

namespace swath::calib {

/// The points that most strips see.
ReadBlock sample_of(const ReadBlock& read, size_t points);

/// Of the same, as many as leave no image with fewer than `per_image` of them, where it has as many.
ReadBlock sample_by_image(const ReadBlock& read, int per_image);

}  // namespace swath::calib
