// SPDX-License-Identifier: GPL-3.0-or-later
// The property in which a deck differs from a roof is that of Sithole & Vosselman 2006, "Bridge detection in airborne laser scanner data",
// ISPRS J. 61: its profile joins the ground at both ends and drops at both sides. Deviation: profiles are taken from each cell in 16
// directions, not across the whole scene, so that the reach is bounded; a deck that curves so much that no straight way stays on it is not
// found.
#include "filters/classes/bridges.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>

#include "core/config/units.h"
#include "core/floor_div.h"

namespace swath::filters {
namespace {

constexpr int directions = 16;
constexpr double grade = 0.15;             // rise / run of a deck
constexpr double roughness = 0.3;          // m: step from cell to cell beside the grade
constexpr int widest_gap = 3;              // cells without any return that a way crosses
constexpr int bank = 10;                   // cells from a deck's end to ground at its level
constexpr double ends_of_clearance = 0.4;  // at most
constexpr int open_gap = 5;                // cells without any return beside a deck
constexpr int bank_shown = 4;              // cells beyond it, beside a deck's ends, among which one return at least shows the bank
constexpr int half_width = 25;             // cells to the side of a deck
constexpr double fall = 1.0;               // m beside a deck
constexpr int deck_growth = 5;             // links
constexpr double level_link = 0.5;         // m between cells of one deck
constexpr float seen_under = 0.5f;         // m from a plane down to other returns in the same cell: beams passed through it
constexpr float oblique_below = 2.0f;      // m above ground: from the side, beams reach ground below higher planes
constexpr int through_ring = 3;            // cells around
constexpr int fewest_inner = 5;            // planes among them with planes on all sides
constexpr double through_share = 0.25;     // of these

/// A way that came to the ground's level.
struct Way {
  int direction = 0, cells = 0;                ///< where it came there
  double length = 0, clearance = 0, drop = 0;  ///< m; drop: from its end to the ground there
};

enum class Beside : std::uint8_t { level, open, falls };  ///< open: no returns beside it, as over water

struct Side {
  Beside what = Beside::level;
  int direction = 0, cells = 0;  ///< to its edge
};

/// Among the cells up to `ring` around, the value nearest to z; nothing where there is none.
std::optional<size_t> nearest_level(const core::Lattice& l, const std::vector<float>& level, int i, int j, float z, int ring = 1) {
  size_t best = 0;
  float least = std::numeric_limits<float>::infinity();  // NaN is not nearer
  const int west = std::max(i - ring, 0), east = std::min(i + ring, l.nx - 1);
  const int south = std::max(j - ring, 0), north = std::min(j + ring, l.ny - 1);
  for (int v = south; v <= north; ++v) {
    const size_t row = l.at(0, v);
    for (int u = west; u <= east; ++u) {
      const float off = std::abs(level[row + static_cast<size_t>(u)] - z);
      if (off < least) least = off, best = row + static_cast<size_t>(u);
    }
  }
  return least < std::numeric_limits<float>::infinity() ? std::optional(best) : std::nullopt;
}

CellIndex ahead(int direction, int k) {
  const double bearing = 2.0 * core::pi * direction / directions;
  return {static_cast<int>(std::lround(k * std::cos(bearing))), static_cast<int>(std::lround(k * std::sin(bearing)))};
}

class Decks {
 public:
  Decks(const StructureCells& cells, const BridgeLimits& limits)
      : cells_(cells), limits_(limits), reach_(static_cast<int>(std::ceil(limits.longest / structure_cell))) {
    for (int d = 0; d < directions; ++d)
      for (int k = 0; k <= reach_; ++k) ahead_[static_cast<size_t>(d)].push_back(ahead(d, k));
  }

  std::vector<std::uint8_t> find(const OwnBox& begun) const {
    const core::Lattice& l = cells_.lattice;
    const std::vector<std::uint8_t> may = near_ground_level();
    std::vector<std::uint8_t> deck(l.size(), 0);
    const auto is_second = [](std::int64_t at) { return at != 2 * core::floor_div(at, 2); };
    for (int j = 0; j < l.ny; ++j)
      for (int i = 0; i < l.nx; ++i) {
        const auto may_be = [&](int u, int v) { return l.holds(u, v) && may[l.at(u, v)] != 0 && cells_.kind[l.at(u, v)] == Planar::wide; };
        // One cell in each square of 2 x 2 is judged, the first that may be a deck.
        const int west = is_second(l.i0 + i) ? i - 1 : i, south = is_second(l.j0 + j) ? j - 1 : j;
        if (!begun.touches(l, i, j) || !may_be(i, j) || (i > west && may_be(west, j)) ||
            (j > south && (may_be(west, south) || may_be(west + 1, south))))
          continue;
        deck[l.at(i, j)] = !is_seen_through(i, j) && is_deck(i, j);
      }
    spread(
        cells_, deck, deck_growth, [](size_t) { return structure_link; },
        [&](size_t from, size_t to, int) { return std::abs(cells_.plane[from] - cells_.plane[to]) <= level_link; });
    return deck;
  }

