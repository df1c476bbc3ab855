// SPDX-License-Identifier: GPL-3.0-or-later
// The parts of a chart (report/chart.h): the sheet it is laid out on, and rows of numbers as marks in pixels. Inside of the room only.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/picture.h"
#include "report/axis.h"
#include "report/canvas.h"
#include "report/chart.h"

namespace swath::report {

/// Around every plot.
inline constexpr core::Rgb border_colour{120, 120, 120};

enum class Anchor { start, middle, end };

/// What a chart is drawn on. Coordinates are pixels as in report/canvas.h; a sheet has no opinion on where things lie.
class Sheet {
 public:
  virtual ~Sheet() = default;
  /// What follows is drawn inside the box alone; nothing: on the whole sheet.
  virtual void clip(const std::optional<Box>& box) = 0;
  virtual void fill(const Box& box, core::Rgb colour, double opacity) = 0;
  virtual void line(const std::vector<double>& x, const std::vector<double>& y, double width, core::Rgb colour) = 0;
  /// Discs.
  virtual void dots(const std::vector<double>& x, const std::vector<double>& y, double radius, core::Rgb colour) = 0;
  /// Between two edges over rising x.
  virtual void area(const std::vector<double>& x, const std::vector<double>& upper, const std::vector<double>& lower, core::Rgb colour,
                    double opacity) = 0;
  /// Capitals' middle at y; `scale`: pixels per dot of report/font.h, whose widths hold on every sheet; `upward`: read from below.
  virtual void text(double x, double y, std::string_view text, double scale, Anchor anchor, bool upward, core::Rgb colour) = 0;
};

/// What is drawn on a sheet of that size, white below, as a picture and as an SVG file.
core::Picture paint(int width, int height, const std::function<void(Sheet&)>& drawing);
std::string paint_svg(int width, int height, const std::function<void(Sheet&)>& drawing);

/// Places everything and draws it; returns the height in pixels. Without a sheet it only measures.
/// Throws core::Error where columns of a series differ in length.
int lay_out(const Chart& chart, Sheet* sheet);

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

void draw_series(const Series& series, core::Rgb colour, const Plot& plot, Sheet& sheet);
/// A sample for the legend, `width` long, around the row y.
void draw_sample(Mark mark, core::Rgb colour, double x, double y, double width, Sheet& sheet);

}  // namespace swath::report
