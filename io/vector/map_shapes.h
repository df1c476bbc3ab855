// SPDX-License-Identifier: GPL-3.0-or-later
// Areas and axes that a user has drawn, from any vector file that GDAL reads.
#pragma once

#include <Eigen/Core>
#include <filesystem>
#include <string>
#include <vector>

#include "core/geo/crs.h"

namespace swath::io {

enum class MapShapeKind { area, axis };

struct MapShape {
  std::string place;                                  ///< file, layer and feature, for messages
  std::vector<std::vector<Eigen::Vector2d>> parts{};  ///< of an area its rings (even-odd), not closed; of an axis its one line. CRS units
};

/// All areas or axes of a layer (empty: of all layers; DXF: the attribute Layer), in the horizontal part of `crs`. A closed line is an
/// area, too. Files in another CRS are transformed, their sides divided so that none bends by more than 1 mm; files that state none are in
/// `crs`. Throws core::Error with file and feature: not readable, no such layer, nothing of that kind in it, areas with fewer than three
/// vertices, without an area or with sides that cross, places not finite or without a place in `crs`.
std::vector<MapShape> read_map_shapes(const std::filesystem::path& file, const std::string& layer, const core::Crs& crs, MapShapeKind kind);

}  // namespace swath::io
