// SPDX-License-Identifier: GPL-3.0-or-later
// What the flat-target analysis found, as results and as a table of readings.
#pragma once

#include <string>
#include <vector>

#include "calib/report/report_data.h"
#include "calib/target/flat_target.h"
#include "core/config/result.h"

namespace swath::calib {

/// Everything: target, lines before and after, readings, angles, range, what all determine jointly, findings. SI units, angles in deg and
/// arcsec where the key says so.
core::Value value_of(const FlatTarget& t);

/// The readings in such a tree; none where it has none.
std::vector<TargetReading> readings_in(const core::Value& tree);

/// The part for the run's report: angles with sigmas, range offset, scan scale, findings.
void describe(const FlatTarget& t, core::ResultVisitor& v);

/// One row per reading: quantity, lines, the value it speaks for, its sigma. Angles in deg and arcsec, range in m.
std::string readings_csv(const FlatTarget& t);

}  // namespace swath::calib
