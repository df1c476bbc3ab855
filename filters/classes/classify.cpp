// SPDX-License-Identifier: GPL-3.0-or-later
// Classes: ASPRS LAS 1.4 R15, table 17. Order of the decisions as in the usual chains of rules (Vosselman & Maas 2010, "Airborne and
// terrestrial laser scanning", ch. 4): planes first, of these decks before roofs, then lines, and what has neither is vegetation.
// The steps and their deviations: roof_planes, structure_cells, bridges, building_sides, wires, towers.
#include "filters/classes/classify.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/parallel.h"
#include "filters/classes/bridges.h"
#include "filters/classes/building_sides.h"
#include "filters/classes/crowns.h"
#include "filters/classes/ground_decks.h"
#include "filters/classes/missing_heights.h"
#include "filters/classes/roof_planes.h"
#include "filters/classes/roofs.h"
#include "filters/classes/structure_cells.h"
#include "filters/classes/towers.h"
#include "filters/classes/wires.h"

namespace swath::filters {
namespace {

namespace cls = core::point_class;

constexpr std::uint8_t tower_class = 15;
constexpr float least_tower_height = 2.0f;     // m above ground: crops and bushes around its foot are lower
constexpr float least_plane_height = 1.0f;     // m above ground: a deck near its ends
constexpr float above_roof = 1.5f;             // m: chimneys, parapets and what else stands on a roof
constexpr float beside_deck = 0.5f;            // m above or below a deck: kerbs, rails
constexpr double widest_needed = 9.0;          // m2 of one plane: larger roofs may have several
constexpr double below_reach = 2.25;           // m: the widest radius in which ground is looked for beside returns below it
constexpr float beside_surface = 0.5f;         // m from the terrain model: ground that its filter left out lies within this
constexpr size_t crown_points_at_once = 2048;  // of one thread

bool is_free(const core::Block& b, size_t p) {
  return core::is_usable(b, p) && b.classification[p] != cls::ground && b.classification[p] != cls::water;
}

/// A filter found it alone in space; a thin wire's returns may be.
bool is_isolated(const core::Block& b, size_t p) {
  return b.classification[p] == cls::high_noise && !b.flags.empty() && (b.flags[p] & core::flag::isolated) &&
         !(b.flags[p] & core::flag::withheld);
}

/// Metres of roofs around a tile that its classes depend on.
double roofs_around() { return std::max(building_sides_halo() + crowns_halo(), tower_points_halo()); }
/// The same of decks.
double roofs_reach(const ClassifyOptions& o) { return roof_cells_halo(o.building_side.value) + roofs_around(); }

double wide_area(const ClassifyOptions& o) { return std::min(o.building_side.value * o.building_side.value, widest_needed); }

/// Metres of points around a tile that the planes and what follows from them depend on.
double planes_halo(const ClassifyOptions& o) {
  const double decks = o.bridge_length.value > 0.0 ? deck_cells_halo(o.bridge_length.value) : 0.0;
  // Both planes and what wires need of them hold the districts' halo.
  return planar_points_halo() + std::max({decks + roofs_reach(o), wire_points_halo() - Districts::halo(), tower_points_halo()});
}

std::uint8_t vegetation(float height, const ClassifyOptions& o) {
  if (!(height > 0.0f)) return cls::unassigned;
  const auto h = static_cast<double>(height);
  return h < o.medium_vegetation.value ? cls::low_vegetation : h < o.high_vegetation.value ? cls::medium_vegetation : cls::high_vegetation;
}

/// Returns below the ground that may be noise, and what must lie at least as far above them.
struct Depth {
  float least;    ///< m below the terrain model
  double share;   ///< of the last returns around
  int around;     ///< fewest of these
  bool by_model;  ///< whatever lies at the terrain model counts: large groups of low returns take the ground beside them from its filter
};
constexpr Depth deep{1.0f, 0.25, 1, true}, shallow{0.3f, 0.6, 3, false};

/// Returns that lie below ground returns among which they are scattered: echoes on detours. In a pit there is no ground beside them; in a
/// ditch, and on a slope of which the model shaves an edge, less of it than beside an echo.
class Below {
 public:
  Below(const core::Block& b, size_t own, const Districts& where)
      : block_(b), where_(where), last_(b, below_reach, 0, [&b, any = any_below(b, own), near = OwnBox(b, own, below_reach)](size_t p) {
          return any && core::is_usable(b, p) && core::is_last_return(b, p) && near.holds(b, p);
        }) {}

