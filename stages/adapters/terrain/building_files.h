// SPDX-License-Identifier: GPL-3.0-or-later
// Buildings as files: layers of features, and objects of a city.
#pragma once

#include <array>
#include <string_view>
#include <vector>

#include "core/config/option.h"
#include "io/vector/city_json.h"
#include "io/vector/feature_file.h"
#include "stages/stage.h"
#include "terrain/buildings/building.h"

namespace swath::stages {

enum class GroundReference { lowest, mean };
enum class BlockTop { eaves, middle, ridge };

}  // namespace swath::stages

template <>
struct swath::core::Choices<swath::stages::GroundReference> {
  static constexpr std::array<std::string_view, 2> names{"lowest", "mean"};
};
template <>
struct swath::core::Choices<swath::stages::BlockTop> {
  static constexpr std::array<std::string_view, 3> names{"eaves", "middle", "ridge"};
};

namespace swath::stages {

/// What heights of buildings count from, and how high their blocks are.
struct HeightChoices {
  GroundReference ground = GroundReference::lowest;
  BlockTop block = BlockTop::middle;
};

/// Height of the ground that a building's heights count from, m, relative to the run's origin; not a number where it is not known.
double ground_of(const terrain::Building& b, GroundReference from);

/// Layers buildings (outlines with courtyards, flat) and roof_planes (in space); `buildings` is numbered from 1.
std::vector<io::SpatialLayer> building_layers(const std::vector<terrain::Building>& buildings, const Context& context,
                                              const HeightChoices& o);

/// LoD 0 (outline at the lowest ground and at the eaves), LoD 1 (block from the lowest ground to the height chosen) and, of simple
/// buildings, LoD 2 (terrain/buildings/roof_solid.h).
struct CityBuildings {
  std::vector<io::CityObject> objects;
  std::uint64_t without_block = 0;  ///< buildings whose ground or roof height is not known
  std::uint64_t with_roof = 0;      ///< buildings with LoD 2
};
CityBuildings city_buildings(const std::vector<terrain::Building>& buildings, const Context& context, const HeightChoices& o);

}  // namespace swath::stages
