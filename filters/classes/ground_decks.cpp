// SPDX-License-Identifier: GPL-3.0-or-later
// The profile of a deck is that of Sithole & Vosselman 2006, "Bridge detection in airborne laser scanner data", ISPRS J. 61: level
// lengthwise, with a sheer fall on both sides. Deviation: where water returns nothing, a wide void beside a sharp edge counts as the fall.
// A dam between quay walls in black water has the same profile: it is taken for a deck.
#include "filters/classes/ground_decks.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>

#include "core/config/units.h"
#include "core/floor_div.h"
#include "filters/bins.h"
#include "filters/classes/deck_heights.h"
#include "filters/classes/deck_profile.h"

namespace swath::filters {
namespace {

constexpr int deck_directions = 16;
using namespace deck_profile;

constexpr double closed = std::numeric_limits<double>::infinity();

enum class DeckSide : std::uint8_t { level, falls, open };

CellIndex cells_ahead(int direction, int k) {
  const double bearing = 2.0 * core::pi * direction / deck_directions;
  return {static_cast<int>(std::lround(k * std::cos(bearing))), static_cast<int>(std::lround(k * std::sin(bearing)))};
}

/// The cells of one side, in the districts that have it.
class Cells {
 public:
  Cells(const core::Block& b, double side, double longest)
      : lattice_(lattice_around(b, side, 0)), half_(in_cells(widest)), reach_(in_cells(longest + bank_length)) {
    DeckHeights heights = deck_heights(b, lattice_);
    known_ = open_ = axes_ = strip_ = std::vector<std::uint8_t>(lattice_.size(), 0);
    width_ = narrow_ = std::vector<float>(lattice_.size(), 0.0f);
    top_ = std::move(heights.top), low_ = std::move(heights.low), ground_ = std::move(heights.ground);
    for (int d = 0; d < deck_directions; ++d)
      for (int k = 0; k <= std::max({reach_, half_ + in_cells(hidden), in_cells(banks)}); ++k)
        ahead_[static_cast<size_t>(d)].push_back(cells_ahead(d, k));
  }

  const core::Lattice& lattice() const { return lattice_; }
  float top(size_t c) const { return level_[c]; }
  bool has_ground(size_t c) const { return ground_[c] != 0; }
  /// Are there returns a fall below that level in the cell or beside it, or none at all?
  bool is_edge(const CellIndex& at, float level) const {
    for (int v = std::max(at.j - 1, 0); v <= std::min(at.j + 1, lattice_.ny - 1); ++v)
      for (int u = std::max(at.i - 1, 0); u <= std::min(at.i + 1, lattice_.nx - 1); ++u)
        if (const float low = low_[lattice_.at(u, v)]; std::isnan(low) || static_cast<double>(level - low) >= fall_beside) return true;
    return false;
  }

  /// Marks the cells of decks among those that `taken` lets through.
  template <class Taken>
  std::vector<std::uint8_t> decks(Taken&& taken) {
    const std::vector<std::uint8_t> near = near_edges();
    std::vector<std::uint8_t> out(lattice_.size(), 0);
    for (int j = 0; j < lattice_.ny; ++j)
      for (int i = 0; i < lattice_.nx; ++i) {
        const size_t c = lattice_.at(i, j);
        if (ground_[c] && near[c] && taken(i, j)) out[c] = is_deck(i, j);
      }
    level_ = top_;
    for (int round = 0; round < growth; ++round) out = with_edges(out);
    return out;
  }

 private:
  int in_cells(double metres) const { return static_cast<int>(std::ceil(metres / lattice_.cell - 1e-9)); }

