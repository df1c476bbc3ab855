// SPDX-License-Identifier: GPL-3.0-or-later
// Photographs of the scene by the camera on the flight.
#pragma once

#include <cstdint>
#include <filesystem>

#include "simulate/flight.h"
#include "simulate/options.h"
#include "simulate/world/map_patch.h"
#include "simulate/world/world.h"

namespace swath::simulate {

/// Writes photos/<id>.tif of each event, and what they are to be compared with: truth/orthophoto.tif (the scene from straight above),
/// truth/orientation.csv (omega, phi, kappa on the map's grid) and truth/camera.toml. Each pixel is one ray. Returns the number of
/// photographs.
std::uint64_t write_photos(const std::filesystem::path& folder, const World& world, const MapPatch& map, const Flight& flight,
                           const Options& options);

}  // namespace swath::simulate
