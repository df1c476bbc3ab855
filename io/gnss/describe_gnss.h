// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>

#include "core/config/value.h"

namespace swath::io {

/// What `describe_file` reports of a GNSS file: solutions of RTKLIB and NMEA logs with their fixes by quality, times, rate, gaps and
/// extent; time tags of RTKLIB with the start of the recording.
core::Value describe_pos(const std::filesystem::path& file);
core::Value describe_nmea(const std::filesystem::path& file);
core::Value describe_tag(const std::filesystem::path& file);
/// What a RINEX file holds: its kind; of observations the station, the antenna, the epochs and their gaps.
core::Value describe_rinex(const std::filesystem::path& file);

/// True where the file starts as a time tag file of RTKLIB.
bool looks_like_tag(const std::filesystem::path& file);

}  // namespace swath::io
