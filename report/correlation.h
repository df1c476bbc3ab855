// SPDX-License-Identifier: GPL-3.0-or-later
// A correlation matrix as a drawing: every coefficient as a number on its colour.
#pragma once

#include <string>
#include <vector>

#include "report/canvas.h"

namespace swath::report {

struct CorrelationChart {
  std::string title;
  std::vector<std::string> names;
  std::vector<double> values;  ///< names.size() squared, row by row, -1 to 1; NaN is left empty
};

/// The lower triangle with its diagonal, colours as report::diverging_colour. Throws core::Error where the sizes do not fit.
/// The chart must live until it is drawn.
Drawing drawing(const CorrelationChart& chart);

}  // namespace swath::report
