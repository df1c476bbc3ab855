// SPDX-License-Identifier: GPL-3.0-or-later
// What all rasters that are written have in common: a dataset in memory on a lattice, and its copy as cloud optimised GeoTIFF.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "core/grid.h"
#include "io/vector/gdal_door.h"

namespace swath::io {

/// Metadata of a raster whose heights are ellipsoidal above a projection: GeoTIFF keys do not say it.
inline constexpr const char* height_system_item = "HEIGHT_SYSTEM";

/// A dataset on the lattice, without bands. Throws core::Error where there are no cells. `file` stands in messages.
Dataset memory_raster(const core::Lattice& lattice, const CrsFacts& crs, const std::filesystem::path& file);

/// Adds a band of type T whose values, rows from the north, stay where they are.
template <class T>
void add_memory_band(GDALDataset& d, std::vector<T>& values, const std::string& name);

/// Overviews by averaging or of the nearest cell.
enum class Overviews { average, nearest };

/// Writes `memory` as COG (DEFLATE with a predictor, tiles of 512, overviews inside) under `file`, at once and whole. The same values give
/// the same bytes. Throws core::Error.
void write_cog(const std::filesystem::path& file, GDALDataset& memory, Overviews overviews, const GdalMessages& messages);

}  // namespace swath::io
