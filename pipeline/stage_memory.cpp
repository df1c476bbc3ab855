// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/stage_memory.h"

#include <algorithm>
#include <cmath>

#include "pipeline/work/store_file.h"

namespace swath::pipeline {
namespace {

constexpr int finest = 8;                // parts along a side of a tile: each has its halo, which takes time
constexpr double number_in_tile = 12.0;  // bytes of a part's point: its row in the tile, as found and as kept
// Points of a neighbour that wait to be thinned beside those that are left of it.
constexpr double waiting = static_cast<double>(TileStore::thinned_at_once + chunk_rows);

double bytes_of(core::ColumnSet columns, double source_width) {
  double bytes = columns.has(core::Column::source) ? source_width : 0.0;
  core::for_each_column([&](core::Column c, std::string_view, auto member) {
    using T = typename std::remove_reference_t<decltype(std::declval<core::Block>().*member)>::value_type;
    if (columns.has(c)) bytes += sizeof(T);
  });
  return bytes;
}

}  // namespace

core::ColumnSet columns_of_tiles(const stages::Stage& s) { return s.info().needs | s.info().gives | s.also_reads(); }

bool has_surface(const std::vector<stages::Product>& products) {
  return std::any_of(products.begin(), products.end(),
                     [](stages::Product p) { return p == stages::Product::dtm || p == stages::Product::dsm; });
}

bool reads_points(const stages::Stage& s) {
  return !columns_of_tiles(s).empty() || s.info().takes(stages::Product::points) || has_surface(s.info().gives_products);
}

const std::vector<std::uint32_t>& SquareCounts::of(TileKey key) {
  const auto [at, is_new] = counts_.try_emplace(key);
  if (is_new) at->second = store_.counts_of(key, across);
  return at->second;
}

StageMemory::StageMemory(const TileStore& store, const stages::Stage& stage, const stages::Context& context)
    : store_(store), stage_(stage), context_(context), square_(context) {
  using core::Column;
  const core::ColumnSet there = store.columns() | stage.info().gives, places{Column::x, Column::y, Column::z};
  const core::ColumnSet read = columns_of_tiles(stage) | places;
  if (reads_points(stage)) row_bytes_ = bytes_of(read - (read - there), static_cast<double>(store.source_width()));
  given_bytes_ = bytes_of(stage.info().gives, 0.0);
}

/// Of the points around a tile, those that its bytes are for, where `share` of all would be if they were spread evenly: at the edge of a
/// survey most of them are the tile's own, which all count.
double StageMemory::points_counted(const Points& points, double side, double share) const {
  const double reach = side + 2.0 * std::min(stage_.near_halo(), stage_.halo()), own_share = side * side / (reach * reach);
  if (share >= 1.0 || own_share >= 1.0) return points.near;
  return points.own + (points.near - points.own) * std::max(0.0, (share - own_share) / (1.0 - own_share));
}

/// Bytes of what is worked on at once: the points of `box` with those around it.
double StageMemory::needed(const Points& points, const stages::Box& box) const {
  const double side = 0.5 * (box.x1 - box.x0 + box.y1 - box.y0);  // the square of the same perimeter is not smaller
  square_.tile_side = side;
  const double chunk = 2.0 * static_cast<double>(chunk_rows) * row_bytes_;  // read, packed and unpacked
  const stages::TileMemory own = stage_.memory(square_);
  double bytes = chunk + row_bytes_ * points.rows + own.bytes_per_point * points_counted(points, side, own.share_of_points), first = 0.0;
  for (stages::Raster r : own.rasters) {
    if (!std::isfinite(r.rim)) {
      bytes += r.total(points.all);
      continue;
    }
    const stages::Box there = store_.extent_in(box.grown(0.5 * (r.side - side))).grown(r.rim);
    r.side = std::min(r.side, std::sqrt(there.area()));
    first += r.total(points.all);
  }
  return bytes + std::max(first, own.bytes_per_own * points.own);
}

TileGroup StageMemory::of(std::vector<TileKey> tiles) const {
  TileGroup group;
  for (const TileKey k : tiles)
    if (const auto at = store_.tiles().find(k); at != store_.tiles().end()) group.own += at->second;
  const TileBox box(tiles);
  const stages::Box metres = box.metres(context_.tile_side);
  const auto own = static_cast<double>(group.own);
  if (stage_.is_streamed()) {
    const auto rows = static_cast<double>(TileStore::rows_at_once);
    group.with_halo = group.own;
    group.bytes = static_cast<std::uint64_t>(needed({2.0 * rows, rows, rows, own}, metres));
    group.tiles = std::move(tiles);
    return group;
  }
  const double halo = stage_.halo();
  const auto all = static_cast<double>(store_.load_with_halo(tiles, halo).points);
  double near = all, rows = all, moment = 0.0;
  if (stage_.near_halo() < halo) {
    const TileStore::Load load = store_.load_with_halo(tiles, stage_.near_halo());
    const double left = static_cast<double>(store_.left_around(tiles, stage_.near_halo(), halo, stage_.left_per_area()));
    const double of_tile = stage_.left_per_area() * context_.tile_side * context_.tile_side;
    near = std::min(all, static_cast<double>(load.points)), rows = std::min(all, near + left);
    // What one neighbour gives waits to be thinned.
    moment = std::min(all - own, static_cast<double>(load.neighbour) + of_tile + waiting);
  }
  group.with_halo = static_cast<std::uint64_t>(rows);
  group.bytes = static_cast<std::uint64_t>(needed({rows + moment, near, own, all}, metres));
  group.tiles = std::move(tiles);
  return group;
}

/// Sums of the counts around a tile, so that those of any box of squares are at hand.
class StageMemory::Around {
 public:
  Around(const TileStore& store, TileKey key, double halo, double side, SquareCounts& counts)
      : reach_(static_cast<int>(std::ceil(halo / side))), n_((2 * reach_ + 1) * SquareCounts::across) {
    sums_.assign(static_cast<size_t>(n_ + 1) * static_cast<size_t>(n_ + 1), 0);
    constexpr int across = SquareCounts::across;
    for (int ty = -reach_; ty <= reach_; ++ty)
      for (int tx = -reach_; tx <= reach_; ++tx) {
        const TileKey k{key.ix + tx, key.iy + ty};
        if (!store.tiles().contains(k)) continue;
        const std::vector<std::uint32_t>& of = counts.of(k);
        for (int j = 0; j < across; ++j)
          for (int i = 0; i < across; ++i)
            at((tx + reach_) * across + i + 1, (ty + reach_) * across + j + 1) = of[static_cast<size_t>(j * across + i)];
      }
    for (int j = 1; j <= n_; ++j)
      for (int i = 1; i <= n_; ++i) at(i, j) += at(i - 1, j) + at(i, j - 1) - at(i - 1, j - 1);
  }
  /// At most in the part of the tile and so many metres around it.
  double in(const TilePart& part, double grown, double side) {
    const double squares = grown / side * SquareCounts::across;
    const int width = SquareCounts::across / part.n, more = static_cast<int>(std::ceil(squares)), first = reach_ * SquareCounts::across;
    const auto low = [&](int k) { return std::clamp(first + k * width - more, 0, n_); };
    const auto high = [&](int k) { return std::clamp(first + (k + 1) * width + more, 0, n_); };
    const int i0 = low(part.i), i1 = high(part.i), j0 = low(part.j), j1 = high(part.j);
    return static_cast<double>(at(i1, j1) - at(i0, j1) - at(i1, j0) + at(i0, j0));
  }

