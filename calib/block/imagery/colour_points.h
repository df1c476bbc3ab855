// SPDX-License-Identifier: GPL-3.0-or-later
// Colours of points from the photographs that see them.
#pragma once

#include "calib/block/imagery/image_choice.h"
#include "calib/block/imagery/oriented_images.h"
#include "core/block.h"
#include "core/config/result.h"
#include "core/tile_columns.h"

namespace swath::calib {

enum class HiddenColour { keep, nearest };

struct ColourOptions : SightOptions {
  core::Metres cell{0.5};
  HiddenColour hidden = HiddenColour::keep;
};

template <class V>
void describe(ColourOptions& o, V& v) {
  describe(static_cast<SightOptions&>(o), v);
  v.option("cell", o.cell, core::within(0.1, 10.0), "Side of the columns that hide what is behind them: about the spacing of the points.");
  v.option("hidden", o.hidden, "Points that no camera sees: keep their colour, or black; or nearest, as if nothing hid them.");
}

/// What is counted, as texts and reports name it.
inline constexpr const char *coloured_points = "coloured", *hidden_points = "hidden from all cameras";

struct ColourCounts {
  core::Changed coloured;
  core::Kept hidden, outside;
};

template <class V>
void describe(const ColourCounts& r, V& v) {
  v.result(coloured_points, r.coloured, "Points that have the colour of a photograph.");
  v.result(hidden_points, r.hidden, core::if_any(), "Points behind others on all photographs that would show them.");
  v.result("on no photograph", r.outside, core::if_any(), "Points outside all photographs, or seen too obliquely.");
}

/// The columns that it works with.
inline core::TileColumns columns(const ColourOptions&) {
  using core::Column;
  return {.needs = {Column::classification, Column::flags},
          .reads = {Column::red, Column::green, Column::blue},
          .gives = {Column::red, Column::green, Column::blue}};
}

/// Metres of points around a tile that its result depends on.
inline double halo(const ColourOptions& o) { return o.reach.value + o.cell.value; }

/// Sets red, green and blue of the first `own` points, which are in metres of the images' map; those after are the halo, which hides, too.
/// Each has the colour of the photograph that sees it at the least angle to the vertical. Throws core::Error as colours_of().
ColourCounts colour_points(core::Block& block, size_t own, const OrientedImages& images, const ColourOptions& o);

}  // namespace swath::calib

namespace swath::core {
template <>
struct Choices<calib::HiddenColour> {
  static constexpr std::array<std::string_view, 2> names{"keep", "nearest"};
};
}  // namespace swath::core
