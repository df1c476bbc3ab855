// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <vector>

namespace swath::io {

/// The files that are read with a raster or vector file: index, attributes and CRS of a Shapefile, georeference and statistics beside a
/// raster, the sources of a virtual raster and what lies beside these. Sorted, without `file` itself; empty for other formats, and where
/// the file cannot be opened.
std::vector<std::filesystem::path> side_files(const std::filesystem::path& file);

}  // namespace swath::io
