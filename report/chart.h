// SPDX-License-Identifier: GPL-3.0-or-later
// Charts of numbers over time or over one another, as a picture, SVG or PDF (report/canvas.h) from one description.
#pragma once

#include <string>
#include <vector>

#include "report/canvas.h"
#include "report/series.h"

namespace swath::report {

/// One diagram with its own axes.
struct Panel {
  std::string title;
  std::string x_label, y_label;  ///< with units: "time (s)", "height (m)"
  std::vector<Series> series;
  bool equal_scale = false;  ///< maps: one metre is as long across as up
  bool log_y = false;
  /// Kinds in place of numbers: x = k is the middle of the k-th kind (from 0), whose name is below it. Not with equal_scale. Panels
  /// that share x have the same names.
  std::vector<std::string> x_names{};
  /// Below 1: the range of y follows this share of the values, half as much again on both sides, so that a few far ones do not flatten the
  /// rest. Dots beyond it are drawn at the frame, lines leave it, and the title gives their number.
  double y_share = 1.0;
};

/// Panels one below the other; those with the same x_label share the range of x.
struct Chart {
  std::string title;
  std::vector<Panel> panels;
  int width = 1200, panel_height = 260;
};

/// Long series are thinned to what the width can show (minimum and maximum per pixel column), never by leaving out peaks. The chart must
/// live until it is drawn. Throws core::Error where columns of a series differ in length.
Drawing drawing(const Chart& chart);

}  // namespace swath::report
