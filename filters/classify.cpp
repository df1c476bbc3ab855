// SPDX-License-Identifier: GPL-3.0-or-later
// Classes: ASPRS LAS 1.4 R15, table 17. Order of the decisions as in the usual chains of rules (Vosselman & Maas 2010, "Airborne and
// terrestrial laser scanning", ch. 4): planes first, of these decks before roofs, then lines, and what has neither is vegetation.
// The steps and their deviations: roof_planes, structure_cells, bridges, building_sides, wires.
#include "filters/classify.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "filters/bridges.h"
#include "filters/building_sides.h"
#include "filters/roof_planes.h"
#include "filters/structure_cells.h"
#include "filters/wires.h"

namespace swath::filters {
namespace {

namespace cls = core::point_class;

constexpr float least_plane_height = 1.0f;  // m above ground: a deck near its ends
constexpr float above_roof = 1.5f;          // m: chimneys, parapets and what else stands on a roof
constexpr float beside_deck = 0.5f;         // m above or below a deck: kerbs, rails
constexpr float part_link = 0.4f;           // m from cell to cell where small planes join large ones
constexpr float roof_link = 2.0f;           // m from cell to cell of one roof
constexpr double widest_needed = 9.0;       // m2 of one plane: larger roofs may have several
constexpr int roof_growth = 2;              // links from large planes to the small ones beside them
constexpr int fewest_around = 4;            // roof cells around a gap of a roof
constexpr double share_around = 0.7;        // of the cells around it that hold returns off the ground
constexpr float below_ground = 1.0f;        // m: returns deeper than this may be noise
constexpr double below_reach = 2.25;        // m: the widest radius in which ground is looked for beside them
constexpr double ground_beside = 0.25;      // of the last returns there
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

double wide_area(const ClassifyOptions& o) { return std::min(o.building_side.value * o.building_side.value, widest_needed); }

/// Cells of roofs that are high and large enough; NaN elsewhere, the height of the roof there.
class Roofs {
 public:
  Roofs(const core::Block& b, const StructureCells& cells, const std::vector<std::uint8_t>& decks, const Districts& where,
        const ClassifyOptions& o)
      : cells_(cells), decks_(decks), options_(o), height_(cells.lattice.size(), std::numeric_limits<float>::quiet_NaN()) {
    std::vector<std::uint8_t> roof = large_enough(where);
    const auto link = [&](size_t from) {
      const core::Lattice& l = cells.lattice;
      return Districts::link(where.side_at(l.centre_x(static_cast<int>(from % static_cast<size_t>(l.nx))),
                                           l.centre_y(static_cast<int>(from / static_cast<size_t>(l.nx)))));
    };
    spread(cells, roof, roof_growth, link, [this](size_t from, size_t to, int) { return is_linked(from, to, part_link); });
    for (size_t k = 0; k < roof.size(); ++k)
      if (roof[k]) height_[k] = cells.plane[k];
    fill(b);
  }
  const std::vector<float>& height() const { return height_; }

 private:
  bool is_roof(size_t c) const {
    return cells_.has_plane(c) && static_cast<double>(cells_.height[c]) >= options_.building_height.value && !decks_[c];
  }
  bool is_linked(size_t from, size_t to, float step) const {
    return is_roof(to) && std::abs(cells_.plane[from] - cells_.plane[to]) <= step;
  }

  /// Cells with wide planes among enough linked ones.
  std::vector<std::uint8_t> large_enough(const Districts& where) const {
    const core::Lattice& l = cells_.lattice;
    const double side = options_.building_side.value / structure_cell;
    const auto linked = [this](size_t from, size_t to) { return cells_.kind[to] == Planar::wide && is_linked(from, to, roof_link); };
    std::vector<std::uint8_t> out(l.size(), 0);
    for (int j = 0; j < l.ny; ++j)
      for (int i = 0; i < l.nx; ++i) {
        const size_t c = l.at(i, j);
        if (!is_roof(c) || cells_.kind[c] != Planar::wide) continue;
        const std::uint8_t samples = where.side_at(l.centre_x(i), l.centre_y(j));
        const int wanted = static_cast<int>(std::ceil(side * side * Districts::occupied(samples)));
        out[c] = grow(l, i, j, search_radius(options_), Districts::link(samples), linked, [wanted](size_t, int n) { return n >= wanted; });
      }
    return out;
  }

