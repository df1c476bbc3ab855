// SPDX-License-Identifier: GPL-3.0-or-later
// One height offset per flight line from the places where lines overlap, and what that says of the points' errors.
#pragma once

#include <limits>
#include <string>
#include <vector>

#include "core/config/result.h"
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

template <class V>
void describe(const LineOffset& r, V& v) {
  v.result("line", r.line, "Number of the flight line.");
  v.result("group", r.group, "Lines joined by overlaps have the same number.");
  v.result("overlaps", r.pairs, "Overlaps with other lines.");
  v.result("offset_m", r.offset, core::metres(4), "Height above the mean of the lines that it is joined to.");
  v.result("sigma_m", r.sigma, core::metres(4).always(), "Standard deviation of the offset; null where it overlaps no line.");
}

struct LinePair {
  int line_a = 0, line_b = 0;
  std::uint64_t blocks = 0, cells = 0;
  double difference = 0.0;  ///< m, height of a minus b, median of the blocks
  double sigma = 0.0;       ///< m, of the difference
  double rms = 0.0;         ///< m, of the blocks' differences
  double rms_after = 0.0;   ///< m, of what the offsets leave of them
};

template <class V>
void describe(const LinePair& r, V& v) {
  v.result("line_a", r.line_a, "Number of one flight line.");
  v.result("line_b", r.line_b, "Number of the other.");
  v.result("cells", r.cells, "Cells that were compared.");
  v.result("difference_m", r.difference, core::metres(4), "Height of a minus height of b, median of the blocks.");
  v.result("sigma_m", r.sigma, core::metres(4), "Standard deviation of the difference.");
  v.result("rms_m", r.rms, core::metres(4), "RMS of the blocks' differences.");
  v.result("rms_after_m", r.rms_after, core::metres(4), "The same after the offsets are applied.");
}

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

template <class V>
void describe(const LineComparison& r, V& v) {
  using core::metres;
  v.result("cell_m", r.cell, metres(2), "Side of the cells that were compared.");
  v.result("scatter_m", r.scatter, metres(4).in_summary().always(), "Standard deviation of one return about a plane of its line.");
  v.result("common_m", r.common, metres(4).in_summary().always(), "Height error that neighbouring returns of a line share.");
  v.result("common_horizontal_m", r.common_horizontal, metres(4).always(),
           "Error of position along each axis that they share; null where no two lines see steep ground.");
  v.result("residual_m", r.residual, metres(4).always(), "The shared height error after the offsets are applied.");
  v.result("places", r.places, "Stretches of 256 m of level ground that were compared.");
  v.result("steep_places", r.steep_places, "Stretches of 256 m of steep ground that were compared.");
  v.tables("lines", r.lines, "Flight lines.");
  v.tables("pairs", r.pairs, "Pairs of overlapping flight lines.");
  v.result("not_shown", not_shown(r), "What the comparison cannot show, as sentences.");
}

/// The answer does not depend on the order, and what is there twice counts once.
LineComparison compare_lines(LineCells cells, const LineOptions& o);

}  // namespace swath::quality
