// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <map>
#include <set>

#include "stages/grid_tile.h"
#include "stages/stage.h"

namespace swath::pipeline {

/// The grids that tile stages have left in their folders, seen as one surface.
class GridStore : public stages::Grids {
 public:
  explicit GridStore(double tile_side) : tile_side_(tile_side) {}
  /// From now on the product's tiles are in `folder`, those that are there now: one that is gone later is an error, not a void.
  void add(stages::Product product, std::filesystem::path folder);

  bool has(stages::Product product) const override { return folders_.contains(product); }

  std::filesystem::path folder(stages::Product product) const override { return folders_.at(product); }
  core::Grid window(stages::Product product, const core::Lattice& lattice) const override;
  double cell(stages::Product product) const override;

 private:
  double tile_side_;
  std::map<stages::Product, std::filesystem::path> folders_;
  std::map<stages::Product, std::set<std::filesystem::path>> files_;
  std::map<stages::Product, double> cells_;
};

}  // namespace swath::pipeline
