// SPDX-License-Identifier: GPL-3.0-or-later
// The part of a calibration's report that sets the flat-target analysis beside the adjustment.
#pragma once

#include "calib/report/page_parts.h"

namespace swath::calib {

/// Readings with their agreement, and the analysis as tables (target_tables.h). Nothing where there was none.
void add_target(const PageParts& parts);

}  // namespace swath::calib
