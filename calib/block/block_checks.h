// SPDX-License-Identifier: GPL-3.0-or-later
// Usual mistakes of conventions, found before the adjustment: residuals at the start values, as stated and with one thing changed.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "calib/block/block_reading.h"

namespace swath::calib {

/// Residuals of a sample of points at start values: medians over tie points and over control points, mm on the image.
struct StartResidual {
  double tie = 0.0, control = 0.0;
  double sum() const { return tie + control; }
};
StartResidual start_residual(const ImageBlock& block);

/// A part of a block for tests: points that most strips see, all control, all images.
ReadBlock sample_of(const ReadBlock& read, size_t points);

/// Throws core::Error that names the mistake where another convention fits the image points three times better: image axes (y up or down,
/// mirrored, turned), kind and sense of angles, north, stations of the neighbouring image, control in feet.
void refuse_mistakes(const ReadBlock& read, const BlockConfig& config);

}  // namespace swath::calib
