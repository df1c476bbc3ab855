// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/grid_store.h"

#include <cmath>

#include "core/error.h"
#include "core/paste.h"
#include "io/text/output_file.h"

namespace swath::pipeline {

core::Grid GridStore::window(stages::Product product, const core::Lattice& lattice) const {
  core::Grid out(lattice);
  const auto at = folders_.find(product);
  if (at == folders_.end()) return out;
  const std::set<std::filesystem::path>& there = files_.at(product);
  const auto first = [this](double edge) { return static_cast<int>(std::floor(edge / tile_side_)); };
  for (int iy = first(lattice.south()); iy <= first(lattice.north()); ++iy)
    for (int ix = first(lattice.west()); ix <= first(lattice.east()); ++ix) {
      const auto file = stages::grid_file(at->second, {ix, iy});
      if (there.contains(file)) core::paste(io::read_grid_file(file), out);
    }
  return out;
}

double GridStore::cell(stages::Product product) const {
  const auto at = cells_.find(product);
  if (at == cells_.end()) throw core::Error("there is no " + std::string(stages::name_of(product)) + " to read from");
  return at->second;
}

void GridStore::add(stages::Product product, std::filesystem::path folder) {
  // Of a stage that gives several grids each has a folder of its own.
  if (std::filesystem::is_directory(folder / stages::name_of(product))) folder /= stages::name_of(product);
  std::set<std::filesystem::path>& files = files_[product];
  files.clear();
  for (const auto& entry : std::filesystem::directory_iterator(folder))
    if (entry.path().extension() == ".grid" && !io::is_temporary(entry.path())) files.insert(entry.path());
  if (!files.empty()) cells_[product] = io::read_grid_file(*files.begin()).lattice.cell;
  folders_[product] = std::move(folder);
}

}  // namespace swath::pipeline
