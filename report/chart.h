// SPDX-License-Identifier: GPL-3.0-or-later
// Charts of numbers over time or over one another, as a picture and as SVG from one description.
#pragma once

#include <string>
#include <vector>

#include "core/picture.h"

namespace swath::report {

enum class Mark {
  line,   ///< points joined
  dots,   ///< points alone
  stems,  ///< a stroke from zero to each point
  band,   ///< the area between -y and +y (or y and y2 where that is given), pale
};

/// One row of numbers in a panel. A NaN breaks the line.
struct Series {
  std::string name;  ///< in the legend; empty: not listed
  std::vector<double> x, y;
  std::vector<double> y2;  ///< bands: the other edge; empty: -y
  Mark mark = Mark::line;
  int colour = -1;  ///< index into the palette; -1: the next one
};

/// One diagram with its own axes.
struct Panel {
  std::string title;
  std::string x_label, y_label;  ///< with units: "time (s)", "height (m)"
  std::vector<Series> series;
  bool equal_scale = false;  ///< maps: one metre is as long across as up
  bool log_y = false;
  /// Kinds in place of numbers: x = k is the middle of the k-th kind (from 0), whose name stands below it. Not with equal_scale. Panels
  /// that share x have the same names.
  std::vector<std::string> x_names{};
  /// Below 1: the range of y goes by this share of the values, half as much again on both sides, so that a few far ones do not flatten the
  /// rest. Dots beyond it stand at the frame, lines leave it, and the title shows how many there are.
  double y_share = 1.0;
};

/// Panels one below the other; those with the same x_label share the range of x.
struct Chart {
  std::string title;
  std::vector<Panel> panels;
  int width = 1200, panel_height = 260;
};

/// Long series are thinned to what the width can show (minimum and maximum per pixel column), never by leaving out peaks.
core::Picture draw(const Chart& chart);
std::string svg(const Chart& chart);

}  // namespace swath::report
