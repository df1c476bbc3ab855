// SPDX-License-Identifier: GPL-3.0-or-later
// Each tile writes its cells and leaves its trees; the merge puts the trees of all tiles into one file.
#include "stages/adapters/terrain/forest.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <tuple>

#include "core/distributions.h"
#include "io/vector/feature_file.h"
#include "stages/adapters/terrain/on_map.h"
#include "stages/tile.h"
#include "stages/tile_product.h"
#include "terrain/forest/canopy.h"
#include "terrain/forest/trees.h"

namespace swath::stages {
namespace {

namespace fs = std::filesystem;
using core::Column;

struct ForestOptions {
  core::Metres cell{10.0}, cover_height{2.0}, min_tree{3.0}, crown_cell{0.5}, window{0.6};
  double window_share = 0.14;
};

template <class V>
void describe(ForestOptions& o, V& v) {
  v.option("cell", o.cell, core::above_to(0.0, 1000.0), "Side of one cell of cover and height percentiles.");
  v.option("cover_height", o.cover_height, core::above(0.0), "Returns at this height or higher are of the canopy.");
  v.option("min_tree", o.min_tree, core::above(0.0), "Height of the lowest tree.");
  v.option("crown_cell", o.crown_cell, core::within(0.2, 2.0), "Side of the cells in which tops and crowns are looked for.");
  v.option("window", o.window, core::within(0.1, 5.0), "Smallest distance of two tops, less the share of the height.", "Popescu2004");
  v.option("window_share", o.window_share, core::within(0.0, 0.5), "Share of a tree's height by which that distance grows.", "Popescu2004");
}

terrain::TreeOptions tree_options(const ForestOptions& o) { return {o.crown_cell.value, o.min_tree.value, o.window.value, o.window_share}; }

double halo(const ForestOptions& o) { return std::max(o.cell.value, terrain::trees_halo(tree_options(o))); }

struct ForestCounts {
  std::uint64_t trees = 0;
};
template <class V>
void describe(const ForestCounts& r, V& v) {
  v.result("trees", r.trees, "Trees with a top of their own.");
}

struct ForestFindings {
  std::uint64_t trees = 0;
  double cover = std::numeric_limits<double>::quiet_NaN(), median_height = cover, p95_height = cover, crown_hectares = 0.0;
};
template <class V>
void describe(const ForestFindings& r, V& v) {
  v.result("trees", r.trees, core::plain().in_summary(), "Trees with a top of their own.");
  v.result("cover", r.cover, core::share().in_summary(), "First returns of the canopy, of all first returns.");
  v.result("median_height_m", r.median_height, core::metres(), "Median height of the trees.");
  v.result("p95_height_m", r.p95_height, core::metres(), "Height that 5 % of the trees exceed.");
  v.result("crown_area_ha", r.crown_hectares, core::plain(), "Area of all crowns, ha.");
}

/// A tree as a tile leaves it: place minus the run's origin.
struct TreeRow {
  double x, y, z, height, area;
  std::uint64_t corners;
};
struct CornerRow {
  double x, y;
};
struct CoverRow {
  double canopy = 0.0, all = 0.0;  ///< first returns in the tile's own cells
};

fs::path trees_file(const fs::path& folder, TileKey key) { return piece_file(folder, key, "trees"); }

ForestCounts find_forest(const TileJob& job, const Context& context, const ForestOptions& o) {
  const core::Lattice lattice = lattice_in(o.cell.value, job.box);
  const terrain::CanopyCells cells = terrain::canopy_cells(job.block, lattice, o.cover_height.value);
  std::vector<io::RasterBand> bands{{"canopy cover", "", &cells.cover}};
  for (size_t k = 0; k < terrain::canopy_percentiles.size(); ++k)
    bands.push_back({"height, percentile " + std::to_string(terrain::canopy_percentiles[k]), "m", &cells.height[k]});
  bands.push_back({"first returns", "", &cells.first_returns});
  TileRasters{context, "forest"}.write(job.key, lattice, bands);
  CoverRow cover;
  for (size_t c = 0; c < lattice.size(); ++c) {
    const auto n = static_cast<double>(cells.first_returns[c]);
    if (!(n > 0.0)) continue;
    cover.all += n;
    cover.canopy += std::round(n * static_cast<double>(cells.cover[c]));
  }
  std::vector<TreeRow> rows;
  std::vector<CornerRow> corners;
  for (const terrain::Tree& t : terrain::find_trees(job.block, job.own, tree_options(o))) {
    rows.push_back({t.x, t.y, t.z, t.height, t.crown_area, t.crown.size()});
    for (const Eigen::Vector2d& p : t.crown) corners.push_back({p.x(), p.y()});
  }
  write_rows(trees_file(job.folder, job.key), rows, corners, std::vector{cover});
  return {rows.size()};
}

/// Trees of all tiles by place, with their crowns.
std::vector<terrain::Tree> all_trees(const MergeJob& job, std::vector<CoverRow>& cover) {
  std::vector<terrain::Tree> out;
  for (const TileKey key : job.tiles) {
    std::vector<TreeRow> rows;
    std::vector<CornerRow> corners;
    read_rows(trees_file(job.folder, key), rows, corners, cover);
    size_t at = 0;
    for (const TreeRow& r : rows) {
      if (corners.size() - at < r.corners) io::cut_short(trees_file(job.folder, key));
      terrain::Tree t{r.x, r.y, r.z, r.height, r.area};
      for (size_t k = 0; k < r.corners; ++k, ++at) t.crown.emplace_back(corners[at].x, corners[at].y);
      out.push_back(std::move(t));
    }
  }
  std::sort(out.begin(), out.end(), [](const auto& p, const auto& q) { return std::tie(p.x, p.y) < std::tie(q.x, q.y); });
  return out;
}

std::vector<io::SpatialLayer> layers_of(const std::vector<terrain::Tree>& trees, const Context& context) {
  const OnMap map{context};
  const std::vector<io::SpatialField> fields{{"tree", std::int64_t{}}, {"height", 0.0}, {"crown_area", 0.0}, {"crown_diameter", 0.0}};
  io::SpatialLayer tops{"trees", "Highest return of each tree; lengths in m, areas in m2", io::SpatialShape::point, false, fields, {}};
  io::SpatialLayer crowns{"crowns", "Convex outlines of the crowns", io::SpatialShape::polygon, true, fields, {}};
  for (size_t k = 0; k < trees.size(); ++k) {
    const terrain::Tree& t = trees[k];
    const std::vector<io::FieldValue> values{static_cast<std::int64_t>(k + 1), t.height, t.crown_area,
                                             2.0 * std::sqrt(t.crown_area / M_PI)};
    tops.features.push_back({{map({t.x, t.y, t.z})}, values});
    crowns.features.push_back({{}, values});
    for (const Eigen::Vector2d& p : t.crown) crowns.features.back().places.push_back(map({p.x(), p.y(), 0.0}));
  }
  return {tops, crowns};
}

ForestFindings gather_forest(const MergeJob& job, const Context& context) {
  std::vector<CoverRow> cover;
  const std::vector<terrain::Tree> trees = all_trees(job, cover);
  TileRasters{context, "forest"}.finish(job.tiles);
  const std::vector<io::SpatialLayer> layers = layers_of(trees, context);
  io::write_gpkg(context.output / "trees.gpkg", layers, context.product_crs);
  io::write_feature_csv(context.output / "trees.csv", layers.front());
  ForestFindings found;
  found.trees = trees.size();
  CoverRow sum;
  for (const CoverRow& c : cover) sum.canopy += c.canopy, sum.all += c.all;
  found.cover = sum.canopy / sum.all;  // not a number without points
  std::vector<double> heights;
  for (const terrain::Tree& t : trees) heights.push_back(t.height), found.crown_hectares += t.crown_area / 1e4;
  if (heights.empty()) return found;
  found.median_height = core::interpolated_quantile(heights, 0.5);
  found.p95_height = core::interpolated_quantile(heights, 0.95);
  return found;
}

// Measured 2026-11-26 with tests/stages/memory_test.cpp, tile 200 m: 20 bytes per cell of crowns, and 10 MB for a raster of seven bands,
// however small.
TileMemory forest_memory(const ForestOptions& o, const Context& c) {
  const double side = c.tile_side + 2.0 * halo(o);
  return {64.0,
          {{"crown_cell", o.crown_cell.value, side, 28.0, 0.0, "cell"}, {"cell", o.cell.value, c.tile_side, 160.0}, {"", 1.0, 1.0, 12e6}}};
}

}  // namespace

Entry forest_stage() {
  return tile<find_forest, gather_forest>(
      "terrain.forest", "Forest: canopy cover and height percentiles per cell, tops of trees with height and crown.",
      {.columns = {.needs = {Column::height, Column::classification, Column::flags}, .reads = {Column::return_number}},
       .memory = forest_memory,
       .products = [](const ForestOptions&) {
         return std::vector<std::string>{"forest", "forest.vrt", "trees.gpkg", "trees.csv"};
       }});
}

}  // namespace swath::stages
