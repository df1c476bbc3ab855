// SPDX-License-Identifier: GPL-3.0-or-later
// The parts of a calibration's report that show what was found and how well.
#pragma once

#include "calib/report/page_parts.h"

namespace swath::calib {

/// Calibration values with all their sigmas beside the nominal ones.
void add_values(const PageParts& parts);
/// Of a strip adjustment, in their place: how the lines meet on planes.
void add_plane_differences(const PageParts& parts);
/// The adjustment in figures, and the variances it found.
void add_summary(const PageParts& parts);
/// None where fewer than two values are estimated.
void add_correlations(const PageParts& parts);

}  // namespace swath::calib
