// SPDX-License-Identifier: GPL-3.0-or-later
// The unit of heights that a vector file states, which the CRS of flat lines cannot.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>

class GDALDataset;

namespace swath::io {

struct CrsFacts;

/// What this program adds to the description of a layer with heights: "; heights in m, DHHN2016 height".
std::string heights_statement(const CrsFacts& crs);
/// What heights count from by a description that holds such a statement; empty where it does not.
std::string_view stated_heights(std::string_view description);

/// Metres of one unit of the heights of a file, open under that name, by the first that states it: the vertical part of a layer's CRS; as
/// this program writes them, a layer's description in a GeoPackage, the comments at the start of a DXF, the member `swath` of a GeoJSON.
/// Nothing where none does.
std::optional<double> height_unit_in(GDALDataset& set, const std::filesystem::path& file);

}  // namespace swath::io
