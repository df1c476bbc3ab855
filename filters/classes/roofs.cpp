// SPDX-License-Identifier: GPL-3.0-or-later
#include "filters/classes/roofs.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

namespace swath::filters {
namespace {

constexpr float part_link = 0.4f;       // m from cell to cell where small planes join large ones
constexpr float roof_link = 2.0f;       // m from cell to cell of one roof
constexpr int roof_growth = 2;          // links from large planes to the small ones beside them
constexpr double low_share = 0.75;      // of the least height: of what goes on from a roof at its level
constexpr int low_growth = 8;           // links
constexpr int fewest_around = 4;        // roof cells around a gap of a roof
constexpr double share_around = 0.7;    // of the cells around it that hold returns off the ground
constexpr double search_sides = 3.0;    // of the square of the least area, on each side of a cell
constexpr double widest_vehicle = 2.6;  // m: EU directive 96/53 allows 2.55 m, refrigerated bodies 2.60 m
constexpr size_t large = 8;             // times the least area: what is larger is a roof whatever its form
constexpr int rim_gap = 3;              // cells

int search_radius(double side) { return static_cast<int>(std::ceil(search_sides * side / structure_cell)); }

class Roofs {
 public:
  Roofs(const StructureCells& cells, const std::vector<std::uint8_t>& decks, const Districts& where, const RoofLimits& limits)
      : cells_(cells), lattice_(cells.lattice), decks_(decks), where_(where), limits_(limits), part_(cells.lattice.size(), Part::none) {
    for (size_t c = 0; c < part_.size(); ++c)
      if (cells_.has_plane(c) && static_cast<double>(cells_.height[c]) >= limits_.height && !decks_[c])
        part_[c] = cells_.kind[c] == Planar::wide ? Part::wide : Part::some;
  }

  std::vector<float> heights(const std::vector<std::uint8_t>& standing, const OwnBox& begun) const {
    std::vector<std::uint8_t> roof = large_enough(begun);
    const auto link = [&](size_t from) {
      return Districts::link(where_.side_at(lattice_.centre_x(static_cast<int>(from % static_cast<size_t>(lattice_.nx))),
                                            lattice_.centre_y(static_cast<int>(from / static_cast<size_t>(lattice_.nx)))));
    };
    const auto goes_on = [this](size_t from, size_t to, int) {
      return cells_.kind[to] == Planar::wide && !decks_[to] && is_near(from, to, part_link) &&
             static_cast<double>(cells_.height[to]) >= low_share * limits_.height;
    };
    spread(
        cells_, roof, low_growth, [](size_t) { return structure_link; }, goes_on);
    spread(cells_, roof, roof_growth, link,
           [this](size_t from, size_t to, int) { return part_[to] != Part::none && is_near(from, to, part_link); });
    std::vector<float> height(lattice_.size(), std::numeric_limits<float>::quiet_NaN());
    for (size_t k = 0; k < roof.size(); ++k)
      if (roof[k]) height[k] = cells_.plane[k];
    fill(standing, height, begun);
    return height;
  }

 private:
  /// What a cell may be of a roof: high enough and no deck.
  enum class Part : std::uint8_t { none, some, wide };

  bool is_near(size_t from, size_t to, float step) const { return std::abs(cells_.plane[from] - cells_.plane[to]) <= step; }

  enum class Verdict : std::uint8_t { unknown, no, yes };

  /// The cells of one growth, as offsets from where it began.
  struct Extent {
    int west = 0, east = 0, south = 0, north = 0;
    explicit Extent(const std::vector<CellIndex>& found) {
      for (const CellIndex& at : found)
        west = std::min(west, at.i), east = std::max(east, at.i), south = std::min(south, at.j), north = std::max(north, at.j);
    }
    /// Do all lie within `reach` cells of one of them in both directions?
    bool is_within(CellIndex at, int reach) const {
      return std::max(east - at.i, at.i - west) <= reach && std::max(north - at.j, at.j - south) <= reach;
    }
  };

  /// Cells with wide planes among enough linked ones, of those that `begun` touches.
  std::vector<std::uint8_t> large_enough(const OwnBox& begun) const {
    const double side = limits_.side / structure_cell;
    const int radius = search_radius(limits_.side);
    const auto linked = [this](size_t from, size_t to) { return is_near(from, to, roof_link); };
    const auto samples_at = [this](int i, int j) { return where_.side_at(lattice_.centre_x(i), lattice_.centre_y(j)); };
    std::vector<Verdict> verdict(lattice_.size(), Verdict::unknown);
    Growth growth(lattice_, radius, [this](size_t c) { return part_[c] == Part::wide; });
    for (int j = 0; j < lattice_.ny; ++j)
      for (int i = 0; i < lattice_.nx; ++i) {
        const size_t c = lattice_.at(i, j);
        if (verdict[c] != Verdict::unknown || part_[c] != Part::wide || !begun.touches(lattice_, i, j)) continue;
        const std::uint8_t samples = samples_at(i, j);
        const int link = Districts::link(samples);
        const auto wanted = static_cast<size_t>(std::ceil(side * side * Districts::occupied(samples)));
        const std::vector<CellIndex>& found = growth.from(i, j, link, large * wanted, linked);
        const bool is_large = found.size() >= large * wanted;
        const Extent extent(found);
        const Verdict here = is_large || (found.size() >= wanted && !is_narrow(i, j, found, extent)) ? Verdict::yes : Verdict::no;
        verdict[c] = here;
        // Links lead both ways: the others find the same from where they are, if the end of it is within this square and all of it within
        // theirs; of what is large enough whatever its form, as much.
        if (!is_large && !extent.is_within({0, 0}, radius - link)) continue;
        for (const CellIndex& at : found)
          if (extent.is_within(at, radius) && samples_at(i + at.i, j + at.j) == samples) verdict[lattice_.at(i + at.i, j + at.j)] = here;
      }
    std::vector<std::uint8_t> out(verdict.size());
    std::transform(verdict.begin(), verdict.end(), out.begin(), [](Verdict v) { return v == Verdict::yes; });
    return out;
  }

