// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <vector>

namespace swath::core {

/// One contour: a line of equal height on a surface.
struct ContourLine {
  std::vector<double> x, y;  ///< map frame, CRS units, one entry per vertex
  double height = 0.0;       ///< CRS vertical units
  bool index = false;        ///< an index contour (drawn thick, labelled)
  bool closed = false;       ///< a ring; the first vertex is then repeated as the last
  bool depression = false;   ///< a ring round lower ground
};

/// The height of a contour as text along it.
struct ContourLabel {
  double x = 0.0, y = 0.0;  ///< middle of the text, map frame, CRS units
  std::string text;
  double rotation = 0.0;     ///< of the text's direction, rad, counter-clockwise from east
  double text_height = 0.0;  ///< of its letters, CRS units
  double height = 0.0;       ///< of the contour, CRS vertical units
};

/// The height of a top or of a pit.
struct SpotHeight {
  double x = 0.0, y = 0.0;   ///< map frame, CRS units
  double height = 0.0;       ///< CRS vertical units
  std::string text;          ///< the height as it is written beside the point
  bool top = true;           ///< a pit otherwise
  double text_height = 0.0;  ///< of its letters, CRS units
};

}  // namespace swath::core
