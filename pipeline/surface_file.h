// SPDX-License-Identifier: GPL-3.0-or-later
// A terrain model's raster with the sigmas that lie beside it.
#pragma once

#include <filesystem>
#include <optional>

#include "core/geo/crs.h"
#include "core/grid.h"
#include "io/raster/impossible_heights.h"

namespace swath::pipeline {

struct SurfaceFile {
  core::Grid grid;             ///< units of the file
  core::Crs crs;               ///< empty where the file states none
  double vertical_unit = 1.0;  ///< metres per unit of height: the band's own unit, else the CRS's, else 1
};

/// Reads the first band (or the band `height`) of a raster, and sigma from its own band or from the file that a run writes beside it:
/// dtm.vrt has dtm_quality.vrt. `window`: on the raster's lattice. Heights that cannot be are void (`on_impossible`). Throws core::Error.
SurfaceFile read_surface(const std::filesystem::path& file, const std::optional<core::Lattice>& window = std::nullopt,
                         const io::OnImpossible& on_impossible = {});

}  // namespace swath::pipeline
