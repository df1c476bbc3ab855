// SPDX-License-Identifier: GPL-3.0-or-later
// Each tile leaves its returns of buildings and the cells that hold returns; the merge groups the cells of the whole survey, and takes the
// returns of a group, from all tiles that it touches, to their buildings. A tile's returns are let go once their groups are done.
#include "stages/adapters/terrain/buildings.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include "core/block.h"
#include "core/parallel.h"
#include "core/statistics.h"
#include "stages/adapters/terrain/building_files.h"
#include "stages/tile.h"
#include "terrain/buildings/find_buildings.h"
#include "terrain/buildings/regions.h"
#include "terrain/contours/contours.h"

namespace swath::stages {
namespace {

namespace fs = std::filesystem;
using core::Column;
using Eigen::Vector2d;

constexpr double seen_cell = 2.0;      // m: cells that say whether there are returns
constexpr double ground_block = 64.0;  // m: the side of what is read of the terrain model at once

struct BuildingStageOptions {
  std::string name = "buildings";
  core::Metres gap{2.0}, movement{1.0}, plane_tolerance{0.15};
  std::string min_area = "10 m2", min_courtyard = "8 m2", min_plane = "4 m2";
  bool square = true;
  GroundReference ground = GroundReference::lowest;
  BlockTop block = BlockTop::middle;
};

template <class V>
void describe(BuildingStageOptions& o, V& v) {
  v.option("name", o.name, "Name of the files: NAME.gpkg, NAME.csv, NAME.city.json.");
  v.option("gap", o.gap, core::within(0.5, 20.0), "Roofs farther apart are two buildings; at least three times the distance of returns.");
  v.option("min_area", o.min_area, "Smallest building: m2, ft2 or ha; what is smaller is left out and counted.");
  v.option("min_courtyard", o.min_courtyard, "Smallest courtyard or hole of an outline; smaller ones are filled.");
  v.option("square", o.square, "Give two directions to outlines of which 80 % run within 15 deg of them.");
  v.option("movement", o.movement, core::within(0.1, 5.0),
           "Farthest that simplifying and squaring may move an outline from its returns' rim.");
  v.option("plane_tolerance", o.plane_tolerance, core::within(0.02, 1.0), "Returns within this distance of a roof plane lie on it.");
  v.option("min_plane", o.min_plane, "Smallest roof plane, seen from above.");
  v.option("ground", o.ground, "Ground that heights count from: lowest or mean along the outline, 1 m outside.");
  v.option("block", o.block, "Top of the block (LoD 1): eaves, middle (median of the roof) or ridge.");
  const auto is_area = [&](const std::string& text, const std::string& key) {
    v.check(terrain::square_metres(text).has_value(), key + " must be an area of 0 or more with its unit, such as \"10 m2\"");
  };
  is_area(o.min_area, "min_area");
  is_area(o.min_courtyard, "min_courtyard");
  is_area(o.min_plane, "min_plane");
}

terrain::BuildingOptions building_options(const BuildingStageOptions& o) {
  terrain::BuildingOptions b;
  b.gap = o.gap.value, b.movement = o.movement.value, b.square = o.square;
  b.least_area = terrain::square_metres(o.min_area).value_or(0.0);
  b.least_courtyard = terrain::square_metres(o.min_courtyard).value_or(0.0);
  b.planes = {o.plane_tolerance.value, terrain::square_metres(o.min_plane).value_or(0.0)};
  return b;
}

struct BuildingReturnCounts {
  std::uint64_t roofs = 0;
};
template <class V>
void describe(const BuildingReturnCounts& r, V& v) {
  v.result("returns of buildings", r.roofs, "Returns of class 6.");
}

struct BuildingFindings {
  std::uint64_t buildings = 0, returns = 0, planes = 0, squared = 0, cut = 0, without_ground = 0, without_block = 0, with_roof = 0,
                small = 0, small_returns = 0, alone = 0, not_finite = 0;
  double area = 0.0, explained = std::numeric_limits<double>::quiet_NaN(), median_ridge = explained;
};
template <class V>
void describe(const BuildingFindings& r, V& v) {
  v.result("buildings", r.buildings, core::plain().in_summary(), "Buildings.");
  v.result("area_m2", r.area, core::Form{"m2", 0}.in_summary(), "Area of all outlines, less courtyards.");
  v.result("planes", r.planes, core::plain().in_summary(), "Roof planes.");
  v.result("explained", r.explained, core::share(3).in_summary(), "Roof area that lies on planes, of all roof area.");
  v.result("median_ridge_m", r.median_ridge, core::metres(2), "Median of the ridges' heights above ground.");
  v.result("squared", r.squared, "Buildings whose sides were given two directions.");
  v.result("cut", r.cut, core::plain().in_summary(), "Buildings beside which a stretch has no returns: cut by the rim of the data.");
  v.result("without_ground", r.without_ground, "Buildings without terrain within 6 m: no heights above ground, no block.");
  v.result("without_block", r.without_block, "Buildings without a block (LoD 1).");
  v.result("with_roof", r.with_roof, "Buildings with their roof as a solid (LoD 2).");
  v.result("small", r.small, "Groups of returns that are smaller than min_area: left out.");
  v.result("returns", r.returns, "Returns of class 6.");
  v.result("small_returns", r.small_returns, "Returns in groups that are smaller than min_area.");
  v.result("single_returns", r.alone, "Returns of no group: single ones, and all but the lowest at one place.");
  v.result("not_finite", r.not_finite, core::if_any(), "Returns with coordinates that are not finite: left out.");
}

/// A return as a tile leaves it: place minus the run's origin.
struct RoofRow {
  double x, y, z;
};

fs::path roofs_file(const fs::path& folder, TileKey key) { return piece_file(folder, key, "roofs"); }
fs::path cells_file(const fs::path& folder, TileKey key) { return piece_file(folder, key, "cells"); }

terrain::CellPlace place_in(double x, double y, double cell) { return {core::cell_index(x, cell), core::cell_index(y, cell)}; }

BuildingReturnCounts collect_roofs(const TileJob& job, const BuildingStageOptions& o) {
  const core::Block& b = job.block;
  std::vector<RoofRow> roofs;
  std::vector<terrain::CellPlace> built, seen;
  for (size_t p = 0; p < job.own; ++p) {
    if (!core::is_usable(b, p)) continue;
    const double x = b.x[p] + b.origin.x(), y = b.y[p] + b.origin.y();
    if (!std::isfinite(x) || !std::isfinite(y)) continue;
    const terrain::CellPlace cell = place_in(x, y, seen_cell);
    if (seen.empty() || seen.back() != cell) seen.push_back(cell);
    if (b.classification[p] != core::point_class::building) continue;
    roofs.push_back({b.x[p], b.y[p], b.z[p]});
    built.push_back(place_in(x, y, o.gap.value));
  }
  write_rows(roofs_file(job.folder, job.key), roofs);
  write_rows(cells_file(job.folder, job.key), terrain::runs_of(std::move(built)), terrain::runs_of(std::move(seen)));
  return {roofs.size()};
}

/// Heights of the terrain model, read by blocks as they are asked for.
class Terrain {
 public:
  Terrain(const Context& context) : context_(context), model_{*context.grids} {}

