// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <string>

#include "core/config/value.h"

namespace swath::io {

/// What a file holds, found from its content: LAS/LAZ, SBET, smrmsg, Optech CSD, NumPy, solutions and time tags of RTKLIB, NMEA, RINEX,
/// events of u-blox, NovAtel and DJI, logs of a clock (loopstats), hangar surveys, captured packets (PCAP), delimited text, survey.toml (or
/// .json), pipelines, reports and calibrations of this program, GeoTIFF, GeoPackage, GeoJSON, DXF and what else GDAL reads. A table with
/// `file`, `bytes`, `format`, counts, extents, times, CRS, statistics, and `warnings`, a list of texts: what looks wrong. Throws
/// core::Error where the file cannot be read or is of no known kind.
core::Value describe_file(const std::filesystem::path& file);

/// The same for a person: one line per value, warnings last.
std::string info_text(const core::Value& told);

}  // namespace swath::io
