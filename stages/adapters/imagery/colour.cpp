// SPDX-License-Identifier: GPL-3.0-or-later
#include "calib/block/imagery/colour_points.h"

#include "stages/adapters/imagery/photos.h"
#include "stages/tile.h"

namespace swath::stages {
namespace {

constexpr const char* stage_name = "images.colour";

calib::ColourCounts colour_tile(TileJob& job, const Context& context, const calib::ColourOptions& o, RunCache& cache) {
  return calib::colour_points(job.block, job.own, cache.get([&] { return photos_of(context); }), o);
}

PhotoFindings find_photos(const MergeJob& job, const Context& context, RunCache& cache) {
  const calib::OrientedImages& images = cache.get([&] { return photos_of(context); });
  expect_seen(images, context, job.tiles, job.of_tiles.of(calib::coloured_points) + job.of_tiles.of(calib::hidden_points), stage_name);
  return findings_of(images);
}

/// Of points: places in the frame's coordinates, on a photograph, and colours; columns with their tops.
TileMemory colour_memory(const calib::ColourOptions& o, const Context& c) {
  constexpr double bytes_per_point = 64.0, bytes_per_column = 6.0;
  const double around = c.tile_side + 2.0 * halo(o);
  return {bytes_per_point, {{"cell", o.cell.value, around, bytes_per_column}, {"", 1.0, 1.0, photo_memory(c)}}};
}

}  // namespace

Entry colour_stage() {
  return tile<colour_tile, find_photos>(stage_name,
                                        "Colours of points from the photographs that see them; points that no camera sees keep theirs.",
                                        {.columns = columns(calib::ColourOptions{}),
                                         .memory = colour_memory,
                                         .check = [](const Context& c, const calib::ColourOptions&) { expect_photos(c, stage_name); },
                                         .inputs = photo_inputs});
}

}  // namespace swath::stages
