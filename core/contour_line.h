// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

namespace swath::core {

/// One contour: a line of equal height on a surface.
struct ContourLine {
  std::vector<double> x, y;  ///< map frame, CRS units, one entry per vertex
  double height = 0.0;       ///< CRS vertical units
  bool index = false;        ///< an index contour (drawn thick, labelled)
  bool closed = false;       ///< a ring; the first vertex is then repeated as the last
};

}  // namespace swath::core
