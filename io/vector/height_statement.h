// SPDX-License-Identifier: GPL-3.0-or-later
// The unit of heights that a vector file states, which the CRS of flat lines cannot.
#pragma once

#include <filesystem>
#include <optional>

namespace swath::io {

/// Metres of one unit of the file's heights, by the first that states it: the vertical part of a layer's CRS; as this program writes them,
/// a layer's description in a GeoPackage, the comments at the start of a DXF, the member `swath` of a GeoJSON. Nothing where none does.
/// Throws core::Error where the file cannot be read.
std::optional<double> stated_height_unit(const std::filesystem::path& file);

}  // namespace swath::io
