// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "core/records/imu_data.h"
#include "core/report.h"
#include "io/survey/survey.h"

namespace swath::io {

/// Reads one IMU file of the survey as increments in `body`.
///
/// Times: those of the file on their scale; jitter of more than 1 % of the step is smoothed away (settle_times), unless `even_times` is
/// off. `stamp` start or middle moves them to the end of the interval by a step or half of one. The step of a record is the difference to
/// the record before, so that steps without a gap add up to the time passed; after a gap (and at the start) it is the nominal one, so that
/// time[k-1] < time[k] - step[k] there. A gap is a difference of over 1.5 nominal steps; of increments, whose length is known, already one
/// that is longer than the others (settle_times, strict).
/// Rates: `mean` makes value * step; `instant` the trapezoid of neighbours, the first record of a stretch being only its left end (it gives
/// no increment and is counted). Increments are taken as they are.
///
/// Left out and counted: records with a value that is empty or not finite, records at a repeated time. Counted: gaps with their lengths,
/// smoothed times, records that repeat the values of the one before, what looks implausible (check_imu).
/// Throws Error naming line or record: no number, time going back; and for the file: over 3 % of records not finite, over 5 % at a repeated
/// time, units or axes that cannot be those stated.
core::ImuData read_imu(const Survey& survey, const ImuFile& file, core::Tally& tally);

/// All IMU files of the survey, joined in time order. Throws Error naming both files where two overlap in time.
core::ImuData read_imu(const Survey& survey, core::Tally& tally);

}  // namespace swath::io
