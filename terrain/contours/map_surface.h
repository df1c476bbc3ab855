// SPDX-License-Identifier: GPL-3.0-or-later
// The terrain between the contours, spot heights and breaklines of a map.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "core/grid.h"
#include "terrain/contours/least_bending.h"

namespace swath::terrain {

/// A line of the map. Metres, or units of a file whose heights have the unit of its map.
struct MapLine {
  std::vector<Eigen::Vector3d> vertices;  ///< a ring repeats its first vertex
  bool contour = false;                   ///< of one height; a breakline otherwise
  std::string place;                      ///< for messages
};

struct MapContent {
  std::vector<MapLine> lines;
  std::vector<Eigen::Vector3d> spots;
};

/// Heights that contours have, ascending, each once.
std::vector<double> levels_in(const MapContent& content);

struct MapSurfaceOptions {
  double interval = 1.0;        ///< height between contours
  double max_edge = 1000.0;     ///< longest triangle bridged, as DtmOptions::max_edge
  double tolerance = 0.01;      ///< by which the heights of contours that meet may differ
  bool keep_flats = false;      ///< flat triangles stay flat
  size_t most_cells = 250'000;  ///< of one flat part; larger ones stay flat
};

/// How a cell got its height.
enum class MapPart : std::uint8_t {
  none,     ///< it has none
  between,  ///< the plane of a triangle between two heights
  flat,     ///< in a part whose triangles join one contour with itself (valley, ridge, top, pit): by least bending
  kept,     ///< in such a part, left flat
};
constexpr std::array<std::string_view, 4> map_part_names{"void", "between contours", "flat, filled", "flat, kept"};

struct MapSurface {
  core::Grid grid;             ///< heights and reasons
  std::vector<MapPart> part;   ///< of each cell
  std::vector<float> between;  ///< 1 midway between two heights, 0 at one of them, a parabola; 1 in flat parts
  FilledParts flats;
};

/// The constrained Delaunay triangulation of lines and spots, read at the cell centres. Triangles of three vertices on contours of one
/// height are flat where the ground is not: in valleys, on ridges, tops and in pits. They and the triangles next to them across no line are
/// filled by least bending from the slopes around (terrain/contours/least_bending.h); no cell gets nearer to the next level than a tenth of
/// the interval. Breaklines give way to contours where they cross. Throws core::Error where contours cross at different heights.
MapSurface map_surface(const MapContent& content, const core::Lattice& lattice, const MapSurfaceOptions& options);

}  // namespace swath::terrain