 private:
  /// Cells that planes lead to from places where they join the ground: most roofs are none of them.
  std::vector<std::uint8_t> near_ground_level() const {
    const core::Lattice& l = cells_.lattice;
    std::vector<std::uint8_t> out(l.size(), 0);
    for (int j = 0; j < l.ny; ++j)
      for (int i = 0; i < l.nx; ++i) {
        const size_t c = l.at(i, j);
        if (cells_.kind[c] != Planar::wide) continue;
        const auto ground = nearest_level(l, cells_.ground, i, j, cells_.plane[c], structure_link);
        out[c] = ground && std::abs(cells_.ground[*ground] - cells_.plane[c]) <= limits_.end;
      }
    spread(
        cells_, out, reach_ / structure_link, [](size_t) { return structure_link; },
        [&](size_t from, size_t to, int run) { return std::abs(cells_.plane[from] - cells_.plane[to]) <= roughness + grade * run; });
    return out;
  }

  /// Crops: low planes with returns below them in the middle of the field too.
  bool is_seen_through(int i, int j) const {
    const core::Lattice& l = cells_.lattice;
    int inner = 0, through = 0;
    for (int v = std::max(j - through_ring, 1); v <= std::min(j + through_ring, l.ny - 2); ++v)
      for (int u = std::max(i - through_ring, 1); u <= std::min(i + through_ring, l.nx - 2); ++u) {
        const size_t c = l.at(u, v);
        const bool all = cells_.has_plane(c) && cells_.has_plane(l.at(u - 1, v)) && cells_.has_plane(l.at(u + 1, v)) &&
                         cells_.has_plane(l.at(u, v - 1)) && cells_.has_plane(l.at(u, v + 1));
        if (!all || cells_.height[c] >= oblique_below) continue;
        ++inner;
        through += cells_.plane[c] - cells_.low[c] >= seen_under;
      }
    return inner >= fewest_inner && through >= through_share * inner;
  }

  bool is_deck(int i, int j) const {
    for (int d = 0; d < directions / 2; ++d) {
      const Side right = side(i, j, d + directions / 4);
      if (right.what == Beside::level) continue;
      const Side left = side(i, j, (d + 3 * directions / 4) % directions);
      if (left.what == Beside::level) continue;
      const auto one = way(i, j, d);
      if (!one) continue;
      const auto other = way(i, j, d + directions / 2);
      if (!other || one->length + other->length > limits_.longest) continue;
      const double clearance = std::max(one->clearance, other->clearance);
      if (clearance < fall) continue;  // crops beside a ditch
      // Where the data end no beam comes back either, and not from the banks.
      const auto ends_the_data = [&](const Side& s) {
        return s.what == Beside::open && !(shows_bank(i, j, *one, s) && shows_bank(i, j, *other, s));
      };
      if (ends_the_data(right) || ends_the_data(left)) continue;
      // Hedges and sheds are as high at their ends as between them.
      const bool arches = std::max(one->drop, other->drop) <= std::max(limits_.step, ends_of_clearance * clearance);
      const bool falls = right.what == Beside::falls || left.what == Beside::falls;
      if (arches && (falls || clearance >= limits_.clearance)) return true;
      // No beam comes back from the water on both sides; there may be stairs at one end.
      if (!falls && std::min(one->drop, other->drop) <= limits_.step) return true;
    }
    return false;
  }

  /// Are there returns past the side's edge where the way ends, and a little on?
  bool shows_bank(int i, int j, const Way& w, const Side& s) const {
    const core::Lattice& l = cells_.lattice;
    for (int n = w.cells; n <= std::min(w.cells + bank, reach_); ++n) {
      const CellIndex along = ahead_[static_cast<size_t>(w.direction)][static_cast<size_t>(n)];
      for (int k = s.cells + 2; k <= std::min(s.cells + 2 + bank_shown, reach_); ++k) {
        const CellIndex out = ahead_[static_cast<size_t>(s.direction)][static_cast<size_t>(k)];
        const int u = i + along.i + out.i, v = j + along.j + out.j;
        if (l.holds(u, v) && !std::isnan(cells_.low[l.at(u, v)])) return true;
      }
    }
    return false;
  }

