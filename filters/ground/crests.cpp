// SPDX-License-Identifier: GPL-3.0-or-later
// An opening cuts off a roof, and a crest on which no disk comes to rest. The difference: the ground beside a crest leads up to it
// without a step. That is how triangulations climb (Axelsson 2000, "DEM generation from laser scanner data using adaptive TIN models",
// IAPRS 33); here a cell that lies on the plane through the ground beside it is ground too, and the next ones are foretold from it. A
// deck goes on from its banks in the same way, but there the surface falls off the plane on both sides.
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
constexpr int rounds = 3;              // each leads a few cells farther
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

/// True where the surface falls off the plane on both sides of a cell.
bool stands_free(const OpenedReturns& r, const Foretold& plane, CellIndex c) {
  const auto falls = [&](int di, int dj) {
    const double step = std::hypot(di, dj);
    for (int k = 1; k * step <= r.widest; ++k) {
      const CellIndex to{c.i + k * di, c.j + k * dj};
      if (!r.filled.holds(to.i, to.j)) return false;
      if (plane.at(k * di, k * dj) - r.filled.value[r.filled.at(to.i, to.j)] > fall + fall_per_run * k * step) return true;
    }
    return false;
  };
  return std::any_of(directions.begin(), directions.begin() + directions.size() / 2,
                     [&](const auto& d) { return falls(d.first, d.second) && falls(-d.first, -d.second); });
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
           plane.height - r.opened.value[at] > cut + sigmas * plane.error && !stands_free(r, plane, c);
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