  bool is_noise(size_t p) const {
    if (!(block_.height[p] <= -shallow.least)) return false;
    const Depth& depth = block_.height[p] <= -deep.least ? deep : shallow;
    const CellIndex d = cell_of(where_.lattice, block_, p), c = cell_of(last_.lattice(), block_, p);
    const double radius = 0.75 * sample_sides[where_.side[where_.lattice.at(d.i, d.j)]];
    int all = 0, above = 0;
    for (int dj = -1; dj <= 1; ++dj)
      for (int di = -1; di <= 1; ++di) {
        if (!last_.lattice().holds(c.i + di, c.j + dj)) continue;
        const auto points = last_.in(c.i + di, c.j + dj);
        const auto rows = last_.rows(c.i + di, c.j + dj);
        for (size_t k = 0; k < points.size(); ++k) {
          const double x = points[k].x - block_.x[p], y = points[k].y - block_.y[p];
          if (x * x + y * y > radius * radius || rows[k] == p) continue;
          ++all;
          above += is_surface(rows[k], depth.by_model) && points[k].z - block_.z[p] >= static_cast<double>(depth.least);
        }
      }
    return all >= depth.around && above > 0 && static_cast<double>(above) >= depth.share * static_cast<double>(all);
  }

 private:
  static bool any_below(const core::Block& b, size_t own) {
    return std::any_of(b.height.begin(), b.height.begin() + static_cast<std::ptrdiff_t>(own), [](float h) { return h <= -shallow.least; });
  }
  bool is_surface(size_t p, bool by_model) const {
    return block_.classification[p] == cls::ground || (by_model && std::abs(block_.height[p]) <= beside_surface);
  }

  const core::Block& block_;
  const Districts& where_;
  Bins last_;
};

/// What the points are, by steps of which each uses those before it.
class Structures {
 public:
  Structures(const core::Block& b, size_t own, const ClassifyOptions& o)
      : block_(b), options_(o), where_(districts(b)), available_(b.size(), 0), raised_(b.size(), 0), below_(b, own, where_) {
    const OwnBox needed(b, own, planes_reach());
    for (size_t p = 0; p < b.size(); ++p) {
      available_[p] = is_free(b, p) && needed.holds(b, p);
      raised_[p] = available_[p] && b.height[p] >= least_plane_height;
    }
    planar_ = planar_points(b, available_, where_, o.roughness.value, wide_area(o));
    core::in_parallel(2, 1, [&](size_t part, size_t) {  // neither reads what the other finds
      if (part == 0) {
        find_decks(own);
        find_roofs(own);
      } else {
        find_wires(own);
      }
    });
    find_towers(own);
  }

  /// Wires and their supports: what a filter may have found alone in space.
  bool is_of_line(size_t p) const { return wires_[p] != 0 || towers_[p] != 0; }
  bool is_deck(size_t p) const {
    const size_t c = cell(p);
    return ground_decks_[p] || (decks_[c] && std::abs(static_cast<float>(block_.z[p]) - cells_.plane[c]) <= beside_deck);
  }
  /// Of a point that is neither ground, water, noise nor withheld.
  std::uint8_t class_of(size_t p) const {
    if (is_deck(p)) return cls::bridge_deck;
    if (sides_[p] || (raised_[p] && !crown_[p] && is_on_roof(p))) return cls::building;
    if (wires_[p]) return cls::wire;
    if (towers_[p]) return tower_class;
    if (below_.is_noise(p)) return cls::low_noise;
    return is_surface(p) && planar_[p] == Planar::wide ? cls::unassigned : vegetation(block_.height[p], options_);
  }

