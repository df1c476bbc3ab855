// SPDX-License-Identifier: GPL-3.0-or-later
// The parts of a relief picture (report/picture.h): colours, labels, scale bar, legend. Inside of the room only.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "core/grid.h"
#include "core/picture.h"
#include "report/canvas.h"

namespace swath::report {

inline constexpr core::Rgb ink_colour{40, 40, 40}, contour_colour{112, 66, 24}, index_colour{78, 40, 8};

/// Where the map lies on the picture and how map coordinates become pixels.
struct View {
  Box map;
  double west = 0.0, north = 0.0;  ///< of the map's upper left corner
  double pixel = 1.0;              ///< map units per pixel
  double column(double x) const { return map.x + (x - west) / pixel; }
  double row(double y) const { return map.y + (north - y) / pixel; }
};

struct PixelLine {
  std::vector<double> x, y;
  double height = 0.0;
  bool index = false;
};

/// Heights that the tint runs over.
struct Span {
  double low = 0.0, high = 0.0;
  bool any = false;
};

constexpr size_t void_reasons = static_cast<size_t>(core::Void::never_seen) + 1;  ///< with `none`

/// What the map shows, for the legend.
struct Shown {
  bool tint = true;
  std::string height_unit = "m";
  Span span;
  bool ordinary = false, index = false, thinned = false;
  double interval = 0.0, index_interval = 0.0;
  std::array<bool, void_reasons> voids{};
};

/// Low ground to high ground, t from 0 to 1: green, straw, ochre, brown, stone.
core::Rgb tint_of(double t);
/// The colour of a void at a pixel: hatched, water plain.
core::Rgb void_colour(core::Void reason, int x, int y);
/// Length on the picture, pixels.
double length_of(const PixelLine& line);

/// Heights along the index lines, where a line is straight enough and nothing stands yet; long lines choose first.
void draw_height_labels(core::Picture& p, const std::vector<PixelLine>& lines, const Box& map, double scale);
void draw_scale_bar(core::Picture& p, const View& view, int left, int top, int scale, const std::string& unit);
void draw_north_arrow(core::Picture& p, int left, int top, int scale);
/// Tint bar, then samples of contours and voids, flowing from left to right and onto a new line where the picture ends.
/// Returns the row below the last line; on an empty picture it only measures.
int draw_legend(core::Picture& p, int left, int top, int right, int scale, const Shown& shown);

/// At most two decimals, without trailing zeros.
std::string short_number(double v);

}  // namespace swath::report
