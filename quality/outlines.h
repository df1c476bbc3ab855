// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/Core>
#include <vector>

#include "quality/void_cells.h"

namespace swath::quality {

/// Outlines of a connected area of cells given by rows: the outer one first, counter-clockwise, then its holes, clockwise; corners where
/// they turn, in cells of the absolute lattice. Cells that touch at a corner alone are apart. `runs`: rising, none touching another of its
/// row.
std::vector<std::vector<Eigen::Vector2d>> outlines_of(const std::vector<VoidRun>& runs);

}  // namespace swath::quality
