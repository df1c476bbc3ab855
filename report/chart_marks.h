// SPDX-License-Identifier: GPL-3.0-or-later
// Rows of numbers as marks in the plot of a chart.
#pragma once

#include <vector>

#include "core/picture.h"
#include "report/axis.h"
#include "report/canvas.h"
#include "report/series.h"

namespace swath::report {

/// Colour-blind safe, without yellow (Okabe and Ito 2008): seven colours, the same darker, the same paler; any index.
core::Rgb palette(int index);

/// The middle part of a panel's values that holds its y_share, half as long again on both sides, no longer than all of them; on a
/// logarithmic axis by their logarithms.
Reach middle_reach(std::vector<double> values, double share, bool log);

/// A panel's plot: its box and its axes.
struct Plot {
  Box box;
  Axis x, y;
  double column(double v) const { return box.x + x.share(v) * box.width; }
  double row(double v) const { return box.y + (1.0 - y.share(v)) * box.height; }
};

/// A stretch of points without a break, in pixels. Of points that follow one another within one pixel column at most four remain: the
/// first, the lowest, the highest and the last.
struct Stretch {
  std::vector<double> x, y;
  std::vector<double> lower;  ///< bands: the other edge, the lowest of its column as y is the highest
};
std::vector<Stretch> stretches(const Series& series, const Plot& plot);

void draw_series(const Series& series, core::Rgb colour, const Plot& plot, Canvas& canvas);
/// A sample for the legend, `width` long, around the row y.
void draw_sample(Mark mark, core::Rgb colour, double x, double y, double width, Canvas& canvas);

}  // namespace swath::report
