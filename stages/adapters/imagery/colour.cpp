// SPDX-License-Identifier: GPL-3.0-or-later
#include "calib/block/imagery/colour_points.h"

#include "stages/adapters/imagery/photos.h"
#include "stages/tile.h"

namespace swath::stages {
namespace {

constexpr const char *stage_name = "images.colour", *coloured_file = "seen";

struct ColourStageOptions : calib::ColourOptions {};

template <class V>
void describe(ColourStageOptions& o, V& v) {
  describe(static_cast<calib::ColourOptions&>(o), v);
}

calib::ColourCounts colour_tile(TileJob& job, const Context& context, const ColourStageOptions& o, RunCache& cache) {
  const calib::OrientedImages& images = cache.get([&] { return photos_of(context); });
  const calib::ColourCounts counts = calib::colour_points(job.block, job.own, images, o);
  write_rows(piece_file(job.folder, job.key, coloured_file), std::vector<std::uint64_t>{counts.coloured + counts.hidden});
  return counts;
}

PhotoFindings find_photos(const MergeJob& job, const Context& context, RunCache& cache) {
  const calib::OrientedImages& images = cache.get([&] { return photos_of(context); });
  std::uint64_t coloured = 0;
  for (const TileKey key : job.tiles) {
    std::vector<std::uint64_t> of_tile;
    read_rows(piece_file(job.folder, key, coloured_file), of_tile);
    for (const std::uint64_t n : of_tile) coloured += n;
  }
  expect_seen(images, context, job.tiles, coloured, stage_name);
  return findings_of(images);
}

/// Of points: places in the frame's coordinates, on a photograph, and colours; columns with their tops.
TileMemory colour_memory(const ColourStageOptions& o, const Context& c) {
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
                                         .check = [](const Context& c, const ColourStageOptions&) { expect_photos(c, stage_name); },
                                         .inputs = photo_inputs});
}

}  // namespace swath::stages
