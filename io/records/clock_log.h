// SPDX-License-Identifier: GPL-3.0-or-later
// Logs that show how far a computer's clock stood from UTC.
#pragma once

#include <filesystem>

#include "core/records/clock_data.h"
#include "core/report.h"
#include "io/survey/survey.h"

namespace swath::io {

/// Reads one log. Lines begin with the Modified Julian Day and the second of the UTC day; fields are separated by commas, semicolons, tabs
/// or blanks; empty lines and those that begin with # or % are passed over. A first line of names says where the columns are, by what
/// they begin with: mjd, sec or utc_sec, offset, jitter; without it they stand as ntpd documents them.
///   loopstats  MJD, seconds, offset s, frequency PPM, jitter s, ... Lines of less than six fields have no jitter.
///   peerstats  MJD, seconds, address, status (hexadecimal), offset s, delay s, dispersion s, jitter s. Taken are the records of the source
///              that steered the clock: those whose selection (the status' bits 8-10) is the PPS peer (7) where there are any, else those
///              of the system peer (6); where the file never names a selected source and has only one, all of it.
///   pps        Time of each pulse by the clock: MJD and seconds of day, or POSIX seconds alone ("#" and a sequence number may follow).
///              Pulses stand on whole seconds of UTC: the clock must be right to half a second.
/// A line that has the form of another format is an error. Where the clock was set back, what lies before is left out and counted: its
/// times are no longer unique. Records at a repeated time are left out and counted. Throws Error "file:line" for a line that cannot be
/// read.
core::ClockData read_clock_log(const std::filesystem::path& file, ClockFormat format, core::Tally& tally);

/// All logs of the survey, joined in time order; epoch is that of the first. Throws Error where they are of different formats (two views of
/// one clock have no order), or overlap.
core::ClockData read_clock_logs(const Survey& survey, core::Tally& tally);

}  // namespace swath::io
