// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "calib/target/flat_target.h"
#include "report/chart.h"

namespace swath::calib {

/// Plan of the target with each line's edges before and after (displacements enlarged); readings of the angles; heights.
report::Chart chart_of(const FlatTarget& t);

}  // namespace swath::calib