  /// Cells around which the surface may end: within the widest deck of a void of 3 x 3 cells or of a sheer fall.
  std::vector<std::uint8_t> near_edges() const {
    std::vector<std::uint8_t> out(lattice_.size(), 0);
    const float drop = static_cast<float>(std::max(fall_beside, 2.0 * sheer * lattice_.cell));
    for (int j = 1; j + 1 < lattice_.ny; ++j)
      for (int i = 1; i + 1 < lattice_.nx; ++i) {
        const size_t c = lattice_.at(i, j);
        bool empty = true, falls = false;
        for (int v = j - 1; v <= j + 1; ++v)
          for (int u = i - 1; u <= i + 1; ++u) {
            const float low = low_[lattice_.at(u, v)];
            empty = empty && std::isnan(low);
            falls = falls || (ground_[c] && top_[c] - low >= drop);
          }
        out[c] = empty || falls;
      }
    dilate(out, 1, static_cast<size_t>(lattice_.nx), lattice_.nx, lattice_.ny);
    dilate(out, static_cast<size_t>(lattice_.nx), 1, lattice_.ny, lattice_.nx);
    return out;
  }
  /// Along lines of n cells `step` apart, by the widest deck.
  void dilate(std::vector<std::uint8_t>& cells, size_t step, size_t next, int n, int lines) const {
    std::vector<std::uint8_t> line(static_cast<size_t>(n));
    for (int k = 0; k < lines; ++k) {
      std::uint8_t* at = cells.data() + static_cast<size_t>(k) * next;
      std::fill(line.begin(), line.end(), std::uint8_t{0});
      for (int q = 0, to = 0; q < n; ++q)
        if (at[static_cast<size_t>(q) * step])
          for (to = std::max(to, q - half_); to <= std::min(q + half_, n - 1); ++to) line[static_cast<size_t>(to)] = 1;
      for (int q = 0; q < n; ++q) at[static_cast<size_t>(q) * step] = line[static_cast<size_t>(q)];
    }
  }

  bool has_top(size_t c) const { return top_[c] == top_[c]; }

  /// With the cells beside them on their level that are not the bank's, and without those that lie alone.
  std::vector<std::uint8_t> with_edges(const std::vector<std::uint8_t>& decks) {
    std::vector<std::uint8_t> out = decks;
    for (int j = 1; j + 1 < lattice_.ny; ++j)
      for (int i = 1; i + 1 < lattice_.nx; ++i) {
        const size_t c = lattice_.at(i, j);
        int beside = 0;
        std::uint8_t axes = 0;
        float level = std::numeric_limits<float>::quiet_NaN(), narrow = 0.0f;
        for (int v = j - 1; v <= j + 1; ++v)
          for (int u = i - 1; u <= i + 1; ++u) {
            const size_t near = lattice_.at(u, v);
            if (near == c || !decks[near]) continue;
            ++beside;
            if (!(level_[near] >= level)) level = level_[near];
            narrow = std::max(narrow, narrow_[near]);
            axes = static_cast<std::uint8_t>(axes | axes_[near]);
          }
        if (decks[c]) out[c] = beside >= fewest_beside;
        if (decks[c] || beside < fewest_beside) continue;
        if (ground_[c]) is_strip(i, j, 0);  // makes open_ known
        if (ground_[c] && beside < around && ((open_[c] & axes) == 0 || is_wider(c, narrow)) && !is_end(i, j, axes, narrow)) continue;
        out[c] = 1;
        narrow_[c] = narrow, axes_[c] = axes;
        level_[c] = level;
      }
    return out;
  }

  /// Does a deck of these axes, `narrow` m wide, go on here between voids too narrow to begin one?
  bool is_end(int i, int j, std::uint8_t axes, float narrow) const {
    if (lattice_.cell > finest) return false;
    const int least = std::max(bare, in_cells(void_at_end));
    for (int axis = 0; axis < deck_directions / 2; ++axis) {
      if (!(axes >> axis & 1u)) continue;
      int right = 0, left = 0;
      if (side(i, j, (axis + deck_directions / 4) % deck_directions, right, least) != DeckSide::level &&
          side(i, j, (axis + 3 * deck_directions / 4) % deck_directions, left, least) != DeckSide::level &&
          (right + left + 1) * lattice_.cell <= static_cast<double>(narrow) + lattice_.cell)
        return true;
    }
    return false;
  }

