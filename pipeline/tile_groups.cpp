// SPDX-License-Identifier: GPL-3.0-or-later
// All tiles are one group at first; then the one with most work is cut in two, again and again, across its longer side.
#include "pipeline/tile_groups.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <iterator>
#include <limits>
#include <numeric>
#include <utility>

#include "core/config/value.h"
#include "io/text/output_file.h"
#include "pipeline/work/piece_record.h"

namespace swath::pipeline {
namespace {

constexpr size_t per_thread = 4;  // groups: more only add to what is around them

// A point around the tiles takes less than half as long as one of their own (filters.ground, 2026-11-22).
std::uint64_t work(const TileGroup& g) { return (g.own + g.with_halo) / 2; }

/// Work of the thread that has most of it, the largest group first.
std::uint64_t longest(const std::vector<TileGroup>& groups, int threads) {
  std::vector<std::uint64_t> left, load(static_cast<size_t>(threads), 0);
  for (const TileGroup& g : groups) left.push_back(work(g));
  std::sort(left.begin(), left.end(), std::greater<>());
  for (const std::uint64_t one : left) *std::min_element(load.begin(), load.end()) += one;
  return *std::max_element(load.begin(), load.end());
}

/// Where half of a group's tiles lie on each side.
std::pair<std::vector<TileKey>, std::vector<TileKey>> cut(const std::vector<TileKey>& tiles) {
  const TileBox box(tiles);
  const bool upright = box.across() >= box.up();
  const auto at = [&](TileKey k) { return upright ? k.ix : k.iy; };
  std::vector<int> places;
  for (const TileKey k : tiles) places.push_back(at(k));
  std::sort(places.begin(), places.end());
  int first_behind = places[places.size() / 2];
  if (first_behind == places.front()) first_behind = *std::upper_bound(places.begin(), places.end(), first_behind);
  std::pair<std::vector<TileKey>, std::vector<TileKey>> halves;
  for (const TileKey k : tiles) (at(k) < first_behind ? halves.first : halves.second).push_back(k);
  return halves;
}

}  // namespace

TileBox::TileBox(const std::vector<TileKey>& tiles) : low(tiles[0]), high(tiles[0]) {
  for (const TileKey k : tiles) {
    low = {std::min(low.ix, k.ix), std::min(low.iy, k.iy)};
    high = {std::max(high.ix, k.ix), std::max(high.iy, k.iy)};
  }
}

std::pair<int, int> TilePart::square_of(TileKey tile, int n, double x, double y, double side) {
  const auto at = [&](double v, int k) { return std::clamp(static_cast<int>(std::floor((v / side - k) * n)), 0, n - 1); };
  return {at(x, tile.ix), at(y, tile.iy)};
}

stages::Box TilePart::metres(double side) const {
  const auto edge = [&](int tile_number, int k) { return (tile_number + static_cast<double>(k) / n) * side; };
  return {edge(tile.ix, i), edge(tile.iy, j), edge(tile.ix, i + 1), edge(tile.iy, j + 1)};
}

std::vector<TileGroup> single_tiles(const std::vector<TileKey>& tiles, const Measure& measure) {
  std::vector<TileGroup> groups;
  for (const TileKey k : tiles) groups.push_back(measure({k}));
  return groups;
}

std::vector<TileGroup> grouped_tiles(const std::vector<TileKey>& tiles, const std::vector<TileBox>& boxes, const Measure& measure) {
  std::vector<TileGroup> groups;
  for (const TileBox& box : boxes) {
    std::vector<TileKey> held;
    std::copy_if(tiles.begin(), tiles.end(), std::back_inserter(held), [&](TileKey k) { return box.holds(k); });
    if (!held.empty()) groups.push_back(measure(std::move(held)));
  }
  return groups;
}

void write_boxes(const std::filesystem::path& file, const std::vector<TileGroup>& groups) {
  core::Value boxes = core::Value::array();
  for (const TileGroup& g : groups) {
    const TileBox box(g.tiles);
    core::Value one = core::Value::array();
    for (const int k : {box.low.ix, box.low.iy, box.high.ix, box.high.iy}) one.push(std::int64_t{k});
    boxes.push(std::move(one));
  }
  const io::UnflushedFiles checked_when_resumed;
  write_record(file, {{}, std::move(boxes)});
}

std::vector<TileBox> read_boxes(const std::filesystem::path& file) {
  std::vector<TileBox> boxes;
  const std::optional<PieceRecord> record = read_record(file);
  if (!record) return boxes;
  for (const core::Value& one : record->note.items()) {
    const auto at = [&](size_t k) { return static_cast<int>(one.items().at(k).as_int()); };
    boxes.push_back({{at(0), at(1)}, {at(2), at(3)}});
  }
  return boxes;
}

std::uint64_t most_bytes(const std::vector<TileGroup>& groups, int threads) {
  std::vector<std::uint64_t> bytes;
  for (const TileGroup& g : groups) bytes.push_back(g.bytes);
  const auto n = static_cast<std::ptrdiff_t>(std::min(bytes.size(), static_cast<size_t>(threads)));
  std::partial_sort(bytes.begin(), bytes.begin() + n, bytes.end(), std::greater<>());
  return std::accumulate(bytes.begin(), bytes.begin() + n, std::uint64_t{0});
}

std::vector<TileGroup> joined_tiles(const std::vector<TileKey>& tiles, int threads, std::uint64_t budget, const Measure& measure) {
  if (tiles.empty()) return {};
  const size_t many = per_thread * static_cast<size_t>(threads);
  std::vector<TileGroup> groups, best;
  std::uint64_t shortest = std::numeric_limits<std::uint64_t>::max();
  // A heap: single tiles, which cannot be cut, at its end.
  const auto divisible = [](const TileGroup& g) { return g.tiles.size() > 1 ? work(g) + 1 : 0; };
  const auto less = [&](const TileGroup& a, const TileGroup& b) { return divisible(a) < divisible(b); };
  groups.push_back(measure(tiles));
  for (size_t looked_at = 0;;) {
    const bool last = divisible(groups.front()) == 0;
    // Each number of groups while there are few, every eighth more then.
    if (last || groups.size() >= looked_at + looked_at / 8) {
      looked_at = groups.size();
      const bool small =
          std::all_of(groups.begin(), groups.end(), [](const TileGroup& g) { return g.tiles.size() == 1 || g.with_halo <= most_points; });
      if (small && most_bytes(groups, threads) <= budget) {
        if (const std::uint64_t l = longest(groups, threads); l < shortest) shortest = l, best = groups;
        if (groups.size() >= many) return best;
      }
    }
    if (last) return best.empty() ? groups : best;
    std::pop_heap(groups.begin(), groups.end(), less);
    auto [low, high] = cut(groups.back().tiles);
    groups.back() = measure(std::move(low));
    std::push_heap(groups.begin(), groups.end(), less);
    groups.push_back(measure(std::move(high)));
    std::push_heap(groups.begin(), groups.end(), less);
  }
}

}  // namespace swath::pipeline