  double height(const Vector2d& p) {
    const double x = p.x() + context_.origin.x(), y = p.y() + context_.origin.y();
    const std::pair key{core::cell_index(x, ground_block), core::cell_index(y, ground_block)};
    auto block = blocks_.find(key);
    if (block == blocks_.end()) {
      const double west = static_cast<double>(key.first) * ground_block, south = static_cast<double>(key.second) * ground_block,
                   cell = model_.cell();
      const core::Lattice window = core::lattice_of(cell, west, south, west + ground_block, south + ground_block);
      block = blocks_.emplace(key, model_.window(window)).first;
    }
    const core::Lattice& l = block->second.lattice;
    const auto i = static_cast<int>(core::cell_index(x, l.cell) - l.i0), j = static_cast<int>(core::cell_index(y, l.cell) - l.j0);
    if (!l.holds(i, j)) return std::numeric_limits<double>::quiet_NaN();
    return static_cast<double>(block->second.height[l.at(i, j)]) - context_.origin.z();
  }

 private:
  const Context& context_;
  In<Product::dtm> model_;
  std::map<std::pair<std::int64_t, std::int64_t>, core::Grid> blocks_;
};

/// Groups of returns that may hold buildings, each whole once all tiles that it touches have been read.
class Groups {
 public:
  Groups(const MergeJob& job, const Context& context, const BuildingStageOptions& o) : Groups(job, context, o, cells_of(job)) {}

  terrain::FoundBuildings find() {
    terrain::FoundBuildings all;
    std::map<std::uint32_t, std::vector<terrain::RoofReturn>> open;
    double done = 0.0;
    for (size_t t = 0; t < job_.tiles.size(); ++t) {
      std::vector<RoofRow> rows;
      read_rows(roofs_file(job_.folder, job_.tiles[t]), rows);
      for (const RoofRow& r : rows) {
        const terrain::CellPlace c = place_in(r.x + context_.origin.x(), r.y + context_.origin.y(), o_.gap.value);
        open[built_.group(c.i, c.j)].push_back({r.x, r.y, r.z});
      }
      std::vector<std::vector<terrain::RoofReturn>> whole;
      for (const std::uint32_t g : groups_in_[t]) {
        if (--left_[g] > 0) continue;
        whole.push_back(std::move(open[g]));
        open.erase(g);
      }
      add(std::move(whole), all);
      context_.progress(++done / static_cast<double>(job_.tiles.size()), {});
    }
    std::sort(all.buildings.begin(), all.buildings.end(), terrain::is_west_of);
    return all;
  }