  /// Cells from a place to returns in the direction; 0 where none are within `banks`.
  int to_returns(int i, int j, int direction) const {
    const std::vector<CellIndex>& to = ahead_[static_cast<size_t>(direction % deck_directions)];
    for (int k = 1; k <= in_cells(banks); ++k) {
      const CellIndex at = to[static_cast<size_t>(k)];
      if (lattice_.holds(i + at.i, j + at.j) && !std::isnan(low_[lattice_.at(i + at.i, j + at.j)])) return k;
    }
    return 0;
  }
  /// Is a void that begins at `first` cells in the direction and goes on to the `last` between two banks? Beyond the rim of the data are no
  /// returns, beyond a corner of it the sides part, and a notch in it has no banks further on.
  bool is_between_banks(int i, int j, int direction, int first, int last) const {
    const auto apart = [&](int k) {
      const CellIndex at = ahead_[static_cast<size_t>(direction)][static_cast<size_t>(k)];
      const int right = to_returns(i + at.i, j + at.j, direction + deck_directions / 4);
      const int left = to_returns(i + at.i, j + at.j, direction + 3 * deck_directions / 4);
      return right > 0 && left > 0 ? right + left : 0;
    };
    const int there = apart(last);
    const CellIndex end = ahead_[static_cast<size_t>(direction)][static_cast<size_t>(last)];
    const int ahead = to_returns(i + end.i, j + end.j, direction), far = std::min(last + in_cells(water_goes_on), reach_);
    if (there == 0 || ((ahead == 0 || ahead > in_cells(water_goes_on)) && apart(far) == 0)) return false;
    for (int k = first; 2 * k <= first + last; ++k)  // railings may stand in the first
      if (there <= apart(k) + parting * (last - k)) return true;
    return false;
  }

  /// Is the surface level up to its end, `last` cells on? Before the end of a bank it falls.
  bool is_sharp(int i, int j, int direction, int last) const {
    const auto cell = [&](int k) {
      const CellIndex to = ahead_[static_cast<size_t>(direction)][static_cast<size_t>(k)];
      return lattice_.at(i + to.i, j + to.j);
    };
    const float level = top_[cell(std::max(0, last - edge_cells))];
    for (int k = std::max(0, last - edge_cells + 1); k <= last; ++k)
      if (level - low_[cell(k)] > edge_fall) return false;
    return true;
  }

  /// What is beside the surface in a direction once it ends, and how many cells on that is. Open are `least_void` cells without returns.
  DeckSide side(int i, int j, int direction, int& last, int least_void) const {
    float z = top_[lattice_.at(i, j)];
    int void_cells = 0, first_void = 0;
    last = 0;
    for (int k = 1; k <= last + in_cells(hidden); ++k) {
      const CellIndex to = ahead_[static_cast<size_t>(direction)][static_cast<size_t>(k)];
      if (!lattice_.holds(i + to.i, j + to.j)) return DeckSide::level;  // unknown
      const size_t c = lattice_.at(i + to.i, j + to.j);
      const double run = (k - last) * lattice_.cell;
      if (has_top(c) && std::abs(top_[c] - z) <= deck_roughness + deck_grade * run) {
        z = top_[c], last = k, void_cells = 0;
        const double off = std::abs(static_cast<double>(z - top_[lattice_.at(i, j)]));
        if (last >= half_ || off > uneven + across * k * lattice_.cell) return DeckSide::level;
        continue;
      }
      if (std::isnan(low_[c])) {
        if (void_cells++ == 0) first_void = k;
        if (void_cells >= least_void)
          return is_sharp(i, j, direction, last) && is_between_banks(i, j, direction, first_void, k) ? DeckSide::open : DeckSide::level;
        continue;
      }
      if (!ground_[c] && low_[c] - z > near_rail) continue;  // a crown that overhangs shows neither bank nor water
      // Where nothing came back in between there is no bank.
      const double least =
          void_cells >= bare && lattice_.cell <= finest ? fall_beside : std::max(fall_beside, sheer * (run + lattice_.cell));
      if (static_cast<double>(z - low_[c]) >= least) return DeckSide::falls;
      const bool sliver = k == last + 1 && ground_[c] && top_[c] < z && lattice_.cell <= finest;
      if (ground_[c] && !sliver) return DeckSide::level;
      void_cells = 0;
    }
    return DeckSide::level;
  }