 private:
  std::uint64_t& at(int i, int j) { return sums_[static_cast<size_t>(j) * static_cast<size_t>(n_ + 1) + static_cast<size_t>(i)]; }
  int reach_, n_;
  std::vector<std::uint64_t> sums_;
};

TileGroup StageMemory::cut(TileGroup group, std::uint64_t budget, SquareCounts& counts) const {
  if (!stage_.is_divisible() || stage_.is_streamed() || group.tiles.size() != 1 || group.bytes <= budget) return group;
  const double side = context_.tile_side, halo = stage_.halo(), near = std::min(stage_.near_halo(), halo);
  Around around(store_, group.tiles[0], halo, side, counts);
  TileGroup least = group;
  for (int n = 2; n <= finest; n *= 2) {
    double bytes = 0.0, rows_of_largest = 0.0;
    const double part_side = side / n;
    for (int j = 0; j < n; ++j)
      for (int i = 0; i < n; ++i) {
        const TilePart part{group.tiles[0], n, i, j};
        const double points = around.in(part, halo, side);
        const double near_points = near < halo ? around.in(part, near, side) : points;
        const double reached = part_side + 2.0 * halo, own = around.in(part, 0.0, side);
        const double rows = std::min(points, near_points + stage_.left_per_area() * reached * reached);
        const double one = needed({rows, std::min(points, near_points), own, points}, part.metres(side)) + number_in_tile * rows;
        if (one > bytes) bytes = one, rows_of_largest = rows;
      }
    // What the parts give is put together in a column of the whole tile.
    bytes += given_bytes_ * static_cast<double>(group.own);
    if (bytes >= static_cast<double>(least.bytes)) continue;
    least.parts = n;
    least.bytes = static_cast<std::uint64_t>(bytes);
    least.with_halo = static_cast<std::uint64_t>(rows_of_largest);
    if (least.bytes <= budget) break;
  }
  return least;
}

}  // namespace swath::pipeline
