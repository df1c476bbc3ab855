// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "core/records/gnss_data.h"
#include "core/report.h"
#include "io/survey/survey.h"

namespace swath::io {

/// Reads one GNSS file of the survey by its format: delimited text with a column map (geodetic or ECEF; full covariance, sigmas or none;
/// velocities or none), RTKLIB's solutions (io/gnss/rtklib_pos.h) or NMEA (io/gnss/nmea.h). Times have the antenna's latency added. What is
/// left out, replaced and counted: io/gnss/fix_list.h. Text: latitudes beyond a quarter turn are an error; latitudes and longitudes in
/// degrees that would all be radians are counted as a warning.
core::GnssData read_gnss(const Survey& survey, const GnssFile& file, core::Tally& tally);

/// All GNSS files of the survey, joined in time order; velocities are NaN where one file has none. Throws Error naming both files where
/// two overlap in time.
core::GnssData read_gnss(const Survey& survey, core::Tally& tally);

}  // namespace swath::io
