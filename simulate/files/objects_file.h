// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>

#include "simulate/world/map_patch.h"
#include "simulate/world/world.h"

namespace swath::simulate {

/// What stands on the ground, in map coordinates, m: truth/wires.csv (ends, parameters of the catenary z = z0 + a cosh((s - s0) / a) - a
/// with s from the first end, sag), truth/pylons.csv (place, top) and truth/trees.csv (place, ground, height, radius of the crown). A file
/// without rows is left out.
void write_objects(const std::filesystem::path& truth, const World& world, const MapPatch& map);

}  // namespace swath::simulate
