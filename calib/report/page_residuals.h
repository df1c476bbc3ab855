// SPDX-License-Identifier: GPL-3.0-or-later
// The parts of a calibration's report that show what was observed, and what is left of it.
#pragma once

#include "calib/report/page_parts.h"

namespace swath::calib {

/// Lines, overlaps, tie planes.
void add_flight(const PageParts& parts);
/// Groups of returns about their planes: all, and by line, scan angle, range and time.
void add_residuals(const PageParts& parts);
/// Groups that data snooping took out.
void add_outliers(const PageParts& parts);
/// Surveyed points: those that took part, and those that only check.
void add_control(const PageParts& parts);

}  // namespace swath::calib
