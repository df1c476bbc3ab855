// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>

#include "core/config/value.h"

namespace swath::io {

/// What a vector file (GeoPackage, GeoJSON, DXF, Shapefile ...) holds: layers with their kind of geometry, number of features, extent,
/// range of heights, CRS and fields; a DXF file's comments. Null where GDAL sees no vector file.
core::Value describe_vector(const std::filesystem::path& file);

}  // namespace swath::io