  /// Takes in the cells with returns off the ground that have roofs nearly all around.
  void fill(const core::Block& b) {
    const core::Lattice& l = cells_.lattice;
    std::vector<std::uint8_t> raised(l.size(), 0);
    for (size_t p = 0; p < b.size(); ++p)
      if (is_free(b, p) && b.height[p] >= least_plane_height) {
        const CellIndex at = cell_of(l, b, p);
        raised[l.at(at.i, at.j)] = 1;
      }
    std::vector<std::pair<size_t, float>> filled;
    for (int j = 0; j < l.ny; ++j)
      for (int i = 0; i < l.nx; ++i) {
        const size_t c = l.at(i, j);
        if (!raised[c] || has_height(c) || decks_[c]) continue;
        int others = 0, roofs = 0;
        float highest = -std::numeric_limits<float>::infinity();
        for (int dj = -structure_link; dj <= structure_link; ++dj)
          for (int di = -structure_link; di <= structure_link; ++di) {
            if (!l.holds(i + di, j + dj) || !raised[l.at(i + di, j + dj)] || (di == 0 && dj == 0)) continue;
            const size_t near = l.at(i + di, j + dj);
            ++others;
            if (!has_height(near)) continue;
            ++roofs;
            highest = std::max(highest, height_[near]);
          }
        if (roofs >= fewest_around && static_cast<double>(roofs) >= share_around * static_cast<double>(others))
          filled.emplace_back(c, highest);
      }
    for (const auto& [c, height] : filled) height_[c] = height;
  }
  bool has_height(size_t c) const { return height_[c] == height_[c]; }

  const StructureCells& cells_;
  const std::vector<std::uint8_t>& decks_;
  const ClassifyOptions& options_;
  std::vector<float> height_;
};

std::uint8_t vegetation(float height, const ClassifyOptions& o) {
  if (!(height > 0.0f)) return cls::unassigned;
  const auto h = static_cast<double>(height);
  return h < o.medium_vegetation.value ? cls::low_vegetation : h < o.high_vegetation.value ? cls::medium_vegetation : cls::high_vegetation;
}

/// Returns that lie deep below ground returns among which they are scattered: echoes on detours. In a pit there is no ground beside them.
class Below {
 public:
  Below(const core::Block& b, const Districts& where)
      : block_(b),
        where_(where),
        last_(b, below_reach, 0, [&b, any = any_deep(b)](size_t p) { return any && core::is_usable(b, p) && core::is_last_return(b, p); }) {
  }

  bool is_noise(size_t p) const {
    if (!(block_.height[p] <= -below_ground)) return false;
    const CellIndex d = cell_of(where_.lattice, block_, p), c = cell_of(last_.lattice(), block_, p);
    const double radius = 0.75 * sample_sides[where_.side[where_.lattice.at(d.i, d.j)]];
    int all = 0, ground = 0;
    for (int dj = -1; dj <= 1; ++dj)
      for (int di = -1; di <= 1; ++di) {
        if (!last_.lattice().holds(c.i + di, c.j + dj)) continue;
        const auto points = last_.in(c.i + di, c.j + dj);
        const auto rows = last_.rows(c.i + di, c.j + dj);
        for (size_t k = 0; k < points.size(); ++k) {
          const double x = points[k].x - block_.x[p], y = points[k].y - block_.y[p];
          if (x * x + y * y > radius * radius || rows[k] == p) continue;
          ++all;
          ground += block_.classification[rows[k]] == cls::ground && points[k].z - block_.z[p] >= static_cast<double>(below_ground);
        }
      }
    return ground > 0 && static_cast<double>(ground) >= ground_beside * static_cast<double>(all);
  }

 private:
  static bool any_deep(const core::Block& b) {
    return std::any_of(b.height.begin(), b.height.end(), [](float h) { return h <= -below_ground; });
  }

