// SPDX-License-Identifier: GPL-3.0-or-later
// What a surveyor sees of laser records at a glance: angles and ranges that no scanner has, times that are not the trajectory's.
#pragma once

#include <vector>

#include "core/report.h"
#include "io/records/laser_file.h"

namespace swath::io {

/// Throws core::Error where no line, its latency added, has a time in common with the trajectory's `times`; these rise, and there are some.
void hold_common_times(const Survey& survey, const std::vector<StripInfo>& strips, const std::vector<double>& times);

/// Counts flight lines that look wrong, with first examples; changes nothing. `strips`: all of the survey, as scan() gives them. Of each
/// the first records are read, and with them what LaserSource throws.
void check_laser(const Survey& survey, const std::vector<StripInfo>& strips, core::Tally& tally);

}  // namespace swath::io
