// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/tile_work.h"

#include <cmath>
#include <string>
#include <utility>

#include "io/text/output_file.h"
#include "pipeline/stage_memory.h"

namespace swath::pipeline {

namespace fs = std::filesystem;

void TileWork::run(const TileGroup& group, stages::TileJob& job, bool has_water) const {
  if (group.parts > 1)
    work_on_parts(group, job, has_water);
  else
    work_on(group, job, has_water);
}

std::function<void(core::Block&)> TileWork::thinner(const stages::Box& box) const {
  if (!std::isfinite(stage_.left_per_area())) return {};
  return [box, this](core::Block& around) { stage_.thin(context_, box, around); };
}

void TileWork::work_on(const TileGroup& group, stages::TileJob& job, bool has_water) const {
  if (!reads_points(stage_)) return run_stage(job, has_water);
  if (stage_.is_streamed()) {
    job.own = group.own;
    job.stream = [&, this](const std::function<void(core::Block&)>& f) { store_.each_rows(job.key, columns_of_tiles(stage_), f); };
    return stage_.run_tile(context_, job);
  }
  job.block = store_.read_with_halo(group.tiles, stage_.halo(), columns_of_tiles(stage_), job.own, thinner(job.box), group.with_halo);
  core::add_columns(job.block, stage_.info().gives);
  run_stage(job, has_water);
}

void TileWork::run_stage(stages::TileJob& job, bool has_water) const {
  const size_t before = job.block.size();
  if (before > 0 || !has_surface(stage_.info().gives_products) || has_water) stage_.run_tile(context_, job);
  if (job.block.size() != before)
    throw core::Error("the stage changed the number of points of a tile", std::string(stage_.info().name),
                      "this is a fault of the program");
}

/// The parts one after the other: what they give is put together in the order of the tile's points, and what they made by the stage.
void TileWork::work_on_parts(const TileGroup& group, stages::TileJob& job, bool has_water) const {
  const core::ColumnSet gives = stage_.info().gives;
  core::Block whole;
  whole.origin = context_.origin;
  if (!gives.empty()) {
    whole.x.resize(group.own);
    core::add_columns(whole, gives);
    whole.x = {};
  }
  const fs::path folder_of_parts = job.folder / ("parts_" + file_label(job.key));
  std::vector<fs::path> folders;
  for (int k = 0; k < group.parts * group.parts; ++k) {
    const io::FinishedFiles of_part;  // they go once they are joined: the tile's record must not name them
    const TilePart part{job.key, group.parts, k % group.parts, k / group.parts};
    folders.push_back(folder_of_parts / std::to_string(k));
    fs::create_directories(folders.back());
    stages::TileJob mine{job.key, part.metres(context_.tile_side), folders.back(), {}, 0, {}};
    std::vector<std::uint32_t> rows;
    mine.block = store_.read_part(part, stage_.halo(), columns_of_tiles(stage_), rows, thinner(mine.box), group.with_halo);
    mine.own = rows.size();
    core::add_columns(mine.block, gives);
    run_stage(mine, has_water);
    job.tally.add(mine.tally);
    core::for_each_column([&](core::Column c, std::string_view, auto member) {
      if (gives.has(c))
        for (size_t i = 0; i < rows.size(); ++i) (whole.*member)[rows[i]] = (mine.block.*member)[i];
    });
  }
  stage_.join_parts(context_, job, folders);
  fs::remove_all(folder_of_parts);
  job.block = std::move(whole);
  job.own = group.own;
}

}  // namespace swath::pipeline
