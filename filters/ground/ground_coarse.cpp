// SPDX-License-Identifier: GPL-3.0-or-later
// Pingel, Clarke & McBride 2013 (ISPRS J. 77): lowest last return per cell, holes filled, objects where an opening by a
// growing disk drops. Deviations: the drop that is allowed per radius grows with the slope of the country (as Sithole 2001 adapts the
// slope filter), and is never more than the steepest ground can fall within a cell and half a metre, so that low halls are taken off by
// large disks too; halls wider than the disk, and roofs at the rim of the data, go by their walls (walls.h); low outliers are looked for in
// the surface that a small opening leaves and not in the lowest returns, where ground seen through a gap of the canopy looks the same.
// Bridge decks are taken off to their ends, crests put back, and pieces of roofs at the rim taken off (decks.h, crests.h, rim_islands.h).
// Each step works on what the ones after it need: the part asked for, grown by their reach.
#include "filters/ground/ground_coarse.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

#include "core/wide.h"
#include "filters/ground/crests.h"
#include "filters/ground/decks.h"
#include "filters/ground/inpaint.h"
#include "filters/ground/moving_planes.h"
#include "filters/ground/rim_islands.h"
#include "filters/ground/walls.h"

namespace swath::filters {
namespace {

constexpr float void_value = std::numeric_limits<float>::quiet_NaN();
constexpr Inpainting gap_filling{.reach = 10, .relax = 2, .extrapolate = true};
constexpr Inpainting pit_filling{.reach = 6, .relax = 0, .extrapolate = true};
constexpr double growth = 0.12;           // rise / run: drop of an opening allowed per radius on level ground (Pingel's slope)
constexpr double growth_per_slope = 0.3;  // further drop per slope of the country
constexpr double country_sigma = 5.0;     // cells
constexpr int every_radius = 8;           // cells: up to here, and then every second one
constexpr double step_left = 0.5;         // m, beyond the steepest ground within one cell
constexpr int pit_window = 6;             // cells
constexpr int pit_radius = 2;             // cells
constexpr double pit_depth = 0.8;         // m
constexpr double smoothing = 1.0;         // of the result, cells

int window_of(const GroundSurfaceOptions& o) { return static_cast<int>(std::ceil(0.5 * o.widest / ground_cell - 1e-9)) + 1; }
Inpainting terrain_filling(int window) { return {.reach = 2 * window, .relax = 4, .extrapolate = true}; }
WallOptions walls_of(const GroundSurfaceOptions& o) {
  return {.longest = static_cast<int>(std::ceil(o.longest / ground_cell)), .widest = static_cast<int>(o.widest / ground_cell)};
}
/// The same in cells twice as wide, where the flank of a bank looks like a wall.
WallOptions doubled(const WallOptions& o) {
  return {.longest = (o.longest + 1) / 2, .widest = o.widest / 2, .cell = 2.0 * o.cell, .walled_at_rim = 0.35};
}
int walls_support(const WallOptions& o) { return std::max(wall_support(o), 2 * wall_support(doubled(o)) + 1); }
// So that the country's slope reaches no farther than the widest opening.
int country_window(int window) { return std::max(1, window - (reach(country_sigma) + 1) / 2); }
int opening_support(int window) { return std::max(2 * window, 2 * country_window(window) + reach(country_sigma) + 1); }

/// The mean under the Gaussian of the cells that have a value.
Raster smoothed(const Raster& r, double sigma) {
  Raster weight(r.nx, r.ny, 0.0F), value = weight;
  for (size_t c = 0; c < r.value.size(); ++c) {
    const bool known = !std::isnan(r.value[c]);
    weight.value[c] = known ? 1.0F : 0.0F;
    value.value[c] = known ? r.value[c] : 0.0F;
  }
  weight = blur(weight, sigma);
  value = blur(value, sigma);
  for (size_t c = 0; c < r.value.size(); ++c) value.value[c] = std::isnan(r.value[c]) ? void_value : value.value[c] / weight.value[c];
  return value;
}

/// Rise / run of a smooth surface, 0 where it is not known.
Raster slope_of(const Raster& r) {
  Raster out(r.nx, r.ny, 0.0F);
  for (int j = 1; j + 1 < r.ny; ++j)
    for (int i = 1; i + 1 < r.nx; ++i) {
      const float east = r.value[r.at(i + 1, j)] - r.value[r.at(i - 1, j)], north = r.value[r.at(i, j + 1)] - r.value[r.at(i, j - 1)];
      const float v = std::sqrt(east * east + north * north) / static_cast<float>(2.0 * ground_cell);
      out.value[out.at(i, j)] = std::isnan(v) ? 0.0F : std::min(1.0F, v);
    }
  return out;
}

/// One part of a row of remove_objects().
SWATH_WIDE void take_off(float* terrain, float* last, const float* opened, const float* slope, int n, float radius, float cap) {
  for (int i = 0; i < n; ++i) {
    const float grade = static_cast<float>(growth) + static_cast<float>(growth_per_slope) * slope[i];
    const float drop = static_cast<float>(ground_cell) * radius * grade, tolerance = drop < cap ? drop : cap;
    terrain[i] = last[i] - opened[i] > tolerance ? void_value : terrain[i];
    last[i] = opened[i] < last[i] ? opened[i] : last[i];
  }
}

/// Voids in `terrain` the cells that drop by more than ground can when the disk grows by a cell. `slope`: of the country. Returns the
/// opened surface.
Raster remove_objects(Raster& terrain, const Raster& filled, const Raster& slope, const GroundSurfaceOptions& o, int window) {
  const double cap = o.steepest * ground_cell + step_left;
  Raster last = filled;
  for (int radius = 1; radius <= window; radius += radius < every_radius ? 1 : 2)
    open_disk(filled, radius, [&](int j, int i, const float* opened, int n) {
      const size_t c = filled.at(i, j);
      take_off(terrain.value.data() + c, last.value.data() + c, opened, slope.value.data() + c, n, static_cast<float>(radius),
               static_cast<float>(cap));
    });
  return last;
}

/// Closing at cell (i, j), which has a value, along a line of 2 pit_radius + 1 cells in the direction (di, dj). Cells without value take no
/// part.
float closed_at(const Raster& r, int i, int j, int di, int dj) {
  constexpr int around = 2 * pit_radius;
  std::array<float, 2 * around + 1> line{};
  for (int k = -around; k <= around; ++k) {
    const int u = i + k * di, v = j + k * dj;
    line[static_cast<size_t>(k + around)] = r.holds(u, v) ? r.value[r.at(u, v)] : void_value;
  }
  float lowest = std::numeric_limits<float>::infinity();
  for (int k = -pit_radius; k <= pit_radius; ++k) {
    if (std::isnan(line[static_cast<size_t>(k + around)])) continue;
    float highest = -std::numeric_limits<float>::infinity();
    for (int m = k - pit_radius; m <= k + pit_radius; ++m) {
      const float v = line[static_cast<size_t>(m + around)];
      highest = v > highest ? v : highest;
    }
    lowest = highest < lowest ? highest : lowest;
  }
  return lowest;
}

/// Voids the cells of `ground` where the surface through them has a pit: deeper than pit_depth along all four lines and at most
/// 2 pit_radius wide.
void remove_pits(Raster& ground, const Raster& surface) {
  constexpr std::array<std::pair<int, int>, 4> lines{{{1, 0}, {0, 1}, {1, 1}, {-1, 1}}};
  const auto deep = [&](int i, int j) {
    const float z = surface.value[surface.at(i, j)];
    return std::all_of(lines.begin(), lines.end(), [&](const auto& d) {
      bool higher = false;
      for (int k = -pit_radius; k <= pit_radius && !higher; ++k) {
        const int u = i + k * d.first, v = j + k * d.second;
        higher = surface.holds(u, v) && surface.value[surface.at(u, v)] - z > pit_depth;
      }
      return higher && closed_at(surface, i, j, d.first, d.second) - z > pit_depth;
    });
  };
  for (int j = 0; j < ground.ny; ++j)
    for (int i = 0; i < ground.nx; ++i)
      if (float& v = ground.value[ground.at(i, j)]; !std::isnan(v) && deep(i, j)) v = void_value;
}

/// Where a step's result is needed, in cells around the part asked for.
struct Needs {
  int filled, islands, crests, decks, objects, gaps, walls, pits, all;
};
/// `rim`: are there cells at the rim of the data near the part? Elsewhere are no islands.
Needs needs_of(const GroundSurfaceOptions& o, bool rim) {
  const int window = window_of(o);
  Needs n{};
  n.filled = reach(smoothing);
  n.islands = n.filled + terrain_filling(window).support();
  n.crests = n.islands + (rim ? rim_island_support : 0);
  n.decks = n.crests + crest_support;
  n.objects = std::max(n.decks + deck_support, n.decks + window + 2);  // crests ask how the filled surface falls within the widest disk
  n.gaps = n.objects + opening_support(window);
  n.walls = n.gaps + gap_filling.support();
  n.pits = n.walls + walls_support(walls_of(o));
  n.all = n.pits + 4 * pit_radius + pit_filling.support() + 2 * std::min(window, pit_window) + gap_filling.support();
  return n;
}

Raster cropped(const Raster& r, const core::Lattice& of, const core::Lattice& to) {
  Raster out(to.nx, to.ny, void_value);
  const auto i0 = static_cast<int>(to.i0 - of.i0), j0 = static_cast<int>(to.j0 - of.j0);
  for (int j = 0; j < to.ny; ++j) std::copy_n(r.value.data() + r.at(i0, j0 + j), to.nx, out.value.data() + out.at(0, j));
  return out;
}

/// The lowest value in cells twice as wide, which lie on even cells of the survey's lattice.
Raster halved(const Raster& r, const core::Lattice& l) {
  const auto odd_i = static_cast<int>(l.i0 & 1), odd_j = static_cast<int>(l.j0 & 1);
  Raster out((r.nx + odd_i + 1) / 2, (r.ny + odd_j + 1) / 2, void_value);
  for (int j = 0; j < r.ny; ++j)
    for (int i = 0; i < r.nx; ++i) {
      const float v = r.value[r.at(i, j)];
      float& to = out.value[out.at((i + odd_i) / 2, (j + odd_j) / 2)];
      if (!std::isnan(v) && !(to <= v)) to = v;
    }
  return out;
}

/// Walls at two scales: with few returns, and where gardens and dormers break a roof up, only wide cells have neighbours.
std::vector<WalledHill> remove_walled(Raster& lowest, const core::Lattice& l, const WallOptions& o) {
  if (o.longest == 0) return {};
  Raster wide = halved(lowest, l);
  remove_walled(wide, doubled(o));
  std::vector<WalledHill> hills = remove_walled(lowest, o);
  const auto odd_i = static_cast<int>(l.i0 & 1), odd_j = static_cast<int>(l.j0 & 1);
  for (int j = 0; j < lowest.ny; ++j)
    for (int i = 0; i < lowest.nx; ++i)
      if (std::isnan(wide.value[wide.at((i + odd_i) / 2, (j + odd_j) / 2)])) lowest.value[lowest.at(i, j)] = void_value;
  return hills;
}

/// The lowest returns without those in pits and on what walls surround; what stays of that.
std::vector<WalledHill> remove_pits_and_walled(Raster& lowest, const core::Lattice& l, const GroundSurfaceOptions& o) {
  Raster ground = lowest;
  remove_objects(ground, inpaint(lowest, gap_filling), Raster(lowest.nx, lowest.ny, 0.0F), o, std::min(window_of(o), pit_window));
  remove_pits(lowest, inpaint(ground, pit_filling));
  WallOptions walls = walls_of(o);
  walls.farthest = needs_of(o, false).all;
  return remove_walled(lowest, l, walls);
}

/// rim_cells() where islands ask for them; empty where none of them can reach the part.
Raster rim_around(const Raster& lowest, const core::Lattice& all, const core::Lattice& part, const Needs& needs) {
  const core::Lattice wide = grown(part, needs.crests + rim_support, all), near = grown(part, needs.islands + rim_island_across, all);
  const Raster rim = rim_cells(cropped(lowest, all, wide)), reached = cropped(rim, wide, near);
  if (std::none_of(reached.value.begin(), reached.value.end(), [](float v) { return v > 0.0F; })) return {};
  return cropped(rim, wide, grown(part, needs.crests, all));
}

/// The hills of `all` that are still hills in the finished surface.
std::vector<RaisedSurface> raised_in(const Raster& ground, const std::vector<WalledHill>& hills, const core::Lattice& all,
                                     const core::Lattice& part) {
  std::vector<RaisedSurface> out;
  for (const WalledHill& h : hills) {
    const auto i = static_cast<int>(h.i + all.i0 - part.i0), j = static_cast<int>(h.j + all.j0 - part.j0);
    if (!part.holds(i, j) || !(static_cast<double>(ground.value[ground.at(i, j)]) > static_cast<double>(h.height) - 0.5 * h.rise)) continue;
    out.push_back({all.centre_x(h.i), all.centre_y(h.j), (static_cast<double>(all.i0) + h.east) * all.cell,
                   (static_cast<double>(all.j0) + h.north) * all.cell, h.length * all.cell, h.width * all.cell, h.rise});
  }
  return out;
}

}  // namespace

core::Lattice grown(const core::Lattice& l, int cells, const core::Lattice& within) {
  const std::int64_t i0 = std::max(within.i0, l.i0 - cells), j0 = std::max(within.j0, l.j0 - cells);
  const std::int64_t i1 = std::min(within.i0 + within.nx, l.i0 + l.nx + cells), j1 = std::min(within.j0 + within.ny, l.j0 + l.ny + cells);
  return {l.cell, i0, j0, static_cast<int>(i1 - i0), static_cast<int>(j1 - j0)};
}

int coarse_ground_reach(const GroundSurfaceOptions& o) { return needs_of(o, true).all; }

int coarse_ground_rim(const GroundSurfaceOptions& o) { return gap_filling.support() + window_of(o) + 1; }

Raster coarse_ground(Raster lowest, const core::Lattice& all, const core::Lattice& part, const GroundSurfaceOptions& o,
                     std::vector<RaisedSurface>* raised) {
  const int window = window_of(o);
  const Raster rim = rim_around(lowest, all, part, needs_of(o, true));
  const Needs needs = needs_of(o, rim.nx > 0);
  core::Lattice at = all;
  const auto crop = [&](int needed, std::initializer_list<Raster*> rasters) {
    const core::Lattice to = grown(part, needed, all);
    for (Raster* r : rasters) *r = cropped(*r, at, to);
    at = to;
  };
  crop(needs.all, {&lowest});
  const core::Lattice reached = at;
  const std::vector<WalledHill> hills = remove_pits_and_walled(lowest, at, o);
  crop(needs.walls, {&lowest});
  Raster ground = lowest, filled = inpaint(lowest, gap_filling), opened;
  {
    const Raster country = smoothed(open_disk(filled, country_window(window)), country_sigma);
    opened = remove_objects(ground, filled, slope_of(country), o, window);
  }
  crop(needs.objects, {&ground, &lowest, &filled, &opened});
  remove_decks(ground, lowest, {.steepest = o.steepest, .step = step_left});
  crop(needs.decks + window, {&ground, &lowest, &filled, &opened});
  restore_crests(ground, {lowest, filled, opened, window - 1});
  crop(needs.crests, {&ground});
  if (rim.nx > 0) remove_rim_islands(ground, rim);
  crop(needs.islands, {&ground});
  ground = cropped(smoothed(inpaint(ground, terrain_filling(window)), smoothing), at, part);
  if (raised) *raised = raised_in(ground, hills, reached, part);
  return ground;
}

}  // namespace swath::filters
