// SPDX-License-Identifier: GPL-3.0-or-later
// A grid as an intermediate file of a run.
#pragma once

#include <filesystem>

#include "core/grid.h"

namespace swath::io {

/// Writes the grid whole or not at all, in the machine's byte order.
void write_grid_file(const std::filesystem::path& file, const core::Grid& grid);

/// Reads it back; throws core::Error where it is damaged.
core::Grid read_grid_file(const std::filesystem::path& file);

/// An intermediate file is not as long as it must be: throws core::SystemError.
[[noreturn]] void cut_short(const std::filesystem::path& file);

}  // namespace swath::io
