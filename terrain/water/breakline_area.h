// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "core/area.h"
#include "core/breakline.h"
#include "core/report.h"

namespace swath::terrain {

/// Keeps features within `area` (metres, relative to the same origin as their vertices; the heights are absolute, `height`: of the origin).
/// Vertices that are not finite, of a height that nothing has, or outside are left out of lines, which are divided there. Of areas
/// (boundaries, water) a single vertex outside between two inside is left out; others are cut at the border. What is left out is counted
/// with the feature and the vertex. Throws core::Error for an area that loses more than a few vertices, and where nothing is left.
void keep_in_area(std::vector<core::Breakline>& features, const core::Area& area, const Eigen::Vector3d& origin, core::Tally& tally);

}  // namespace swath::terrain
