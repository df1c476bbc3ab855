// SPDX-License-Identifier: GPL-3.0-or-later
// What a stage does on tiles: on those of a group as one, on the parts of one that is cut, or on rows that come one after the other.
#pragma once

#include <functional>
#include <vector>

#include "pipeline/tile_groups.h"
#include "pipeline/tile_store.h"
#include "stages/stage.h"

namespace swath::pipeline {

class TileWork {
 public:
  TileWork(const TileStore& store, const stages::Context& context, const stages::Stage& stage)
      : store_(store), context_(context), stage_(stage) {}
  /// `job` gets the points with what the stage gives them, and its tally. `has_water`: water of known height lies in the tile.
  void run(const TileGroup& group, stages::TileJob& job, bool has_water) const;

 private:
  void work_on(const TileGroup& group, stages::TileJob& job, bool has_water) const;
  void work_on_parts(const TileGroup& group, stages::TileJob& job, bool has_water) const;
  void run_stage(stages::TileJob& job, bool has_water) const;
  std::function<void(core::Block&)> thinner(const stages::Box& box) const;

  const TileStore& store_;
  const stages::Context& context_;
  const stages::Stage& stage_;
};

}  // namespace swath::pipeline
