// SPDX-License-Identifier: GPL-3.0-or-later
// Euclidean clusters (Rusu 2010, "Semantic 3D object maps for everyday manipulation", 6.2) on the survey's own lattice of cubes: whether
// two points are connected differs from a radius of `gap` by up to sqrt(12) of it, and in return no result depends on a tile's extent.
#include "filters/noise/point_groups.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <unordered_map>

#include "filters/bins.h"

namespace swath::filters {
namespace {

constexpr int widest = 2;          // cubes of a group
constexpr std::int64_t bits = 21;  // of one index in a cube's key

struct Cube {
  std::int64_t i = 0, j = 0, k = 0;
  std::uint64_t key() const {
    const auto part = [](std::int64_t v) { return static_cast<std::uint64_t>(v) & ((std::uint64_t{1} << bits) - 1); };
    return part(i) << (2 * bits) | part(j) << bits | part(k);
  }
};

struct Content {
  Cube cube;
  std::uint32_t points = 0;
  double low = std::numeric_limits<double>::infinity(), high = -std::numeric_limits<double>::infinity();
  bool seen = false;
};

enum class Verdict : std::uint8_t { none, above, below };

class Cubes {
 public:
  Cubes(const core::Block& b, const std::vector<std::uint8_t>& takes_part, double gap) : cube_of_(b.size(), nothing) {
    const core::Lattice l = lattice_around(b, gap, 0);
    std::uint64_t last_key = ~std::uint64_t{0};
    std::uint32_t last = nothing;
    constexpr double highest = static_cast<double>(std::int64_t{1} << (bits - 2));
    for (size_t p = 0; p < b.size(); ++p) {
      if (!takes_part[p]) continue;
      const CellIndex c = cell_of(l, b, p);
      const double level = std::clamp(std::floor((b.origin.z() + b.z[p]) / gap), -highest, highest);
      const Cube cube{c.i, c.j, static_cast<std::int64_t>(level)};
      const std::uint64_t key = cube.key();
      if (key != last_key) {  // points of a pulse's surroundings mostly share a cube
        const auto [at, fresh] = index_.try_emplace(key, static_cast<std::uint32_t>(content_.size()));
        if (fresh) {
          content_.push_back({cube});
          columns_[Cube{cube.i, cube.j, 0}.key()].push_back(at->second);
        }
        last = at->second;
        last_key = key;
      }
      Content& content = content_[last];
      ++content.points;
      content.low = std::min(content.low, b.z[p]);
      content.high = std::max(content.high, b.z[p]);
      cube_of_[p] = last;
    }
  }

  std::vector<LonePoint> lone(int most) {
    std::vector<Verdict> verdict(content_.size(), Verdict::none);
    bool any = false;
    for (std::uint32_t start = 0; start < content_.size(); ++start) {
      if (content_[start].seen || content_[start].points > static_cast<std::uint32_t>(most)) continue;
      const std::vector<std::uint32_t> group = group_of(start, most);
      const Verdict v = group.empty() ? Verdict::none : place_of(group);
      for (const std::uint32_t c : group) verdict[c] = v;
      any = any || v != Verdict::none;
    }
    std::vector<LonePoint> out;
    for (size_t p = 0; any && p < cube_of_.size(); ++p)
      if (cube_of_[p] != nothing && verdict[cube_of_[p]] != Verdict::none)
        out.push_back({static_cast<std::uint32_t>(p), verdict[cube_of_[p]] == Verdict::above});
    return out;
  }

 private:
  static constexpr std::uint32_t nothing = 0xffffffffu;

  std::uint32_t find(const Cube& c) const {
    const auto at = index_.find(c.key());
    return at == index_.end() ? nothing : at->second;
  }

  /// All cubes that are connected with `start`; empty where they are too many, too wide, or known to be.
  std::vector<std::uint32_t> group_of(std::uint32_t start, int most) {
    std::vector<std::uint32_t> group{start};
    content_[start].seen = true;
    std::uint32_t points = content_[start].points;
    Cube low = content_[start].cube, high = low;
    for (size_t n = 0; n < group.size(); ++n) {
      const Cube c = content_[group[n]].cube;
      for (std::int64_t dk = -1; dk <= 1; ++dk)
        for (std::int64_t dj = -1; dj <= 1; ++dj)
          for (std::int64_t di = -1; di <= 1; ++di) {
            const std::uint32_t at = find({c.i + di, c.j + dj, c.k + dk});
            if (at == nothing || std::find(group.begin(), group.end(), at) != group.end()) continue;
            Content& next = content_[at];
            if (next.seen || next.points > static_cast<std::uint32_t>(most)) return {};  // seen: of a group given up before
            next.seen = true;
            points += next.points;
            low.i = std::min(low.i, next.cube.i), high.i = std::max(high.i, next.cube.i);
            low.j = std::min(low.j, next.cube.j), high.j = std::max(high.j, next.cube.j);
            if (points > static_cast<std::uint32_t>(most) || high.i - low.i >= widest || high.j - low.j >= widest) return {};
            group.push_back(at);
          }
    }
    return group;
  }

  Verdict place_of(const std::vector<std::uint32_t>& group) const {
    double low = std::numeric_limits<double>::infinity(), high = -low;
    for (const std::uint32_t c : group) low = std::min(low, content_[c].low), high = std::max(high, content_[c].high);
    bool others = false, above = true, below = true;
    for (const std::uint32_t c : group)
      for (std::int64_t dj = -1; dj <= 1; ++dj)
        for (std::int64_t di = -1; di <= 1; ++di) {
          const auto column = columns_.find(Cube{content_[c].cube.i + di, content_[c].cube.j + dj, 0}.key());
          if (column == columns_.end()) continue;
          for (const std::uint32_t other : column->second) {
            if (std::find(group.begin(), group.end(), other) != group.end()) continue;
            others = true;
            above = above && content_[other].high < low;
            below = below && content_[other].low > high;
          }
        }
    if (!others) return Verdict::none;
    return above ? Verdict::above : below ? Verdict::below : Verdict::none;
  }

  std::vector<std::uint32_t> cube_of_;
  std::vector<Content> content_;
  std::unordered_map<std::uint64_t, std::uint32_t> index_;
  std::unordered_map<std::uint64_t, std::vector<std::uint32_t>> columns_;
};

}  // namespace

double lone_points_halo(double gap) { return (widest + 1) * gap; }

std::vector<LonePoint> lone_points(const core::Block& b, const std::vector<std::uint8_t>& takes_part, double gap, int most) {
  if (b.size() == 0 || most <= 0) return {};
  return Cubes(b, takes_part, gap).lone(most);
}

}  // namespace swath::filters
