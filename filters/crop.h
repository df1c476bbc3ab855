// SPDX-License-Identifier: GPL-3.0-or-later
// A part of a cloud: what lies within areas, or near an axis.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "core/block.h"
#include "core/config/result.h"

namespace swath::filters {

using CropLine = std::vector<Eigen::Vector2d>;  ///< m, map minus the blocks' origin

/// Where a point is inside: in one of the areas (even-odd over its rings; a side holds its lower end, so that areas which share a side
/// share no point), or at most `buffer` in plan from one of the axes.
struct CropShapes {
  std::vector<std::vector<CropLine>> areas;
  std::vector<CropLine> axes;
  double buffer = 0.0;  ///< m
};

struct CropCounts {
  core::Kept inside;
  core::Flagged outside;
  core::Kept untouched;
};

template <class V>
void describe(const CropCounts& r, V& v) {
  v.result("points kept", r.inside, "Points of the part that was asked for.");
  v.result("points withheld", r.outside, "Points outside it: flagged as withheld, still in the cloud.");
  v.result("withheld before", r.untouched, core::if_any(), "Points that were withheld already.");
}

/// Flags those of the first `own` points as withheld that are not inside; with `outside`, those that are.
CropCounts crop(core::Block& block, size_t own, const CropShapes& shapes, bool outside);

}  // namespace swath::filters