  const core::Block& block_;
  const Districts& where_;
  Bins last_;
};

}  // namespace

double halo(const ClassifyOptions& o) {
  const double decks = o.bridge_length.value > 0.0 ? deck_cells_halo(o.bridge_length.value) : 0.0;
  const double roofs = search_radius(o) + roof_growth * Districts::link(sample_sides.size() - 1) + 2 * structure_link + 1;
  const double structures = planar_points_halo() + decks + roofs * structure_cell;
  return std::max(structures + building_sides_halo(), planar_points_halo() + wire_points_halo());
}

ClassifyCounts classify(core::Block& b, size_t own, const ClassifyOptions& o) {
  ClassifyCounts n;
  std::vector<std::uint8_t> available(b.size(), 0), raised(b.size(), 0), high(b.size(), 0), surface(b.size(), 0);
  for (size_t p = 0; p < b.size(); ++p) {
    available[p] = is_free(b, p);
    raised[p] = available[p] && b.height[p] >= least_plane_height;
  }
  const Districts where = districts(b);
  const std::vector<Planar> planar = planar_points(b, available, where, o.roughness.value, wide_area(o));
  const StructureCells cells = structure_cells(b, planar);
  const std::vector<std::uint8_t> decks = o.bridge_length.value > 0.0 ? deck_cells(cells, {o.bridge_length.value, o.building_height.value})
                                                                      : std::vector<std::uint8_t>(cells.lattice.size(), 0);
  const Roofs roofs(b, cells, decks, where, o);
  for (size_t p = 0; p < b.size(); ++p) {
    surface[p] = raised[p] && planar[p] != Planar::none;
    high[p] = ((raised[p] && planar[p] == Planar::none) || is_isolated(b, p)) && static_cast<double>(b.height[p]) >= o.wire_height.value;
  }
  const std::vector<std::uint8_t> wires = wire_points(b, high, surface, where);

  std::vector<std::uint8_t> roof(b.size(), 0), free(b.size(), 0);
  for (size_t p = 0; p < b.size(); ++p) {
    if (!available[p]) continue;
    const CellIndex at = cell_of(cells.lattice, b, p);
    const size_t c = cells.lattice.at(at.i, at.j);
    roof[p] = surface[p] && roofs.height()[c] == roofs.height()[c];
    free[p] = !decks[c];
  }
  const std::vector<std::uint8_t> sides = building_sides(b, roof, free, o.roughness.value);

  const Below below(b, where);
  const auto class_of = [&](size_t p) {
    const CellIndex at = cell_of(cells.lattice, b, p);
    const size_t c = cells.lattice.at(at.i, at.j);
    const auto z = static_cast<float>(b.z[p]);
    if (decks[c] && std::abs(z - cells.plane[c]) <= beside_deck) return cls::bridge_deck;
    if (sides[p] || (raised[p] && z - roofs.height()[c] <= above_roof)) return cls::building;  // NaN: no roof there
    if (wires[p]) return cls::wire;
    if (below.is_noise(p)) return cls::low_noise;
    return surface[p] && planar[p] == Planar::wide ? cls::unassigned : vegetation(b.height[p], o);
  };
  std::vector<std::uint32_t> noise;  // set last: it changes who is usable
  for (std::uint32_t p = 0; p < own; ++p) {
    if (wires[p] && is_isolated(b, p)) {
      b.flags[p] = static_cast<std::uint16_t>(b.flags[p] & ~core::flag::isolated);
    } else if (!is_free(b, p)) {
      ++n.kept;
      continue;
    }
    const std::uint8_t c = class_of(p);
    if (c == cls::low_noise)
      noise.push_back(p);
    else
      b.classification[p] = c;
    n.low_vegetation += c == cls::low_vegetation;
    n.medium_vegetation += c == cls::medium_vegetation;
    n.high_vegetation += c == cls::high_vegetation;
    n.building += c == cls::building;
    n.wire += c == cls::wire;
    n.bridge_deck += c == cls::bridge_deck;
    n.unassigned += c == cls::unassigned;
  }
  if (!noise.empty()) core::add_columns(b, {core::Column::flags});
  for (const std::uint32_t p : noise) {
    b.classification[p] = cls::low_noise;
    b.flags[p] = static_cast<std::uint16_t>(b.flags[p] | core::flag::low_point);
  }
  n.low_noise = noise.size();
  return n;
}

}  // namespace swath::filters
