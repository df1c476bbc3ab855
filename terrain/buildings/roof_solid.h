// SPDX-License-Identifier: GPL-3.0-or-later
// A simple building as a solid with its roof.
#pragma once

#include "terrain/buildings/block_solid.h"
#include "terrain/buildings/building.h"

namespace swath::terrain {

/// More planes are not made into a solid.
constexpr size_t most_solid_planes = 12;

/// The solid from `bottom` to the lowest of the building's planes, over its outline: flat, pent, gable and hip roofs of convex outlines.
/// Empty where it would not be the building: courtyards, a side that runs inwards, no plane or more than 12, less than 90 % of its returns
/// on the lowest plane (on_lowest), a place of the roof within 0.5 m of the bottom; and where it is not closed. Vertices are whole
/// multiples of 0.1 mm.
Solid roof_solid(const Building& b, double bottom);

}  // namespace swath::terrain
