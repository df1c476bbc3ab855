// SPDX-License-Identifier: GPL-3.0-or-later
// Image points against the sensor that they are on.
#pragma once

#include "calib/block/block_reading.h"

namespace swath::calib {

/// Throws core::Error where the image points of a camera reach beyond its sensor, or fill but a corner of it, naming the origin or the unit
/// that puts them on it.
void refuse_off_sensor(const ReadBlock& read, const BlockConfig& config);

}  // namespace swath::calib