 private:
  size_t cell(size_t p) const {
    const CellIndex at = cell_of(cells_.lattice, block_, p);
    return cells_.lattice.at(at.i, at.j);
  }
  bool is_on_roof(size_t p) const { return static_cast<float>(block_.z[p]) - roofs_[cell(p)] <= above_roof; }  // NaN: no roof
  bool is_surface(size_t p) const { return raised_[p] && planar_[p] != Planar::none; }

  /// m around the own points in which planes are looked for.
  double planes_reach() const { return planes_halo(options_) - Districts::halo(); }
  /// Of the block's cells those within that.
  core::Lattice needed_cells(size_t own) const {
    core::Lattice l = lattice_around(block_, structure_cell, 0);
    if (own == 0) return l;
    const core::Lattice near = lattice_around(block_, own, structure_cell, planes_reach(), 0);
    const std::int64_t i0 = std::max(l.i0, near.i0), i1 = std::min(l.i0 + l.nx, near.i0 + near.nx);
    const std::int64_t j0 = std::max(l.j0, near.j0), j1 = std::min(l.j0 + l.ny, near.j0 + near.ny);
    return {structure_cell, i0, j0, static_cast<int>(i1 - i0), static_cast<int>(j1 - j0)};
  }

  void find_decks(size_t own) {
    cells_ = structure_cells(block_, planar_, needed_cells(own));
    decks_.assign(cells_.lattice.size(), 0);
    ground_decks_.assign(block_.size(), 0);
    const double longest = options_.bridge_length.value;
    if (longest <= 0.0) return;
    decks_ = deck_cells(cells_, {longest, options_.building_height.value}, OwnBox(block_, own, roofs_reach(options_) + deck_spread()));
    if (options_.decks_in_ground) ground_decks_ = ground_decks(block_, where_, longest, own);
  }

  void find_roofs(size_t own) {
    std::vector<std::uint8_t> standing(cells_.lattice.size(), 0);  // cells with returns off the ground
    for (size_t p = 0; p < block_.size(); ++p)
      if (raised_[p]) standing[cell(p)] = 1;
    roofs_ = roof_cells(cells_, standing, decks_, where_, {options_.building_height.value, options_.building_side.value},
                        OwnBox(block_, own, roofs_around() + roof_spread()));
    find_crowns(own);
    std::vector<std::uint8_t> roof(block_.size(), 0), free(block_.size(), 0);
    for (size_t p = 0; p < block_.size(); ++p) {
      if (!available_[p]) continue;
      const size_t c = cell(p);
      roof[p] = is_surface(p) && !crown_[p] && roofs_[c] == roofs_[c];
      free[p] = !decks_[c];
    }
    sides_ = building_sides(block_, roof, free, options_.roughness.value, options_.building_height.value, own);
  }

  /// Of the returns on and below roofs, those of trees.
  void find_crowns(size_t own) {
    const OwnBox needed(block_, own, building_sides_halo()), around(block_, own, building_sides_halo() + crowns_halo());
    std::vector<Witness> witness(block_.size(), Witness::none);
    for (size_t p = 0; p < block_.size(); ++p) {
      if (!raised_[p] || !around.holds(block_, p) || decks_[cell(p)]) continue;
      if (is_on_roof(p))
        witness[p] = is_surface(p) ? Witness::roof : Witness::none;
      else if (!is_surface(p) && !core::is_last_return(block_, p))
        witness[p] = Witness::crown;
    }
    const Crowns crowns(block_, witness);
    crown_.assign(block_.size(), 0);
    core::in_parallel(block_.size(), crown_points_at_once, [&](size_t from, size_t to) {
      for (size_t p = from; p < to; ++p)
        crown_[p] = raised_[p] && planar_[p] != Planar::wide && needed.holds(block_, p) && is_on_roof(p) && crowns.holds(p);
    });
  }

