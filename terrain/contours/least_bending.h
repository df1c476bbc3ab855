// SPDX-License-Identifier: GPL-3.0-or-later
// Cells of a grid filled by the surface that bends least (a thin plate) through what is known around and within them.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "core/grid.h"

namespace swath::terrain {

struct FilledParts {
  size_t parts = 0, cells = 0;            ///< filled
  size_t parts_left = 0, cells_left = 0;  ///< parts of more than `most` cells: as they were
};

/// Sets the heights of the cells where `open` is 1, part by part. The other cells with a height hold theirs, so that slope goes on from
/// them; `known` are heights at places (map coordinates, m), which the surface passes within about a hundredth of its bends. Cells without
/// a height stay out. An open cell must have a height before: it decides where nothing else does. `filled` (as `open`) receives which cells
/// were set.
FilledParts fill_by_least_bending(core::Grid& grid, const std::vector<std::uint8_t>& open, const std::vector<Eigen::Vector3d>& known,
                                  size_t most, std::vector<std::uint8_t>& filled);

}  // namespace swath::terrain
