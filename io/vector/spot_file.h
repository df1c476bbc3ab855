// SPDX-License-Identifier: GPL-3.0-or-later
// Spot heights of a map from any vector file that GDAL reads.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

class GDALDataset;

namespace swath::io {

struct SpotFile {
  std::vector<double> x, y, z;       ///< easting before northing, CRS units; height
  std::uint64_t without_height = 0;  ///< points left out
  std::string crs_wkt;               ///< WKT2:2019 of the first layer; empty where it states none
};

/// All points (also those of multi-points) of all layers of an open file. The height is that of `field`, or without one of `height`,
/// `elev`, `elevation`, `contour` or `z`; else the point's own z. Texts of a DXF file and the points of a layer `labels` are no spot
/// heights. GDAL's messages are left to the caller.
SpotFile spots_in(GDALDataset& set, const std::string& field);

}  // namespace swath::io
