// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

namespace swath::core {

/// What a surveyed line says of the terrain.
enum class BreaklineKind {
  breakline,  ///< the terrain passes through it and may bend there
  boundary,   ///< edge of the terrain model (area)
  lake,       ///< still water (area)
  river,      ///< running water between two banks (area)
};

/// One feature of a file of breaklines.
struct Breakline {
  BreaklineKind kind = BreaklineKind::breakline;
  std::string place;  ///< "file: layer x, feature n", for messages
  /// Breakline: one line. Areas: outer ring, then the rings of islands; the first vertex is not repeated. Easting, northing, height.
  std::vector<std::vector<Eigen::Vector3d>> parts;
  bool has_height = true;  ///< false: heights are 0 and mean nothing
  double sigma = 0.0;      ///< m, of the heights

  bool is_area() const { return kind != BreaklineKind::breakline; }
  bool is_water() const { return kind == BreaklineKind::lake || kind == BreaklineKind::river; }
};

}  // namespace swath::core
