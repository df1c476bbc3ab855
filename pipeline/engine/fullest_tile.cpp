// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/engine/fullest_tile.h"

#include <algorithm>
#include <cmath>

#include "stages/adapters/cloud/clouds.h"

namespace swath::pipeline {
namespace {

constexpr double most_tiles = 1e4;  // of a file: more of them say nothing of one

/// Box of a file's points in map metres and the tiles that they lie in.
struct FileBox {
  double x0, y0, x1, y1;
  stages::TileKey low, high;
  double tiles() const { return (high.ix - low.ix + 1.0) * (high.iy - low.iy + 1.0); }
};

/// Of a file in the run's own coordinates all points of which are in the run's area.
std::optional<FileBox> box_of(const stages::Context& context, const io::LasSource& s) {
  const io::LasHeader& h = s.header;
  const double side = context.tile_side;
  FileBox b{h.min.x() * context.unit, h.min.y() * context.unit, h.max.x() * context.unit, h.max.y() * context.unit, {}, {}};
  const stages::Box& area = context.area.box;
  if (!s.same_places || h.point_count == 0 || !area.holds(b.x0, b.y0) || !area.holds(b.x1, b.y1)) return std::nullopt;
  const auto is_kept = [&](double z) { return context.area.has_height(z * context.vertical_unit); };
  if (!is_kept(h.min.z()) || !is_kept(h.max.z())) return std::nullopt;
  if (!(std::abs(b.x0) < 1e8 && std::abs(b.y0) < 1e8 && std::abs(b.x1) < 1e8 && std::abs(b.y1) < 1e8)) return std::nullopt;
  const auto first = [&](double v) { return static_cast<int>(std::floor(v / side)); };
  // Points on the outer rim belong to the tile within it.
  const auto last = [&](double v, int low) { return std::max(low, static_cast<int>(std::ceil(v / side)) - 1); };
  b.low = {first(b.x0), first(b.y0)};
  b.high = {last(b.x1, b.low.ix), last(b.y1, b.low.iy)};
  if (!(b.x0 <= b.x1 && b.y0 <= b.y1) || b.tiles() > most_tiles) return std::nullopt;
  return b;
}

/// Share of the stretch from a to b that lies in the tile number i.
double share(double a, double b, int i, double side) {
  return b > a ? std::max(0.0, std::min(b, (i + 1) * side) - std::max(a, i * side)) / (b - a) : 1.0;
}

}  // namespace

std::optional<FullTile> fullest_tile(const stages::Context& context) {
  std::optional<FullTile> out;
  for (const io::LasSource& s : io::cloud_sources(context.survey, stages::cloud_map(context))) {
    const std::optional<FileBox> box = box_of(context, s);
    if (!box) continue;
    const auto points = static_cast<std::uint64_t>(static_cast<double>(s.header.point_count) / box->tiles());
    if (!out || points > out->points) out = FullTile{box->low, points, s.file.string()};
  }
  return out;
}

std::map<stages::TileKey, std::uint64_t> even_tiles(const stages::Context& context) {
  std::map<stages::TileKey, std::uint64_t> out;
  for (const io::LasSource& s : io::cloud_sources(context.survey, stages::cloud_map(context))) {
    const std::optional<FileBox> b = box_of(context, s);
    if (!b) continue;
    for (int iy = b->low.iy; iy <= b->high.iy; ++iy)
      for (int ix = b->low.ix; ix <= b->high.ix; ++ix)
        out[{ix, iy}] += static_cast<std::uint64_t>(static_cast<double>(s.header.point_count) * share(b->x0, b->x1, ix, context.tile_side) *
                                                    share(b->y0, b->y1, iy, context.tile_side));
  }
  return out;
}

}  // namespace swath::pipeline
