// SPDX-License-Identifier: GPL-3.0-or-later
// A terrain model of a map's contours, spot heights and breaklines alone, with a sigma that the map itself yields.
#pragma once

#include <cmath>
#include <optional>
#include <string>
#include <vector>

#include "core/config/result.h"
#include "terrain/contours/map_surface.h"

namespace swath::terrain {

struct MapTerrainOptions {
  double cell = 5.0;
  std::optional<double> interval;  ///< height between contours; without it the usual one between their levels
  std::optional<double> sigma;     ///< of the contours' own heights; without it they count as right
  double max_edge = 1000.0;
  double tolerance = 0.01;
  bool keep_flats = false;
};

/// What contours that were left out say of the surface between the others.
struct MapError {
  std::string part;
  std::size_t cells = 0;               ///< of the model
  std::size_t tested = 0;              ///< vertices of the contours left out
  double every_second = std::nan("");  ///< rms with every second contour left out
  double every_fourth = std::nan("");  ///< rms midway where one of four was kept
  std::optional<double> sigma{};       ///< of the model, midway between two contours
  bool assumed = false;                ///< too few vertices: a share of the interval
};

template <class V>
void describe(const MapError& r, V& v) {
  v.result("part", r.part, "between contours; flat, filled (valley, ridge, top, pit: by least bending); flat, kept.");
  v.result("cells", r.cells, "Cells of the terrain model.");
  v.result("tested", r.tested, "Vertices of contours that were left out once, as test.");
  v.result("every_second", r.every_second, core::plain().only_if(std::isfinite(r.every_second)),
           "Rms at the contours left out, every second one.");
  v.result("every_fourth", r.every_fourth, core::plain().only_if(std::isfinite(r.every_fourth)),
           "Rms midway between contours of four times the interval.");
  v.result("sigma", r.sigma, "Sigma of the model's cells, midway between two contours.");
  v.result("assumed", r.assumed, core::plain().only_if(r.assumed), "Sigma is a share of the interval: too few vertices to test.");
}

struct MapTerrain {
  MapSurface surface;  ///< grid with sigma, where there are contours of two levels
  double interval = 0.0;
  std::size_t levels = 0;
  std::vector<MapError> errors;
};

/// Sigma: the model is made again without every second contour, and without three of four; errors at the contours left out give its error
/// midway between two and how it grows with the interval (its power, held to 1 to 2); one step down is the error at the interval itself.
/// Between two heights it falls as a parabola to a quarter. Throws core::Error: no height at all, more than 400 million cells, contours
/// that cross at different heights.
MapTerrain map_terrain(const MapContent& content, const MapTerrainOptions& options);

}  // namespace swath::terrain
