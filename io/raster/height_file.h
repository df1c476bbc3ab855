// SPDX-License-Identifier: GPL-3.0-or-later
// Terrain models of any source as the ground to plan or simulate a flight over.
#pragma once

#include <filesystem>
#include <optional>

#include "core/area.h"
#include "core/geo/crs.h"
#include "core/height_field.h"
#include "io/raster/impossible_heights.h"

namespace swath::io {

struct HeightFile {
  core::HeightField field;  ///< map metres, heights in metres
  core::Crs crs;            ///< empty where the file states none
};

/// Metres per unit of the heights of a raster: its first band's own unit, else the CRS's, else 1.
double height_unit_of(const std::filesystem::path& file);

/// The first band of a north-up raster, its pixels of any shape and place; `within`: only what of it lies in that box (map metres), two
/// pixels more on each side. Throws core::Error: not north up, in degrees, more than 400 million pixels, nothing of it in the box, no
/// height.
HeightFile read_heights(const std::filesystem::path& file, const std::optional<core::Box>& within = std::nullopt);

/// The same, and nothing where nothing of the raster lies in the box or none of its pixels there has a height. `on_impossible` learns of
/// each height that cannot be and is taken as none, its place in map metres.
std::optional<HeightFile> find_heights(const std::filesystem::path& file, const core::Box& within, const OnImpossible& on_impossible = {});

}  // namespace swath::io
