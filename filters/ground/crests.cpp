// SPDX-License-Identifier: GPL-3.0-or-later
// An opening cuts off a roof, and a crest on which no disk comes to rest. The difference: the ground beside a crest leads up to it
// without a step. That is how triangulations climb (Axelsson 2000, "DEM generation from laser scanner data using adaptive TIN models",
// IAPRS 33); here a cell that lies on the plane through the ground beside it is ground too, and the next ones are foretold from it. A
// deck goes on from its banks in the same way, but there the surface falls off the plane on both sides, along walls where returns are dense
// enough to show them. A pile falls off on both sides too, but step by step. Without that difference cones of 36 deg, 5 to 18 m high, lose
// 3 to 10 % of their volume and up to 5.3 m of their tops; a cone of 3 m is lost with it, since no ground is left on its flanks.
#include "filters/ground/crests.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>
#include <vector>

#include "filters/bins.h"

namespace swath::filters {
namespace {

constexpr double cut = 1.5;            // m: what was cut less deep, the robust surface comes back to by itself
constexpr int rounds = 5;              // each leads 3 to 4 cells farther, as deep as an opening cuts into cones of up to 40 deg
constexpr int near = 3, far = 5;       // cells, half the width of the ground that foretells: where returns are dense, and where sparse
constexpr int dense = 15;              // cells with a return of the 49 around
constexpr double fewest = 5.0;         // cells of ground behind a plane
constexpr double roughest = 0.3;       // m, standard deviation of the ground about a plane that foretells
constexpr double place_in_cell = 0.3;  // m, standard deviation of where in its cell, up the slope, a return lies
constexpr double smoothest = 0.05;     // m: where it comes out as less, by chance
constexpr double sigmas = 2.0;         // of the plane's error at the cell, in the depth of the cut
constexpr double tolerance = 0.3;      // m from the plane, beyond the ground's own deviation
constexpr double shallow = cut - tolerance - roughest;  // m: what was cut by less is not looked at, on rough slopes a little too early
// m, and m per m to the side: below the plane, where the surface falls off it. Planes through the roughest ground are off by as much.
constexpr double fall = 0.5, fall_per_run = 0.1;
constexpr double wall = 1.0, wall_per_run = 0.5;  // m, m per m: what falls off the plane by more falls along a wall; piles of 40 deg do not
constexpr int facade = 3;                         // cells within which a wall comes down
constexpr int wall_shown = 36;                    // cells with a return of the 49 around: with fewer, filled gaps make slopes of walls

constexpr std::array<std::pair<int, int>, 8> directions{{{1, 0}, {0, 1}, {1, 1}, {1, -1}, {-1, 0}, {0, -1}, {-1, -1}, {-1, 1}}};

/// Calls take(a, b, height) for the cells with a value within `half` of `middle`; a, b: cells from `from`.
template <class Take>
void around(const Raster& r, CellIndex middle, int half, CellIndex from, const Take& take) {
  for (int j = std::max(0, middle.j - half); j <= std::min(r.ny - 1, middle.j + half); ++j)
    for (int i = std::max(0, middle.i - half); i <= std::min(r.nx - 1, middle.i + half); ++i)
      if (const double height = r.value[r.at(i, j)]; !std::isnan(height)) take(i - from.i, j - from.j, height);
}

/// A plane at a cell beside the ground that it goes through.
struct Foretold {
  bool known = false;
  double height = 0.0, east = 0.0, north = 0.0;  ///< m, rise / run
  double spread = 0.0, error = 0.0;              ///< m: of the ground about the plane, of the plane at the cell