 private:
  struct Cells {
    std::vector<terrain::CellRun> built, seen;
    std::vector<size_t> built_ends;  ///< of each tile's runs in built
  };
  static Cells cells_of(const MergeJob& job) {
    Cells out;
    for (const TileKey key : job.tiles) {
      read_rows(cells_file(job.folder, key), out.built, out.seen);
      out.built_ends.push_back(out.built.size());
    }
    return out;
  }

  Groups(const MergeJob& job, const Context& context, const BuildingStageOptions& o, const Cells& cells)
      : job_(job), context_(context), o_(o), built_(cells.built), seen_(cells.seen) {
    left_.assign(built_.groups(), 0);
    size_t run = 0;
    for (const size_t end : cells.built_ends) {
      std::set<std::uint32_t>& groups = groups_in_.emplace_back();
      for (; run < end; ++run) groups.insert(built_.group(cells.built[run].first, cells.built[run].j));
      for (const std::uint32_t g : groups) ++left_[g];
    }
  }

  void add(std::vector<std::vector<terrain::RoofReturn>> groups, terrain::FoundBuildings& all) const {
    const terrain::BuildingOptions options = building_options(o_);
    std::vector<terrain::FoundBuildings> found(groups.size());
    core::in_parallel(groups.size(), 1, [&](size_t from, size_t to) {
      for (size_t k = from; k < to; ++k) {
        Terrain model(context_);
        const terrain::Surroundings3d around{[&](const Vector2d& p) { return model.height(p); },
                                             [&](const Vector2d& p) {
                                               const terrain::CellPlace c =
                                                   place_in(p.x() + context_.origin.x(), p.y() + context_.origin.y(), seen_cell);
                                               return seen_.holds(c.i, c.j);
                                             }};
        found[k] = terrain::find_buildings(std::move(groups[k]), around, options);
      }
    });
    for (terrain::FoundBuildings& f : found) {
      std::move(f.buildings.begin(), f.buildings.end(), std::back_inserter(all.buildings));
      all.small += f.small, all.small_returns += f.small_returns, all.alone += f.alone, all.not_finite += f.not_finite;
    }
  }

  const MergeJob& job_;
  const Context& context_;
  const BuildingStageOptions& o_;
  terrain::CellSet built_, seen_;
  std::vector<std::set<std::uint32_t>> groups_in_;  ///< of each tile
  std::vector<std::uint32_t> left_;                 ///< tiles with returns of a group that have not been read
};

BuildingFindings summary_of(const terrain::FoundBuildings& found, GroundReference from) {
  BuildingFindings out;
  std::vector<double> ridges;
  double explained = 0.0;
  out.small = found.small, out.small_returns = found.small_returns, out.alone = found.alone, out.not_finite = found.not_finite;
  out.returns = found.small_returns + found.alone + found.not_finite;
  for (const terrain::Building& b : found.buildings) {
    ++out.buildings;
    out.returns += b.returns, out.planes += b.planes.size(), out.squared += b.squared, out.cut += b.is_cut;
    out.area += b.area, explained += b.explained * b.area;
    const double ground = ground_of(b, from);
    out.without_ground += !std::isfinite(ground);
    if (std::isfinite(b.ridge - ground)) ridges.push_back(b.ridge - ground);
  }
  if (out.buildings > 0) out.explained = explained / out.area;
  if (!ridges.empty()) out.median_ridge = core::median(ridges);
  return out;
}

BuildingFindings find_all_buildings(const MergeJob& job, const Context& context, const In<Product::dtm>&, const BuildingStageOptions& o) {
  const terrain::FoundBuildings found = Groups(job, context, o).find();
  const HeightChoices heights{o.ground, o.block};
  const std::vector<io::SpatialLayer> layers = building_layers(found.buildings, context, heights);
  io::write_gpkg(context.output / (o.name + ".gpkg"), layers, context.product_crs);
  io::write_feature_csv(context.output / (o.name + ".csv"), layers.front());
  const CityBuildings city = city_buildings(found.buildings, context, heights);
  io::write_city_json(context.output / (o.name + ".city.json"), city.objects, context.product_crs,
                      o.name + "; heights: " + context.heights);
  BuildingFindings out = summary_of(found, o.ground);
  out.without_block = city.without_block, out.with_roof = city.with_roof;
  return out;
}

}  // namespace

Entry buildings_stage() {
  return tile<collect_roofs, find_all_buildings>(
      "terrain.buildings", "Buildings: outlines, roof planes and heights of the returns of class 6, as GeoPackage, CSV and CityJSON.",
      {.columns = {.needs = {Column::classification, Column::flags}},
       // Where all returns are of roofs: rows, their bytes, and two cells of each.
       .memory = [](const BuildingStageOptions&, const Context&) { return TileMemory{96.0}; },
       .products =
           [](const BuildingStageOptions& o) {
             return std::vector<std::string>{o.name + ".gpkg", o.name + ".csv", o.name + ".city.json"};
           }});
}

}  // namespace swath::stages
