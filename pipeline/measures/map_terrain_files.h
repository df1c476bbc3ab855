// SPDX-License-Identifier: GPL-3.0-or-later
// `swath map-dtm`: a terrain model of a map's contours, spot heights and breaklines, without any laser point.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "core/config/result.h"
#include "terrain/contours/map_terrain.h"

namespace swath::pipeline {

struct MapTerrainRequest {
  std::vector<std::filesystem::path> files;  ///< contours, spot heights, breaklines, in any of them
  std::string field;                         ///< with the height of a line or point that has no z; empty: the usual names
  std::string crs;                           ///< of the model, and of files that state none; empty: that of the first file that states one
  double cell = 5.0;                         ///< m
  std::optional<double> interval, sigma;     ///< m: height between contours; standard deviation of their heights
  double max_edge = 1000.0;                  ///< m
  double tolerance = 0.01;                   ///< m, by which contours that meet may differ
  bool keep_flats = false;
  std::optional<double> height_unit;  ///< metres of one unit of the heights of files that do not state it
  std::filesystem::path folder;
};

/// Lengths in m, without a CRS in units of the file.
struct MapTerrainFound {
  std::size_t contours = 0, levels = 0, spots = 0, breaklines = 0;
  std::uint64_t without_height = 0;  ///< lines and points left out
  double interval = 0.0, cell = 0.0;
  std::size_t cells = 0, voids = 0;
  std::size_t flat_parts = 0, flat_parts_left = 0;
  std::vector<terrain::MapError> errors;
  std::string height_unit;  ///< symbol of that of the model's heights; empty without a CRS
};
template <class V>
void describe(const MapTerrainFound& f, V& v) {
  v.result("contours", f.contours, "Lines of one height.");
  v.result("levels", f.levels, "Heights that contours have.");
  v.result("units", std::string_view(f.height_unit.empty() ? "those of the file, which states no CRS" : "m"),
           "Unit of interval, cell and errors.");
  v.result("interval", f.interval, "Height between contours, stated or usual.");
  v.result("spot_heights", f.spots, "Points with a height.");
  v.result("breaklines", f.breaklines, "Lines whose height changes.");
  v.result("without_height", f.without_height, "Lines and points without a height, left out.");
  v.result("dtm_height_unit", f.height_unit, core::Form{}.only_if(!f.height_unit.empty()), "Unit of the heights of dtm.tif.");
  v.result("cell", f.cell, "Side of the cells.");
  v.result("cells", f.cells, "Cells with a height.");
  v.result("voids", f.voids, "Cells without one, inside the map's frame.");
  v.result("flat_parts", f.flat_parts, "Valleys, ridges, tops and pits where triangles join one contour with itself, filled.");
  v.result("flat_parts_left", f.flat_parts_left, core::if_any(), "Those too large to fill, left flat.");
  v.tables("errors", f.errors, "What contours that are left out say of the surface between the others.");
}

/// FOLDER/dtm.tif, dtm_quality.tif (sigma, void reason), dtm_part.tif (1 between contours, 2 flat and filled, 3 flat and kept) and
/// map_terrain.json. A line whose height changes is a breakline, any other a contour. Throws core::Error: files that cannot be read, a map
/// in degrees, no height, a unit of heights that is not stated in a CRS in feet, contours that cross at different heights, a product that
/// would take the place of a file that is read.
MapTerrainFound write_map_terrain(const MapTerrainRequest& request);
std::string map_terrain_text(const MapTerrainFound& found);

}  // namespace swath::pipeline
