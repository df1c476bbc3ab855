// SPDX-License-Identifier: GPL-3.0-or-later
// Does the geometry of a flight hold together, before products are made of it? And if it does not: which usual mistake explains it?
#pragma once

#include "calib/geometry/geometry_figures.h"

namespace swath::calib {

GeometryFigures judge_geometry(const GeometryInput& input, const GeometryOptions& options);

}  // namespace swath::calib
