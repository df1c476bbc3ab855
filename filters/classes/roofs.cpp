// SPDX-License-Identifier: GPL-3.0-or-later
#include "filters/classes/roofs.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace swath::filters {
namespace {

constexpr float part_link = 0.4f;     // m from cell to cell where small planes join large ones
constexpr float roof_link = 2.0f;     // m from cell to cell of one roof
constexpr int roof_growth = 2;        // links from large planes to the small ones beside them
constexpr int fewest_around = 4;      // roof cells around a gap of a roof
constexpr double share_around = 0.7;  // of the cells around it that hold returns off the ground
constexpr double search_sides = 3.0;  // of the square of the least area, on each side of a cell

int search_radius(double side) { return static_cast<int>(std::ceil(search_sides * side / structure_cell)); }

class Roofs {
 public:
  Roofs(const StructureCells& cells, const std::vector<std::uint8_t>& decks, const Districts& where, const RoofLimits& limits)
      : cells_(cells), lattice_(cells.lattice), decks_(decks), where_(where), limits_(limits) {}

  std::vector<float> heights(const std::vector<std::uint8_t>& standing) const {
    std::vector<std::uint8_t> roof = large_enough();
    const auto link = [&](size_t from) {
      return Districts::link(where_.side_at(lattice_.centre_x(static_cast<int>(from % static_cast<size_t>(lattice_.nx))),
                                            lattice_.centre_y(static_cast<int>(from / static_cast<size_t>(lattice_.nx)))));
    };
    spread(cells_, roof, roof_growth, link, [this](size_t from, size_t to, int) { return is_linked(from, to, part_link); });
    std::vector<float> height(lattice_.size(), std::numeric_limits<float>::quiet_NaN());
    for (size_t k = 0; k < roof.size(); ++k)
      if (roof[k]) height[k] = cells_.plane[k];
    fill(standing, height);
    return height;
  }

 private:
  bool is_roof(size_t c) const { return cells_.has_plane(c) && static_cast<double>(cells_.height[c]) >= limits_.height && !decks_[c]; }
  bool is_linked(size_t from, size_t to, float step) const {
    return is_roof(to) && std::abs(cells_.plane[from] - cells_.plane[to]) <= step;
  }

  /// Cells with wide planes among enough linked ones.
  std::vector<std::uint8_t> large_enough() const {
    const double side = limits_.side / structure_cell;
    const int radius = search_radius(limits_.side);
    const auto linked = [this](size_t from, size_t to) { return cells_.kind[to] == Planar::wide && is_linked(from, to, roof_link); };
    const auto samples_at = [this](int i, int j) { return where_.side_at(lattice_.centre_x(i), lattice_.centre_y(j)); };
    std::vector<std::uint8_t> out(lattice_.size(), 0);
    Growth growth(lattice_, radius);
    for (int j = 0; j < lattice_.ny; ++j)
      for (int i = 0; i < lattice_.nx; ++i) {
        const size_t c = lattice_.at(i, j);
        if (out[c] || cells_.kind[c] != Planar::wide || !is_roof(c)) continue;
        const std::uint8_t samples = samples_at(i, j);
        const auto wanted = static_cast<size_t>(std::ceil(side * side * Districts::occupied(samples)));
        const std::vector<CellIndex>& found = growth.from(i, j, Districts::link(samples), wanted, linked);
        if (found.size() < wanted) continue;
        out[c] = 1;
        // Links lead both ways: the others found are as many from where they are, if that is within their squares.
        const auto [west, east] = std::minmax_element(found.begin(), found.end(), [](CellIndex a, CellIndex o) { return a.i < o.i; });
        const auto [south, north] = std::minmax_element(found.begin(), found.end(), [](CellIndex a, CellIndex o) { return a.j < o.j; });
        if (east->i - west->i > radius || north->j - south->j > radius) continue;
        for (const CellIndex& at : found)
          if (samples_at(i + at.i, j + at.j) == samples) out[lattice_.at(i + at.i, j + at.j)] = 1;
      }
    return out;
  }

  /// Takes in the cells with returns off the ground that have roofs nearly all around.
  void fill(const std::vector<std::uint8_t>& standing, std::vector<float>& height) const {
    const auto is_roof_at = [&](size_t c) { return height[c] == height[c]; };
    std::vector<std::pair<size_t, float>> filled;
    for (int j = 0; j < lattice_.ny; ++j)
      for (int i = 0; i < lattice_.nx; ++i) {
        const size_t c = lattice_.at(i, j);
        if (!standing[c] || is_roof_at(c) || decks_[c]) continue;
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
};

}  // namespace

double roof_cells_halo(double side) {
  return (search_radius(side) + roof_growth * Districts::link(sample_sides.size() - 1) + 2 * structure_link + 1) * structure_cell;
}

std::vector<float> roof_cells(const StructureCells& cells, const std::vector<std::uint8_t>& standing,
                              const std::vector<std::uint8_t>& decks, const Districts& where, const RoofLimits& limits) {
  return Roofs(cells, decks, where, limits).heights(standing);
}

}  // namespace swath::filters