  /// Does the surface end on both sides of the axis `direction`, as wide as a deck between them, and least wide of all axes?
  bool is_strip(int i, int j, int axis) {
    const size_t c = lattice_.at(i, j);
    if (!known_[c]) {
      bool falls = false;
      std::array<double, deck_directions / 2> wide;
      for (int d = 0; d < deck_directions / 2; ++d) wide[static_cast<size_t>(d)] = width(i, j, d, falls);
      known_[c] = falls ? 2 : 1;
      const double least = *std::min_element(wide.begin(), wide.end());
      width_[c] = static_cast<float>(least);
      for (size_t d = 0; d < wide.size(); ++d)
        if (wide[d] < closed) open_[c] = static_cast<std::uint8_t>(open_[c] | 1u << d);
      for (size_t d = 0; d < wide.size(); ++d)
        if (wide[d] >= narrowest && wide[d] <= std::min(widest, oblique * least + lattice_.cell))
          strip_[c] = static_cast<std::uint8_t>(strip_[c] | 1u << d);
    }
    return strip_[c] >> axis & 1u;
  }
  /// `closed` where the surface goes on.
  double width(int i, int j, int axis, bool& falls) const {
    int right = 0, left = 0;
    const int least = std::max(open_cells, in_cells(wide_open));
    const DeckSide one = side(i, j, (axis + deck_directions / 4) % deck_directions, right, least);
    const DeckSide other = one == DeckSide::level ? one : side(i, j, (axis + 3 * deck_directions / 4) % deck_directions, left, least);
    if (other == DeckSide::level) return closed;
    falls = falls || one == DeckSide::falls || other == DeckSide::falls;
    return (right + left + 1) * lattice_.cell;
  }

  /// Cells of a way along the surface, of them with both sides open; ends where the ground goes on, maybe below stairs.
  struct Way {
    int cells = 0, strips = 0;
    bool has_stairs = false;
    float width = std::numeric_limits<float>::infinity();  ///< the least of these
  };
  std::optional<Way> way(int i, int j, int axis, int direction) {
    float z = top_[lattice_.at(i, j)];
    Way found;
    int last = 0, land = 0;
    bool falls = false;
    for (int k = 1; k <= reach_; ++k) {
      const CellIndex to = ahead_[static_cast<size_t>(direction)][static_cast<size_t>(k)];
      if (!lattice_.holds(i + to.i, j + to.j)) return std::nullopt;
      const size_t c = lattice_.at(i + to.i, j + to.j);
      const double run = (k - last) * lattice_.cell;
      if (!has_top(c) || std::abs(top_[c] - z) > deck_roughness + deck_grade * run) {
        // Where the water returns something, ground below may be the water itself.
        const bool lower = ground_[c] && top_[c] < z && static_cast<double>(z - top_[c]) <= stairs;
        if (lower && !found.has_stairs && !falls && run > lattice_.cell)
          found.has_stairs = true;
        else if (run > gap + lattice_.cell)
          return std::nullopt;
        else
          continue;
      }
      z = top_[c], last = k;
      if (is_strip(i + to.i, j + to.j, axis)) {
        if (found.has_stairs) return std::nullopt;
        found = {k, found.strips + 1, false, std::min(found.width, width_[c])};
        falls = falls || known_[c] == 2;
        land = 0;
      } else {
        land += !(open_[c] >> axis & 1u);
        if ((k - found.cells) * lattice_.cell >= bank_length) return land * 2 > k - found.cells ? std::optional(found) : std::nullopt;
      }
    }
    return std::nullopt;
  }

  /// Land between two waters widens from the deck on.
  bool is_wider(size_t c, float narrow) const {
    return static_cast<double>(width_[c]) > wedge * static_cast<double>(narrow) + lattice_.cell;
  }