  std::optional<Way> way(int i, int j, int direction) const {
    const core::Lattice& l = cells_.lattice;
    float z = cells_.plane[l.at(i, j)];
    Way w{direction, 0, 0.0, static_cast<double>(cells_.height[l.at(i, j)]), 0.0};
    int last = 0;
    for (int k = 1; k <= reach_; ++k) {
      const CellIndex to = ahead_[static_cast<size_t>(direction)][static_cast<size_t>(k)];
      if (!l.holds(i + to.i, j + to.j)) return std::nullopt;
      const double may = roughness + grade * structure_cell * (k - last);
      if (const auto next = nearest_level(l, cells_.plane, i + to.i, j + to.j, z); next && std::abs(cells_.plane[*next] - z) <= may) {
        z = cells_.plane[*next];
        w.clearance = std::max(w.clearance, static_cast<double>(cells_.height[*next]));
        last = k;
        continue;
      }
      if (const auto ground = nearest_level(l, cells_.ground, i + to.i, j + to.j, z)) {
        w.cells = k;
        w.length = k * structure_cell;
        w.drop = static_cast<double>(std::abs(cells_.ground[*ground] - z));
        return w.drop <= limits_.end && reaches_level(i, j, direction, k, z) ? std::optional(w) : std::nullopt;
      }
      if (k - last > widest_gap) return std::nullopt;
    }
    return std::nullopt;
  }

  /// Does the ground come to level z within a few cells from the k-th ahead on?
  bool reaches_level(int i, int j, int direction, int k, float z) const {
    for (int n = k; n <= std::min(k + bank, reach_); ++n) {
      const CellIndex to = ahead_[static_cast<size_t>(direction)][static_cast<size_t>(n)];
      if (const auto ground = nearest_level(cells_.lattice, cells_.ground, i + to.i, j + to.j, z);
          ground && std::abs(cells_.ground[*ground] - z) <= limits_.step + grade * structure_cell * (n - k))
        return true;
    }
    return false;
  }

  /// What is beside the plane in a direction, once it ends.
  Side side(int i, int j, int direction) const {
    const core::Lattice& l = cells_.lattice;
    float z = cells_.plane[l.at(i, j)];
    int last = 0;
    bool seen = false;  // returns beside it, lower by less than a fall: crops
    for (int k = 1; k <= std::min(half_width + open_gap, reach_); ++k) {
      const CellIndex to = ahead_[static_cast<size_t>(direction)][static_cast<size_t>(k)];
      if (!l.holds(i + to.i, j + to.j)) return {};  // unknown
      const double may = roughness + grade * structure_cell * (k - last);
      if (const auto next = nearest_level(l, cells_.plane, i + to.i, j + to.j, z); next && std::abs(cells_.plane[*next] - z) <= may) {
        z = cells_.plane[*next];
        last = k;
        seen = false;
        if (last >= half_width) return {};
        continue;
      }
      const size_t c = l.at(i + to.i, j + to.j);
      seen = seen || !std::isnan(cells_.low[c]);
      if (static_cast<double>(z - cells_.low[c]) >= fall) return {Beside::falls, direction, last};
      if (const auto ground = nearest_level(l, cells_.ground, i + to.i, j + to.j, z);
          ground && std::abs(cells_.ground[*ground] - z) <= limits_.step)
        return {};
      if (k - last > open_gap) return {seen ? Beside::level : Beside::open, direction, last};
    }
    return {};
  }

  const StructureCells& cells_;
  BridgeLimits limits_;
  int reach_;
  std::array<std::vector<CellIndex>, directions> ahead_;
};

}  // namespace

double deck_spread() { return (deck_growth * structure_link + 1) * structure_cell; }

double deck_cells_halo(double longest) {
  return deck_spread() + std::hypot(longest, (half_width + 2 + bank_shown) * structure_cell) + 2 * structure_cell;
}

std::vector<std::uint8_t> deck_cells(const StructureCells& cells, const BridgeLimits& limits, const OwnBox& begun) {
  return Decks(cells, limits).find(begun);
}

}  // namespace swath::filters
