// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>

#include "core/config/value.h"

namespace swath::io {

/// What a LAS or LAZ file holds, all points read: version, counts, extents stated and true, times, CRS, returns, classes, lines, density,
/// and `warnings`. Throws core::Error where it cannot be read.
core::Value describe_las(const std::filesystem::path& file);

}  // namespace swath::io
