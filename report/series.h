// SPDX-License-Identifier: GPL-3.0-or-later
// One row of numbers in a chart.
#pragma once

#include <string>
#include <vector>

namespace swath::report {

enum class Mark {
  line,   ///< points joined
  dots,   ///< points alone
  stems,  ///< a stroke from zero to each point
  band,   ///< the area between -y and +y (or y and y2 where that is given), pale
};

/// A NaN breaks the line.
struct Series {
  std::string name;  ///< in the legend; empty: not listed
  std::vector<double> x, y;
  std::vector<double> y2;  ///< bands: the other edge; empty: -y
  Mark mark = Mark::line;
  int colour = -1;  ///< index into the palette; -1: the next one
};

}  // namespace swath::report
