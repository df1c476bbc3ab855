// SPDX-License-Identifier: GPL-3.0-or-later
// Usual mistakes of conventions, found before the adjustment: residuals at the start values, as stated and with one thing changed.
#pragma once

#include <string>
#include <vector>

#include "calib/block/block_adjust.h"
#include "calib/block/block_reading.h"

namespace swath::calib {

/// Residuals of a sample of points at start values: medians over tie points and over control points, mm on the image.
struct StartResidual {
  double tie = 0.0, control = 0.0;
  double sum() const { return tie + control; }
};
StartResidual start_residual(const ImageBlock& block);

/// Throws core::Error that names the mistake where another convention fits the image points three times better: image axes (y up or down,
/// mirrored, turned), kind, sense and unit of angles, north, stations of the neighbouring image in the block or in one strip from an image
/// on; or where image points are off the sensor, or control is far from where the images see it.
void refuse_mistakes(const ReadBlock& read, const BlockConfig& config);

/// After the adjustment, where stations or many image points do not fit by far: a block that started level has attitudes now. Throws
/// core::Error that names a missing event or a shifted strip. `stated`: before the adjustment.
void refuse_wrong_stations(const ReadBlock& stated, const ReadBlock& adjusted, const BlockSolution& solution, const BlockConfig& config);

}  // namespace swath::calib
