// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/fullest_tile.h"

#include <algorithm>
#include <cmath>

#include "stages/adapters/cloud/clouds.h"

namespace swath::pipeline {

std::optional<FullTile> fullest_tile(const stages::Context& context) {
  constexpr double most_tiles = 1e6;
  std::optional<FullTile> out;
  for (const io::LasSource& s : stages::cloud_sources(context)) {
    const io::LasHeader& h = s.header;
    const auto first = [&](int axis) { return std::floor(h.min[axis] * context.unit / context.tile_side); };
    // Points on the outer rim belong to the tile within it.
    const auto last = [&](int axis) { return std::max(first(axis), std::ceil(h.max[axis] * context.unit / context.tile_side) - 1.0); };
    const double tiles = (last(0) - first(0) + 1.0) * (last(1) - first(1) + 1.0);
    if (!s.same_places || h.point_count == 0 || !(tiles >= 1.0 && tiles <= most_tiles)) continue;
    if (!(std::abs(first(0)) < 1e9 && std::abs(first(1)) < 1e9)) continue;
    const stages::Box& area = context.area.box;
    if (!area.holds(h.min.x() * context.unit, h.min.y() * context.unit) || !area.holds(h.max.x() * context.unit, h.max.y() * context.unit))
      continue;
    const auto points = static_cast<std::uint64_t>(static_cast<double>(h.point_count) / tiles);
    if (!out || points > out->points) out = FullTile{{static_cast<int>(first(0)), static_cast<int>(first(1))}, points, s.file.string()};
  }
  return out;
}

}  // namespace swath::pipeline
