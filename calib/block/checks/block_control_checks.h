// SPDX-License-Identifier: GPL-3.0-or-later
// Control against where the images see it, before the adjustment.
#pragma once

#include "calib/block/block_reading.h"

namespace swath::calib {

/// Another convention or unit fits better where misfits are this many times smaller.
inline constexpr double clearly = 3.0;
/// International foot, m.
inline constexpr double foot = 0.3048;

/// Throws core::Error where control points lie far from where rays of the start values meet, naming what would explain it: feet, heights in
/// feet, easting and northing exchanged, a principal distance ten times off, points under another's name.
void refuse_far_control(const ReadBlock& read);

}  // namespace swath::calib
