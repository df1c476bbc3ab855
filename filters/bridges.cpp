// SPDX-License-Identifier: GPL-3.0-or-later
// The property that tells a deck from a roof is that of Sithole & Vosselman 2006, "Bridge detection in airborne laser scanner data", ISPRS
// J. 61: its profile joins the ground at both ends and drops at both sides. Deviation: profiles are taken from each cell in 16 directions,
// not across the whole scene, so that the reach is bounded; a deck that curves so much that no straight way stays on it is not found.
#include "filters/bridges.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include "core/units.h"

namespace swath::filters {
namespace {

constexpr int directions = 16;
constexpr double grade = 0.15;      // rise / run of a deck
constexpr double roughness = 0.3;   // m: step from cell to cell beside the grade
constexpr int widest_gap = 3;       // cells without any return that a way crosses
constexpr int terrain_ways = 12;    // of the directions
constexpr int deck_growth = 10;     // cells
constexpr double level_link = 0.5;  // m between cells of one deck

/// A way that came to the ground's level.
struct Way {
  double length = 0, clearance = 0;
};

/// Among the 3 x 3 cells around, the value nearest to z; nothing where there is none.
std::optional<size_t> nearest_level(const core::Lattice& l, const std::vector<float>& level, int i, int j, float z) {
  std::optional<size_t> best;
  for (int dj = -1; dj <= 1; ++dj)
    for (int di = -1; di <= 1; ++di) {
      if (!l.holds(i + di, j + dj)) continue;
      const size_t c = l.at(i + di, j + dj);
      if (std::isnan(level[c])) continue;
      if (!best || std::abs(level[c] - z) < std::abs(level[*best] - z)) best = c;
    }
  return best;
}

std::optional<Way> way(const StructureCells& cells, int i, int j, int direction, double longest, double step) {
  const core::Lattice& l = cells.lattice;
  const double bearing = 2.0 * core::pi * direction / directions;
  const double dx = std::cos(bearing), dy = std::sin(bearing);
  float z = cells.plane[l.at(i, j)];
  Way w{0.0, static_cast<double>(cells.height[l.at(i, j)])};
  int last = 0;
  for (int k = 1; k * structure_cell <= longest; ++k) {
    const int ci = i + static_cast<int>(std::lround(k * dx)), cj = j + static_cast<int>(std::lround(k * dy));
    if (!l.holds(ci, cj)) return std::nullopt;
    const double may = roughness + grade * structure_cell * (k - last);
    if (const auto next = nearest_level(l, cells.plane, ci, cj, z); next && std::abs(cells.plane[*next] - z) <= may) {
      z = cells.plane[*next];
      w.clearance = std::max(w.clearance, static_cast<double>(cells.height[*next]));
      last = k;
      continue;
    }
    if (const auto ground = nearest_level(l, cells.ground, ci, cj, z)) {
      w.length = k * structure_cell;
      const bool level = std::abs(cells.ground[*ground] - z) <= std::max(step, may);
      return level ? std::optional(w) : std::nullopt;
    }
    if (k - last > widest_gap) return std::nullopt;
  }
  return std::nullopt;
}

Deck judge(const StructureCells& cells, int i, int j, double longest, double clearance, double step) {
  std::array<std::optional<Way>, directions> ways;
  int arrived = 0;
  for (int d = 0; d < directions; ++d) {
    ways[static_cast<size_t>(d)] = way(cells, i, j, d, longest, step);
    arrived += ways[static_cast<size_t>(d)].has_value();
  }
  const auto at = [&](int d) -> const std::optional<Way>& { return ways[static_cast<size_t>(d % directions)]; };
  for (int d = 0; d < directions / 2; ++d) {
    const auto &one = at(d), &other = at(d + directions / 2);
    if (!one || !other || at(d + directions / 4) || at(d + 3 * directions / 4)) continue;
    if (one->length + other->length <= longest && std::max(one->clearance, other->clearance) >= clearance) return Deck::deck;
  }
  return arrived >= terrain_ways ? Deck::terrain : Deck::none;
}

}  // namespace

double deck_cells_halo(double longest) { return longest + (deck_growth + 3) * structure_cell; }

std::vector<Deck> deck_cells(const StructureCells& cells, double longest, double clearance, double step) {
  const core::Lattice& l = cells.lattice;
  std::vector<Deck> judged(l.size(), Deck::none);
  for (int j = 0; j < l.ny; ++j)
    for (int i = 0; i < l.nx; ++i)
      if (cells.has_plane(l.at(i, j))) judged[l.at(i, j)] = judge(cells, i, j, longest, clearance, step);
  if (std::find(judged.begin(), judged.end(), Deck::deck) == judged.end()) return judged;

  std::vector<Deck> out = judged;
  const auto level = [&](size_t from, size_t to) {
    return cells.has_plane(to) && std::abs(cells.plane[from] - cells.plane[to]) <= level_link;
  };
  for (int j = 0; j < l.ny; ++j)
    for (int i = 0; i < l.nx; ++i) {
      const size_t c = l.at(i, j);
      if (!cells.has_plane(c) || judged[c] == Deck::deck) continue;
      if (grow(l, i, j, deck_growth, level, [&](size_t at, int) { return judged[at] == Deck::deck; })) out[c] = Deck::deck;
    }
  return out;
}

}  // namespace swath::filters
