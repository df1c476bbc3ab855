// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "core/config/value.h"
#include "report/page.h"

namespace swath::calib {

/// flat_target.json as the calibration page shows it: the angles with their tolerances (id target-angles), every reading (target-readings)
/// and the target's displacement in each line before and after (target-lines). Tables without a row are left out; so is what the tree does
/// not show.
std::vector<report::Table> target_tables(const core::Value& flat_target);

}  // namespace swath::calib
