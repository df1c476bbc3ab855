// SPDX-License-Identifier: GPL-3.0-or-later
// What the flat-target analysis found, as a tree of values, as a table of readings and drawn.
#pragma once

#include <string>

#include "calib/target/flat_target.h"
#include "core/config/value.h"
#include "report/chart.h"

namespace swath::calib {

/// Everything: target, lines before and after, readings, angles, range, what all determine jointly, findings. SI units, angles in deg and
/// arcsec where the key says so.
core::Value value_of(const calib::FlatTarget& t);

/// The part for the run's report: angles with sigmas, range offset, scan scale, findings.
core::Value summary_of(const calib::FlatTarget& t);

/// One row per reading: quantity, lines, the value it speaks for, its sigma. Angles in deg and arcsec, range in m.
std::string readings_csv(const calib::FlatTarget& t);

/// Plan of the target with each line's edges before and after (displacements enlarged); readings of the angles; heights.
report::Chart chart_of(const calib::FlatTarget& t);

}  // namespace swath::calib
