// SPDX-License-Identifier: GPL-3.0-or-later
// The parts of maps (report/picture.h, report/difference_map.h): colours, labels, scale bar, legend. Inside of the room only.
#pragma once

#include <array>
#include <functional>
#include <string>
#include <vector>

#include "core/grid.h"
#include "core/picture.h"
#include "report/canvas.h"

namespace swath::report {

inline constexpr core::Rgb ink_colour{40, 40, 40}, contour_colour{112, 66, 24}, index_colour{78, 40, 8};
inline constexpr int map_margin = 14, map_text = 17, map_title = 24;  // pixels
inline constexpr int largest_cell = 16;                               // pixels: small grids are enlarged

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

/// One item of a legend: a sample between two texts.
struct MapItem {
  std::string before, after;  ///< either may be empty
  int width = 36;             ///< of the sample, pixels; 0: none
  std::function<void(Canvas&, const Box&)> sample{};
};

/// A map and what is around it: title above, scale bar, north arrow and legend below.
struct MapLayout {
  int width = 0, height = 0;
  View view;
  /// Places a map of that many pixels, `pixel` map units each.
  MapLayout(int map_width, int map_height, double pixel, std::string title, std::string unit, std::vector<MapItem> legend);
  /// Everything but the map.
  void draw(Canvas& canvas) const;

 private:
  struct Place {
    size_t item;
    int x, y;
  };
  void draw_scale_bar(Canvas& canvas, int top) const;
  void draw_north_arrow(Canvas& canvas, int top) const;
  std::string title_, unit_;
  std::vector<MapItem> legend_;
  std::vector<Place> places_;
  int arrow_ = 0;  ///< column of the north arrow
};

/// Low ground to high ground, t from 0 to 1: green, straw, ochre, brown, stone.
core::Rgb tint_of(double t);
/// The colour of a void at a pixel: hatched, water plain.
core::Rgb void_colour(core::Void reason, int x, int y);
/// A legend's sample of a void, framed.
MapItem void_item(core::Void reason, const std::string& name);
/// A bar of colours, t from 0 to 1, between two texts.
MapItem bar_item(const std::string& low, const std::string& high, int width, const std::function<core::Rgb(double)>& colour);
MapItem line_item(const std::string& name, double width, core::Rgb colour);

/// Length on the picture, pixels.
double length_of(const PixelLine& line);
/// Heights along the index lines, where a line is straight enough and nothing is yet; long lines choose first.
void draw_height_labels(Canvas& canvas, const std::vector<PixelLine>& lines, const Box& map);

/// At most two decimals, without trailing zeros.
std::string short_number(double v);

}  // namespace swath::report
