// SPDX-License-Identifier: GPL-3.0-or-later
// Contours of a height grid, traced tile by tile on a smoothed surface (terrain/contours/contour_surface.h);
// terrain/contours/contour_lines.h joins the segments, terrain/contours/contour_shape.h thins the lines.
#pragma once

#include <compare>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "core/config/option.h"
#include "core/grid.h"

namespace swath::terrain {

struct ContourOptions {
  std::optional<core::Metres> interval;
  core::Metres base{0.0};
  int index = 5;
  std::optional<core::Metres> tolerance;
  core::Metres min_length{0.0};
  std::string min_area = "0 m2";
};

/// "20 m2", "200 ft2" or "0.1 ha" in m2; nothing where the text is none of them.
std::optional<double> square_metres(const std::string& text);

/// Height between contours, m: the option, or 1 m.
inline double interval_of(const ContourOptions& o) { return o.interval ? o.interval->value : 1.0; }

/// The interval where none is stated: the largest of 1, 2 and 5 height units (of `unit` metres) that is at most 1 m; 1 m, 2 ft.
inline double usual_interval_of(double unit) { return unit * (5.0 * unit <= 1.0 ? 5.0 : 2.0 * unit <= 1.0 ? 2.0 : 1.0); }

/// Height by which a line may leave the surface, m: the option, or a twentieth of the interval.
inline double vertical_tolerance(const ContourOptions& o) { return o.tolerance ? o.tolerance->value : 0.05 * interval_of(o); }

template <class V>
void describe(ContourOptions& o, V& v) {
  v.option("interval", o.interval, core::above(0.0), "Height between contours; left out: 1 m, or 2 ft where heights are in feet.");
  v.option("base", o.base, "Height from which levels are counted.");
  v.option("index", o.index, core::at_least(0), "Every so many levels is an index contour; 0 for none.");
  v.option("tolerance", o.tolerance, core::at_least(0.0),
           "Maximum height error of smoothing and thinning; 0: as traced; default 1/20 of the interval.");
  v.option("min_length", o.min_length, core::at_least(0.0), "Lines shorter than this are left out.");
  v.option("min_area", o.min_area, "Rings that enclose less than this are left out: m2, ft2 or ha.");
  v.check(square_metres(o.min_area).has_value(), "min_area must be an area of 0 or more with its unit, such as \"20 m2\"");
  v.check(vertical_tolerance(o) <= 0.25 * interval_of(o),
          "tolerance must be at most a quarter of the interval, so that lines of two levels stay apart");
}

/// Height of a level, m.
inline double level_height(const ContourOptions& o, std::int64_t level) {
  return o.base.value + static_cast<double>(level) * interval_of(o);
}
inline bool is_index(const ContourOptions& o, std::int64_t level) { return o.index > 0 && level % o.index == 0; }

/// The edge on which a contour vertex lies: from the centre of cell (i, j) of the survey's lattice to that of its eastern (axis 0) or
/// northern (axis 1) neighbour; or, in the square of four centres with (i, j) at its south-west, from the south-western, south-eastern,
/// north-eastern, north-western corner to its middle (axis 2 to 5). The name by which segments find each other across tiles.
struct EdgeKey {
  std::int64_t i = 0, j = 0, axis = 0;
  auto operator<=>(const EdgeKey&) const = default;
};

/// One piece of one contour inside one triangle of the surface, directed with the higher ground on its left. Plain data without
/// padding: may be written to a file as it is.
struct Segment {
  std::int64_t level = 0;
  EdgeKey from, to;
  double from_x = 0.0, from_y = 0.0, to_x = 0.0, to_y = 0.0;  ///< map coordinates
  auto operator<=>(const Segment&) const = default;
};

/// Segments of the squares whose south-west cell lies in `own`, in ascending order (level, then key). `grid` must hold own and, where
/// the survey goes on, one row of cells more to the north and one column more to the east; squares with a void corner give nothing.
/// The surface traced is that of terrain/contours/facets.h: every square cut into four triangles at its middle, whose height is the mean of
/// the four. A node at or above a level counts as above it. No two segments meet but at a shared edge.
std::vector<Segment> trace(const core::Grid& grid, const core::Lattice& own, const ContourOptions& options);

}  // namespace swath::terrain
