// SPDX-License-Identifier: GPL-3.0-or-later
// A Python function as a stage on tiles.
#pragma once

#include <nanobind/nanobind.h>

#include <string>

#include "core/block.h"
#include "core/config/units.h"
#include "stages/entry.h"

namespace swath::python {

struct OnTile {
  nanobind::object function;  ///< called with (columns, own, box, origin): see OnTileStage::run_tile
  core::Metres halo{0.0};
  core::ColumnSet columns{};  ///< that the function gets, beside x, y, z and classification, where they are there
  std::string code;           ///< distinguishes functions, for fingerprints
};

/// "python.on_tile": gives classes. `on_tile` outlives the run.
stages::Entry on_tile_stage(const OnTile& on_tile);

}  // namespace swath::python
