// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>

#include "core/config/value.h"

namespace swath::io {

/// True where the file can be an SBET: whole records of 136 bytes, whose first and last times rise and whose positions are on Earth
/// (in radians or, wrongly, in degrees).
bool looks_like_sbet(const std::filesystem::path& file);
/// True where the file can be a smrmsg: whole records of 80 bytes, times rising, standard deviations plausible.
bool looks_like_smrmsg(const std::filesystem::path& file);

/// What an SBET holds: records, times, rate, extents, speed, attitude, gaps, and `warnings` (angles in degrees, heading against track,
/// time going back ...). Throws core::Error where it cannot be read.
core::Value describe_sbet(const std::filesystem::path& file);
core::Value describe_smrmsg(const std::filesystem::path& file);

}  // namespace swath::io
