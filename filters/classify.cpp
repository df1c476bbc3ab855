// SPDX-License-Identifier: GPL-3.0-or-later
// Classes: ASPRS LAS 1.4 R15, table 17. Order of the decisions as in the usual chains of rules (Vosselman & Maas 2010, "Airborne and
// terrestrial laser scanning", ch. 4): planes first, of these decks before roofs, then lines, and what has neither is vegetation.
// The steps and their deviations: roof_planes, structure_cells, bridges, building_sides, wires.
#include "filters/classify.h"

#include <algorithm>
#include <cmath>

#include "filters/bridges.h"
#include "filters/building_sides.h"
#include "filters/roof_planes.h"
#include "filters/structure_cells.h"
#include "filters/wires.h"

namespace swath::filters {
namespace {

namespace cls = core::point_class;

constexpr float least_plane_height = 1.0f;  // m above ground: a deck near its ends
constexpr float above_roof = 1.0f;          // m: chimneys and what else stands on a roof
constexpr float beside_deck = 0.5f;         // m above or below a deck: kerbs, rails
constexpr double roof_link_grade = 2.0;     // rise / run from cell to cell of one roof
constexpr double search_sides = 3.0;        // of the square of the least area, on each side of a cell

bool is_free(const core::Block& b, size_t p) {
  return core::is_usable(b, p) && b.classification[p] != cls::ground && b.classification[p] != cls::water;
}

/// A filter found it alone in space; a thin wire's returns may be.
bool is_isolated(const core::Block& b, size_t p) {
  return b.classification[p] == cls::high_noise && !b.flags.empty() && (b.flags[p] & core::flag::isolated) &&
         !(b.flags[p] & core::flag::withheld);
}

int search_radius(const ClassifyOptions& o) { return static_cast<int>(std::ceil(search_sides * o.building_side.value / structure_cell)); }

/// Cells of roofs that are high and large enough.
std::vector<std::uint8_t> building_cells(const StructureCells& cells, const std::vector<Deck>& decks, const ClassifyOptions& o) {
  const core::Lattice& l = cells.lattice;
  const auto is_roof = [&](size_t c) {
    return cells.has_plane(c) && static_cast<double>(cells.height[c]) >= o.building_height.value && decks[c] == Deck::none;
  };
  const auto linked = [&](size_t from, size_t to) {
    return is_roof(to) && std::abs(cells.plane[from] - cells.plane[to]) <= roof_link_grade * structure_link * structure_cell;
  };
  const int wanted = static_cast<int>(std::ceil(o.building_side.value * o.building_side.value / (structure_cell * structure_cell)));
  std::vector<std::uint8_t> out(l.size(), 0);
  for (int j = 0; j < l.ny; ++j)
    for (int i = 0; i < l.nx; ++i)
      if (is_roof(l.at(i, j))) out[l.at(i, j)] = grow(l, i, j, search_radius(o), linked, [&](size_t, int n) { return n >= wanted; });
  return out;
}

std::uint8_t vegetation(float height, const ClassifyOptions& o) {
  if (!(height > 0.0f)) return cls::unassigned;
  const auto h = static_cast<double>(height);
  return h < o.medium_vegetation.value ? cls::low_vegetation : h < o.high_vegetation.value ? cls::medium_vegetation : cls::high_vegetation;
}

}  // namespace

double halo(const ClassifyOptions& o) {
  const double decks = o.bridge_length.value > 0.0 ? deck_cells_halo(o.bridge_length.value) : 0.0;
  const double structures = planar_points_halo() + decks + (search_radius(o) + structure_link + 1) * structure_cell;
  return std::max(structures + building_sides_halo(), planar_points_halo() + wire_points_halo());
}

ClassifyCounts classify(core::Block& b, size_t own, const ClassifyOptions& o) {
  ClassifyCounts n;
  std::vector<std::uint8_t> raised(b.size(), 0), high(b.size(), 0);
  for (size_t p = 0; p < b.size(); ++p) raised[p] = is_free(b, p) && b.height[p] >= least_plane_height;
  const std::vector<std::uint8_t> planar = planar_points(b, raised, o.roughness.value);
  const StructureCells cells = structure_cells(b, planar);
  const std::vector<Deck> decks = o.bridge_length.value > 0.0
                                      ? deck_cells(cells, o.bridge_length.value, o.building_height.value, o.building_height.value)
                                      : std::vector<Deck>(cells.lattice.size(), Deck::none);
  const std::vector<std::uint8_t> buildings = building_cells(cells, decks, o);
  for (size_t p = 0; p < b.size(); ++p)
    high[p] = ((raised[p] && !planar[p]) || is_isolated(b, p)) && static_cast<double>(b.height[p]) >= o.wire_height.value;
  const std::vector<std::uint8_t> wires = wire_points(b, high, planar);

  std::vector<std::uint8_t> roof(b.size(), 0), free(b.size(), 0);
  for (size_t p = 0; p < b.size(); ++p) {
    if (!is_free(b, p)) continue;
    const CellIndex at = cell_of(cells.lattice, b, p);
    const size_t c = cells.lattice.at(at.i, at.j);
    roof[p] = planar[p] && buildings[c];
    free[p] = decks[c] != Deck::deck;
  }
  const std::vector<std::uint8_t> sides = building_sides(b, roof, free, o.roughness.value);

  const auto class_of = [&](size_t p) {
    const CellIndex at = cell_of(cells.lattice, b, p);
    const size_t c = cells.lattice.at(at.i, at.j);
    const float above = static_cast<float>(b.z[p]) - cells.plane[c];  // NaN: no plane there
    if (raised[p] && decks[c] == Deck::deck && (planar[p] || std::abs(above) <= beside_deck)) return cls::bridge_deck;
    if (sides[p] || (raised[p] && buildings[c] && above <= above_roof)) return cls::building;
    if (wires[p]) return cls::wire;
    return planar[p] ? cls::unassigned : vegetation(b.height[p], o);
  };
  for (size_t p = 0; p < own; ++p) {
    if (wires[p] && is_isolated(b, p)) {
      b.flags[p] = static_cast<std::uint16_t>(b.flags[p] & ~core::flag::isolated);
    } else if (!is_free(b, p)) {
      ++n.kept;
      continue;
    }
    const std::uint8_t c = b.classification[p] = class_of(p);
    n.low_vegetation += c == cls::low_vegetation;
    n.medium_vegetation += c == cls::medium_vegetation;
    n.high_vegetation += c == cls::high_vegetation;
    n.building += c == cls::building;
    n.wire += c == cls::wire;
    n.bridge_deck += c == cls::bridge_deck;
    n.unassigned += c == cls::unassigned;
  }
  return n;
}

}  // namespace swath::filters