  void find_wires(size_t own) {
    std::vector<std::uint8_t> high(block_.size(), 0), surface(block_.size(), 0);
    for (size_t p = 0; p < block_.size(); ++p) {
      surface[p] = is_surface(p);
      const bool alone = (raised_[p] && !surface[p]) || is_isolated(block_, p);
      high[p] = alone && static_cast<double>(block_.height[p]) >= options_.wire_height.value;
    }
    wires_ = wire_points(block_, high, surface, where_, own);
  }

  /// Supports carry wires; edges of roofs are lines, too.
  void find_towers(size_t own) {
    const OwnBox needed(block_, own, tower_points_halo());
    std::vector<std::uint8_t> high(block_.size(), 0), wire(block_.size(), 0);
    for (size_t p = 0; p < block_.size(); ++p) {
      if (!needed.holds(block_, p)) continue;
      wire[p] = is_on_roof(p) ? std::uint8_t{0} : wires_[p];
      high[p] = block_.height[p] >= least_tower_height && (raised_[p] ? !is_surface(p) : is_isolated(block_, p)) && wires_[p] != 1;
    }
    towers_ = tower_points(block_, wire, high, own);
    for (size_t p = 0; p < own; ++p) {
      if (wires_[p] == wire_at_support) wires_[p] = towers_[p] == 2;
      if (towers_[p] == 2) wires_[p] = 1;
    }
  }

  const core::Block& block_;
  const ClassifyOptions& options_;
  Districts where_;
  std::vector<std::uint8_t> available_, raised_;
  Below below_;
  std::vector<Planar> planar_;
  StructureCells cells_;
  std::vector<std::uint8_t> decks_, ground_decks_;            // per cell; per point
  std::vector<float> roofs_;                                  // per cell
  std::vector<std::uint8_t> crown_, sides_, wires_, towers_;  // per point
};

void count(ClassifyCounts& n, std::uint8_t c) {
  n.low_vegetation += c == cls::low_vegetation;
  n.medium_vegetation += c == cls::medium_vegetation;
  n.high_vegetation += c == cls::high_vegetation;
  n.building += c == cls::building;
  n.wire += c == cls::wire;
  n.tower += c == tower_class;
  n.bridge_deck += c == cls::bridge_deck;
  n.low_noise += c == cls::low_noise;
  n.unassigned += c == cls::unassigned;
}

}  // namespace

double halo(const ClassifyOptions& o) {
  const double on_ground = o.decks_in_ground && o.bridge_length.value > 0.0 ? ground_decks_halo(o.bridge_length.value) : 0.0;
  return missing_heights_halo() + std::max(planes_halo(o), on_ground);
}

ClassifyCounts classify(core::Block& b, size_t own, const ClassifyOptions& o) {
  ClassifyCounts n;
  std::vector<std::uint8_t> found(own, cls::never_classified);  // set last: it changes who is usable
  const std::vector<std::uint32_t> unknown = fill_missing_heights(b);
  const Structures structures(b, own, o);
  for (const std::uint32_t p : unknown) b.height[p] = std::numeric_limits<float>::quiet_NaN();
  for (size_t p = 0; p < own; ++p) {
    const bool on_deck = core::is_usable(b, p) && b.classification[p] == cls::ground && structures.is_deck(p);
    if (on_deck || is_free(b, p) || (structures.is_of_line(p) && is_isolated(b, p)))
      count(n, found[p] = on_deck ? cls::bridge_deck : structures.class_of(p));
    else
      ++n.kept;
  }
  if (n.low_noise > 0) core::add_columns(b, {core::Column::flags});
  for (size_t p = 0; p < own; ++p) {
    if (found[p] == cls::never_classified) continue;
    if (is_isolated(b, p)) b.flags[p] = static_cast<std::uint16_t>(b.flags[p] & ~core::flag::isolated);
    if (found[p] == cls::low_noise) b.flags[p] = static_cast<std::uint16_t>(b.flags[p] | core::flag::low_point);
    b.classification[p] = found[p];
  }
  return n;
}

}  // namespace swath::filters
