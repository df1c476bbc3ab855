// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <vector>

#include "core/config/option.h"
#include "core/contour_line.h"
#include "core/grid.h"
#include "core/relief.h"
#include "report/canvas.h"

namespace swath::report {

struct PictureOptions {
  std::string title;              ///< UTF-8; empty: none
  std::string unit = "m";         ///< of the horizontal axes, as the scale bar names it
  std::string height_unit = "m";  ///< as labels and legend name it
  int max_side = 1600;            ///< of the map, pixels
  bool tint = true;               ///< colours by height; otherwise grey
  bool labels = true;             ///< heights along the index contours
  core::Light light = {.multidirectional = true};
};

template <class V>
void describe(PictureOptions& o, V& v) {
  v.option("title", o.title, "Title above the map.");
  v.option("max_side", o.max_side, core::within(100, 20000), "Longest side of the map, pixels.");
  v.option("tint", o.tint, "Colours by height, otherwise grey.");
  v.option("labels", o.labels, "Heights along the index contours.");
  v.table("light", o.light, "Shading.");
}

/// A map of a surface, north up: hillshade, tinted by height (2nd to 98th percentile), contours over it (index contours thicker and with
/// their heights), voids hatched (water blue), title, scale bar, north arrow and legend. A grid larger than max_side is averaged by
/// whole blocks (a block with fewer than half of its heights is void); a small one is enlarged. Where ordinary contours would cover more
/// than a third of the map only index contours are drawn, and the legend says so. Where the ground is so steep that lines come within 2
/// pixels of one another, index contours alone are drawn, or of these every 2nd, 4th, 10th or 20th.
/// `contours` in the coordinates of the grid. An empty grid gives an empty drawing.
Drawing relief_map(const core::Grid& grid, const std::vector<core::ContourLine>& contours = {}, const PictureOptions& options = {});

/// The grid averaged by blocks of `factor` cells from its south-west corner; a block's height and void reason as above.
/// The lattice's indices are no longer those of the survey: only its cell and size count.
core::Grid averaged(const core::Grid& grid, int factor);

}  // namespace swath::report
