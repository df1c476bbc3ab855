// SPDX-License-Identifier: GPL-3.0-or-later
// Drawings as files: PNG, SVG or PDF by the ending of the name.
#pragma once

#include <filesystem>
#include <string_view>

#include "report/canvas.h"

namespace swath::stages {

/// Whether a name ends in .png, .svg or .pdf, in small letters.
bool names_drawing(std::string_view file);

/// Throws core::Error for any other ending, and where the file cannot be written.
void write_drawing(const std::filesystem::path& file, const report::Drawing& drawing);

}  // namespace swath::stages
