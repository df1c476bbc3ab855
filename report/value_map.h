// SPDX-License-Identifier: GPL-3.0-or-later
// Maps of a quantity over an area, pale for little and dark for much, with lines over it.
#pragma once

#include <string>
#include <vector>

#include "core/grid.h"
#include "report/canvas.h"

namespace swath::report {

/// A line on a map, in map coordinates.
struct MapLine {
  std::vector<double> x, y;
  double width = 2.0;  ///< pixels
  std::string name{};  ///< set at its start; empty: none
};

struct ValueMapOptions {
  std::string title;       ///< UTF-8; empty: none
  std::string unit = "m";  ///< of the horizontal axes, as the scale bar names it
  std::string value_unit;  ///< as the legend names it
  double low = 0.0;        ///< pale up to here
  double high = 0.0;       ///< dark from here on; not above low: the 2nd and the 98th percentile are taken
  std::string void_name = "outside";
  int max_side = 1000;  ///< of the map, pixels
};

/// `values` on the lattice, row-major from the south-west; NaN is hatched. A lattice larger than max_side is averaged by whole blocks, a
/// small one enlarged, as in report/picture.h. An empty lattice gives an empty drawing.
Drawing value_map(const core::Lattice& lattice, const std::vector<float>& values, const std::vector<MapLine>& lines,
                  const ValueMapOptions& options);

}  // namespace swath::report