  bool is_deck(int i, int j) {
    for (int axis = 0; axis < deck_directions / 2; ++axis) {
      if (!is_strip(i, j, axis)) continue;
      const auto one = way(i, j, axis, axis);
      if (!one) continue;
      const auto other = way(i, j, axis, axis + deck_directions / 2);
      if (!other || (one->has_stairs && other->has_stairs)) continue;
      const int cells = one->cells + other->cells + 1, strips = one->strips + other->strips + 1;
      const double length = cells * lattice_.cell;
      const float narrow = std::min(one->width, other->width);
      if (length < shortest_deck || length > reach_ * lattice_.cell - bank_length || strips < share_open * cells ||
          is_wider(lattice_.at(i, j), narrow))
        continue;
      narrow_[lattice_.at(i, j)] = narrow;
      axes_[lattice_.at(i, j)] = static_cast<std::uint8_t>(1u << axis);
      return true;
    }
    return false;
  }

  core::Lattice lattice_;
  std::vector<float> top_, low_;      ///< m, as in the block; NaN where none
  std::vector<float> level_;          ///< m, as top_, and in the cells beside a deck its level
  std::vector<std::uint8_t> ground_;  ///< per cell: its top is ground
  std::vector<std::uint8_t> known_;   ///< per cell: 1 strip_ is known, 2 and the surface falls off to returns below
  std::vector<std::uint8_t> open_;    ///< per cell: bits of the axes on both sides of which the surface ends
  std::vector<std::uint8_t> axes_;    ///< per cell of a deck: the bit of its axis
  std::vector<std::uint8_t> strip_;   ///< per cell: bits of the axes along which it is a strip
  std::vector<float> width_;          ///< m, per cell: least between its edges
  std::vector<float> narrow_;         ///< m, per cell of a deck: least of the deck
  int half_, reach_;                  ///< cells
  std::array<std::vector<CellIndex>, deck_directions> ahead_;
};

/// Is return p a railing or parapet at the side of a deck?
bool is_rail(const Cells& cells, const std::vector<std::uint8_t>& deck, const core::Block& b, size_t p, const CellIndex& at) {
  const core::Lattice& l = cells.lattice();
  if (b.classification[p] == core::point_class::ground) return false;
  for (int v = std::max(at.j - 1, 0); v <= std::min(at.j + 1, l.ny - 1); ++v)
    for (int u = std::max(at.i - 1, 0); u <= std::min(at.i + 1, l.nx - 1); ++u) {
      const size_t near = l.at(u, v);
      if (!deck[near] || !cells.has_ground(near)) continue;
      const double east = std::abs(b.origin.x() + b.x[p] - l.centre_x(u)), north = std::abs(b.origin.y() + b.y[p] - l.centre_y(v));
      const float level = cells.top(near), above = static_cast<float>(b.z[p]) - level;
      if (std::max(east, north) <= 0.5 * l.cell + rail_reach && above >= -near_deck && above <= near_rail && cells.is_edge(at, level))
        return true;
    }
  return false;
}

}  // namespace

double ground_decks_halo(double longest) {
  return Districts::halo() +
         std::max(std::hypot(longest + bank_length + banks, widest + hidden + water_goes_on),
                  std::hypot(longest + bank_length, widest + hidden + banks)) +
         (growth + 3 + deck_heights_reach) * sample_sides.back();
}

std::vector<std::uint8_t> ground_decks(const core::Block& b, const Districts& where, double longest, size_t own) {
  std::vector<std::uint8_t> out(b.size(), 0);
  for (size_t level = 0; level < sample_sides.size(); ++level) {
    if (std::find(where.side.begin(), where.side.end(), level) == where.side.end()) continue;
    Cells cells(b, sample_sides[level], longest);
    const core::Lattice& l = cells.lattice();
    const OwnBox needed(b, own, (growth + 2) * l.cell);
    const std::vector<std::uint8_t> deck =
        cells.decks([&](int i, int j) { return needed.touches(l, i, j) && where.side_at(l.centre_x(i), l.centre_y(j)) == level; });
    if (std::find(deck.begin(), deck.end(), 1) == deck.end()) continue;
    for (size_t p = 0; p < own; ++p) {
      const CellIndex at = cell_of(l, b, p);
      const size_t c = l.at(at.i, at.j);
      const bool is_on_deck = deck[c] && std::abs(static_cast<float>(b.z[p]) - cells.top(c)) <= near_deck;
      out[p] = out[p] || is_on_deck || is_rail(cells, deck, b, p, at);
    }
  }
  return out;
}

}  // namespace swath::filters
