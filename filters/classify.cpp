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
#include "filters/roofs.h"
#include "filters/structure_cells.h"
#include "filters/wires.h"

namespace swath::filters {
namespace {

namespace cls = core::point_class;

constexpr float least_plane_height = 1.0f;  // m above ground: a deck near its ends
constexpr float above_roof = 1.5f;          // m: chimneys, parapets and what else stands on a roof
constexpr float beside_deck = 0.5f;         // m above or below a deck: kerbs, rails
constexpr double widest_needed = 9.0;       // m2 of one plane: larger roofs may have several
constexpr float below_ground = 1.0f;        // m: returns deeper than this may be noise
constexpr double below_reach = 2.25;        // m: the widest radius in which ground is looked for beside them
constexpr double ground_beside = 0.25;      // of the last returns there

bool is_free(const core::Block& b, size_t p) {
  return core::is_usable(b, p) && b.classification[p] != cls::ground && b.classification[p] != cls::water;
}

/// A filter found it alone in space; a thin wire's returns may be.
bool is_isolated(const core::Block& b, size_t p) {
  return b.classification[p] == cls::high_noise && !b.flags.empty() && (b.flags[p] & core::flag::isolated) &&
         !(b.flags[p] & core::flag::withheld);
}

double wide_area(const ClassifyOptions& o) { return std::min(o.building_side.value * o.building_side.value, widest_needed); }

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
  const double structures = planar_points_halo() + decks + roof_cells_halo(o.building_side.value);
  return std::max(structures + building_sides_halo(), planar_points_halo() + wire_points_halo());
}

ClassifyCounts classify(core::Block& b, size_t own, const ClassifyOptions& o) {
  ClassifyCounts n;
  std::vector<std::uint8_t> available(b.size(), 0), raised(b.size(), 0), high(b.size(), 0), surface(b.size(), 0);
  const OwnBox needed(b, own, halo(o) - Districts::halo());
  for (size_t p = 0; p < b.size(); ++p) {
    available[p] = is_free(b, p) && needed.holds(b, p);
    raised[p] = available[p] && b.height[p] >= least_plane_height;
  }
  const Districts where = districts(b);
  const std::vector<Planar> planar = planar_points(b, available, where, o.roughness.value, wide_area(o));
  const StructureCells cells = structure_cells(b, planar);
  const std::vector<std::uint8_t> decks = o.bridge_length.value > 0.0 ? deck_cells(cells, {o.bridge_length.value, o.building_height.value})
                                                                      : std::vector<std::uint8_t>(cells.lattice.size(), 0);
  std::vector<std::uint8_t> standing(cells.lattice.size(), 0);  // cells with returns off the ground
  for (size_t p = 0; p < b.size(); ++p)
    if (raised[p]) standing[cells.lattice.at(cell_of(cells.lattice, b, p).i, cell_of(cells.lattice, b, p).j)] = 1;
  const std::vector<float> roofs = roof_cells(cells, standing, decks, where, {o.building_height.value, o.building_side.value});
  for (size_t p = 0; p < b.size(); ++p) {
    surface[p] = raised[p] && planar[p] != Planar::none;
    high[p] = ((raised[p] && planar[p] == Planar::none) || is_isolated(b, p)) && static_cast<double>(b.height[p]) >= o.wire_height.value;
  }
  const std::vector<std::uint8_t> wires = wire_points(b, high, surface, where, own);

  std::vector<std::uint8_t> roof(b.size(), 0), free(b.size(), 0);
  for (size_t p = 0; p < b.size(); ++p) {
    if (!available[p]) continue;
    const CellIndex at = cell_of(cells.lattice, b, p);
    const size_t c = cells.lattice.at(at.i, at.j);
    roof[p] = surface[p] && roofs[c] == roofs[c];
    free[p] = !decks[c];
  }
  const std::vector<std::uint8_t> sides = building_sides(b, roof, free, o.roughness.value, own);

  const Below below(b, where);
  const auto class_of = [&](size_t p) {
    const CellIndex at = cell_of(cells.lattice, b, p);
    const size_t c = cells.lattice.at(at.i, at.j);
    const auto z = static_cast<float>(b.z[p]);
    if (decks[c] && std::abs(z - cells.plane[c]) <= beside_deck) return cls::bridge_deck;
    if (sides[p] || (raised[p] && z - roofs[c] <= above_roof)) return cls::building;  // NaN: no roof there
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