  /// Do the planes of these cells stand alone and are they no wider than a vehicle? Not where they may go on beyond the data, nor where
  /// they lean on a higher roof.
  bool is_narrow(int i, int j, const std::vector<CellIndex>& found, const Extent& extent) const {
    constexpr double cm = 100.0;
    double n = 0, x = 0, y = 0, xx = 0, xy = 0, yy = 0;
    for (const CellIndex& at : found) {
      if (is_at_rim(i + at.i, j + at.j) || is_beside_roof(i + at.i, j + at.j)) return false;
      const PlanarSums& s = cells_.sums[lattice_.at(i + at.i, j + at.j)];
      const double west = cm * structure_cell * (at.i - extent.west), south = cm * structure_cell * (at.j - extent.south);
      n += s.n, x += s.x + s.n * west, y += s.y + s.n * south;
      xx += s.xx + west * (2.0 * s.x + s.n * west), yy += s.yy + south * (2.0 * s.y + s.n * south);
      xy += s.xy + west * s.y + south * s.x + s.n * west * south;
    }
    xx = xx / n - x / n * (x / n), yy = yy / n - y / n * (y / n), xy = xy / n - x / n * (y / n);
    const double least = 0.5 * (xx + yy) - std::hypot(0.5 * (xx - yy), xy);
    return std::sqrt(12.0 * std::max(0.0, least)) <= cm * widest_vehicle;  // of a rectangle
  }

  bool is_beside_roof(int i, int j) const {
    const size_t c = lattice_.at(i, j);
    for (int v = std::max(j - 1, 0); v <= std::min(j + 1, lattice_.ny - 1); ++v)
      for (int u = std::max(i - 1, 0); u <= std::min(i + 1, lattice_.nx - 1); ++u)
        if (const size_t near = lattice_.at(u, v); part_[near] == Part::wide && cells_.plane[near] > cells_.plane[c] + roof_link)
          return true;
    return false;
  }

  /// Is there nothing for rim_gap cells in one of the four directions?
  bool is_at_rim(int i, int j) const {
    for (const auto& [di, dj] : std::array<std::pair<int, int>, 4>{{{1, 0}, {-1, 0}, {0, 1}, {0, -1}}}) {
      bool empty = true;
      for (int k = 1; k <= rim_gap && empty; ++k) {
        const int u = i + k * di, v = j + k * dj;
        empty = u < 0 || v < 0 || u >= lattice_.nx || v >= lattice_.ny || std::isnan(cells_.low[lattice_.at(u, v)]);
      }
      if (empty) return true;
    }
    return false;
  }

  /// Takes in the cells with returns off the ground that have roofs nearly all around.
  void fill(const std::vector<std::uint8_t>& standing, std::vector<float>& height, const OwnBox& begun) const {
    const auto is_roof_at = [&](size_t c) { return height[c] == height[c]; };
    std::vector<std::pair<size_t, float>> filled;
    for (int j = 0; j < lattice_.ny; ++j)
      for (int i = 0; i < lattice_.nx; ++i) {
        const size_t c = lattice_.at(i, j);
        if (!standing[c] || is_roof_at(c) || decks_[c] || !begun.touches(lattice_, i, j)) continue;
        int others = 0, roofs = 0;
        float highest = -std::numeric_limits<float>::infinity();
        for (int v = std::max(j - structure_link, 0); v <= std::min(j + structure_link, lattice_.ny - 1); ++v)
          for (int u = std::max(i - structure_link, 0); u <= std::min(i + structure_link, lattice_.nx - 1); ++u) {
            const size_t near = lattice_.at(u, v);
            if (near == c || !standing[near]) continue;
            ++others;
            if (!is_roof_at(near)) continue;
            ++roofs;
            highest = std::max(highest, height[near]);
          }
        if (roofs >= fewest_around && static_cast<double>(roofs) >= share_around * static_cast<double>(others))
          filled.emplace_back(c, highest);
      }
    for (const auto& [c, h] : filled) height[c] = h;
  }

  const StructureCells& cells_;
  const core::Lattice& lattice_;
  const std::vector<std::uint8_t>& decks_;
  const Districts& where_;
  RoofLimits limits_;
  std::vector<Part> part_;  ///< per cell
};

}  // namespace

double roof_spread() {
  return (low_growth * structure_link + roof_growth * Districts::link(sample_sides.size() - 1) + structure_link) * structure_cell;
}

double roof_cells_halo(double side) { return roof_spread() + (search_radius(side) + structure_link + rim_gap + 1) * structure_cell; }

std::vector<float> roof_cells(const StructureCells& cells, const std::vector<std::uint8_t>& standing,
                              const std::vector<std::uint8_t>& decks, const Districts& where, const RoofLimits& limits,
                              const OwnBox& begun) {
  return Roofs(cells, decks, where, limits).heights(standing, begun);
}

}  // namespace swath::filters
