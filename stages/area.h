// SPDX-License-Identifier: GPL-3.0-or-later
// The one box that all coordinates of a run are held against.
#pragma once

#include <functional>
#include <string>

#include "stages/stage.h"

namespace swath::stages {

/// What features of the map and the points of a run may lie beyond its own places, m.
constexpr double around_clouds = 30e3, around_trajectory = 40e3;

/// Sets context.area: `places` (map metres) grown by `margin`, each side replaced by what the survey states.
void set_area(Context& context, const Box& places, double margin);

/// Leaves out the points of a block (origin and coordinates in metres) that lie outside the area or beyond its heights, counted with
/// examples. `name`: of their source.
void keep_in_area(const Context& context, core::Block& block, const std::string& name, core::Tally& tally);

/// Leaves out the rows of which `is_out`, counted as `what` with their place.
void leave_out(core::Block& block, const std::function<bool(size_t)>& is_out, const std::string& what, const std::string& name,
               core::Tally& tally);

}  // namespace swath::stages
