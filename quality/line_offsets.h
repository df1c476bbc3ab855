// SPDX-License-Identifier: GPL-3.0-or-later
// One height offset per flight line from the places where lines overlap, and what that says of the points' errors.
#pragma once

#include <limits>
#include <string>
#include <vector>

#include "quality/line_cells.h"

namespace swath::quality {

/// A line's height over the mean of the lines that it is joined to by overlaps: 0 where it overlaps none.
struct LineOffset {
  int line = 0;
  int group = 0;                                            ///< lines joined by overlaps have the same number
  int pairs = 0;                                            ///< overlaps with other lines
  double offset = 0.0;                                      ///< m
  double sigma = std::numeric_limits<double>::quiet_NaN();  ///< m; NaN where it overlaps none
};

struct LinePair {
  int line_a = 0, line_b = 0;
  std::uint64_t blocks = 0, cells = 0;
  double difference = 0.0;  ///< m, height of a minus b, median of the blocks
  double sigma = 0.0;       ///< m, of the difference
  double rms = 0.0;         ///< m, of the blocks' differences
  double rms_after = 0.0;   ///< m, of what the offsets leave of them
};

/// NaN where the points do not show it.
struct LineComparison {
  double cell = 0.0;  ///< m, side of the cells that were compared
  std::vector<LineOffset> lines;
  std::vector<LinePair> pairs;
  double scatter = std::numeric_limits<double>::quiet_NaN();  ///< m, standard deviation of one return about a plane of its line
  double common = std::numeric_limits<double>::quiet_NaN();   ///< m, of the error of height that neighbouring returns of a line share
  /// m, of the error of place along each axis that they share; NaN where no steep ground is seen by two lines.
  double common_horizontal = std::numeric_limits<double>::quiet_NaN();
  double residual = std::numeric_limits<double>::quiet_NaN();  ///< m, the same behind the offsets
  /// Stretches of 256 m where overlaps are compared, which have independent errors: level, steep.
  int places = 0, steep_places = 0;
};

/// What a comparison cannot show, and what this one lacks, as sentences for the report.
std::vector<std::string> not_shown(const LineComparison& c);

/// The answer does not depend on the order, and what is there twice counts once.
LineComparison compare_lines(LineCells cells, const LineOptions& o);

}  // namespace swath::quality