  double at(int a, int b) const { return height + east * a + north * b; }
};

Foretold foretold(const Raster& ground, CellIndex c, CellIndex middle, int half) {
  double n = 0, x = 0, y = 0, z = 0, xx = 0, xy = 0, yy = 0, xz = 0, yz = 0, zz = 0, base = 0;
  around(ground, middle, half, c, [&](double a, double b, double height) {
    if (n == 0) base = height;
    const double h = height - base;
    n += 1, x += a, y += b, z += h, xx += a * a, xy += a * b, yy += b * b, xz += a * h, yz += b * h, zz += h * h;
  });
  if (n < fewest) return {};
  x /= n, y /= n, z /= n;
  xx -= n * x * x, xy -= n * x * y, yy -= n * y * y, xz -= n * x * z, yz -= n * y * z, zz -= n * z * z;
  const double determinant = xx * yy - xy * xy;
  // Cells on a line leave the plane open.
  if (xx < n || yy < n || determinant < 0.05 * xx * yy) return {};
  const double east = (xz * yy - yz * xy) / determinant, north = (yz * xx - xz * xy) / determinant;
  const double spread = std::sqrt(std::max(0.0, zz - east * xz - north * yz) / (n - 3.0));
  const double lever = (x * x * yy - 2.0 * x * y * xy + y * y * xx) / determinant;
  return {true, base + z - east * x - north * y, east, north, spread, std::max(spread, smoothest) * std::sqrt(1.0 / n + lever)};
}

/// How a surface ends on one side of a cell.
enum class End { beyond_reach, slope, wall };

/// Where the surface falls off the plane in the direction (di, dj).
End end_of(const OpenedReturns& r, const Foretold& plane, CellIndex c, int di, int dj) {
  const double step = std::hypot(di, dj);
  const auto holds = [&](int k) { return r.filled.holds(c.i + k * di, c.j + k * dj); };
  const auto below = [&](int k) { return plane.at(k * di, k * dj) - r.filled.value[r.filled.at(c.i + k * di, c.j + k * dj)]; };
  int k = 1;
  while (k * step <= r.widest && holds(k) && !(below(k) > fall + fall_per_run * k * step)) ++k;
  if (k * step > r.widest || !holds(k)) return End::beyond_reach;
  const auto shows = [&](int n) { return !std::isnan(r.lowest.value[r.lowest.at(c.i + n * di, c.j + n * dj)]); };
  bool shown = false;  // the fall: filled water beside a deck is a slope
  for (int n = 0; n < facade && holds(k + n); ++n) shown = shown || shows(k + n);
  if (!shown) return End::wall;
  const double edge = below(k - 1);
  for (int n = 1; n <= facade && holds(k - 1 + n); ++n)
    if (below(k - 1 + n) - edge > wall + wall_per_run * n * step) return End::wall;
  return End::slope;
}

/// True where the surface falls off the plane on both sides of a cell; `by_walls`: along walls.
bool stands_free(const OpenedReturns& r, const Foretold& plane, CellIndex c, bool by_walls) {
  const auto ends = [&](int di, int dj) {
    const End e = end_of(r, plane, c, di, dj);
    return e == End::wall || (e == End::slope && !by_walls);
  };
  return std::any_of(directions.begin(), directions.begin() + directions.size() / 2,
                     [&](const auto& d) { return ends(d.first, d.second) && ends(-d.first, -d.second); });
}

bool is_crest(const Raster& ground, const OpenedReturns& r, CellIndex c) {
  const size_t at = ground.at(c.i, c.j);
  int returns = 0;
  around(r.lowest, c, near, c, [&](double, double, double) { ++returns; });
  const int half = returns < dense ? far : near;
  return std::any_of(directions.begin(), directions.end(), [&](const auto& d) {
    const Foretold plane = foretold(ground, c, {c.i + half * d.first, c.j + half * d.second}, half);
    return plane.known && plane.spread <= std::hypot(roughest, place_in_cell * std::hypot(plane.east, plane.north)) &&
           std::abs(r.lowest.value[at] - plane.height) <= tolerance + plane.spread &&
           plane.height - r.opened.value[at] > cut + sigmas * plane.error && !stands_free(r, plane, c, returns >= wall_shown);
  });
}

}  // namespace

const int crest_support = rounds * 2 * far;

void restore_crests(Raster& ground, const OpenedReturns& r) {
  std::vector<size_t> off;
  for (size_t c = 0; c < ground.value.size(); ++c)
    if (std::isnan(ground.value[c]) && r.lowest.value[c] - r.opened.value[c] > shallow) off.push_back(c);
  const auto cell_at = [&](size_t c) {
    return CellIndex{static_cast<int>(c % static_cast<size_t>(ground.nx)), static_cast<int>(c / static_cast<size_t>(ground.nx))};
  };
  std::vector<char> changed(ground.value.size(), 1);  // ground around the cell, since it was looked at
  for (int round = 0; round < rounds; ++round) {
    const auto crest = std::partition(off.begin(), off.end(), [&](size_t c) { return !changed[c] || !is_crest(ground, r, cell_at(c)); });
    if (crest == off.end()) break;
    std::fill(changed.begin(), changed.end(), char{0});
    for (auto c = crest; c != off.end(); ++c) {
      ground.value[*c] = r.lowest.value[*c];
      const CellIndex at = cell_at(*c);
      const int west = std::max(0, at.i - 2 * far), east = std::min(ground.nx - 1, at.i + 2 * far);
      for (int j = std::max(0, at.j - 2 * far); j <= std::min(ground.ny - 1, at.j + 2 * far); ++j)
        std::fill_n(changed.begin() + static_cast<std::ptrdiff_t>(ground.at(west, j)), east - west + 1, char{1});
    }
    off.erase(crest, off.end());
  }
}

}  // namespace swath::filters
