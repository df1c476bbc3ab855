// SPDX-License-Identifier: GPL-3.0-or-later
// An opening cuts a crest off as it does a roof. What tells them apart is that the ground beside a crest leads up to it without a step,
// which is how a triangulation climbs (Axelsson 2000, "DEM generation from laser scanner data using adaptive TIN models", IAPRS 33): what
// lies on the plane through the ground beside it is ground too, and the next cells are foretold from there. A bridge goes on from its
// banks in the same way, but the surface falls off its plane on both sides.
#include "filters/crests.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>
#include <vector>

#include "filters/inpaint.h"

namespace swath::filters {
namespace {

constexpr Inpainting around{.reach = 10, .relax = 2, .extrapolate = true};
constexpr int away = 3, half = 3;  // cells: the middle of the ground that foretells a cell, and half its width
constexpr int rounds = 3;          // each leads farther by two or three cells
constexpr double fewest = 5.0;     // cells of ground behind a plane
constexpr double roughest = 0.3;   // m, standard deviation about a plane that foretells
constexpr double sigmas = 2.0;     // of the plane's error at the cell: what it must pass above the surface beyond the cut
constexpr double near = 0.3;       // m from the plane, beyond its roughness
constexpr double fall = 0.5, fall_per_run = 0.1;  // m, m per m: below the plane, where the surface falls off it
constexpr double least_spread = 0.05;             // m

constexpr std::array<std::pair<int, int>, 8> directions{{{1, 0}, {0, 1}, {1, 1}, {1, -1}, {-1, 0}, {0, -1}, {-1, -1}, {-1, 1}}};

/// A plane at a cell beside the ground that it goes through.
struct Foretold {
  double height = 0.0, east = 0.0, north = 0.0;  ///< m, rise / run
  double spread = 0.0, error = 0.0;              ///< m: of the ground about the plane, of the plane at the cell
  bool known = false;
};

/// At (i, j), by the ground around (i + di, j + dj).
Foretold foretold(const Raster& ground, int i, int j, int di, int dj) {
  double n = 0, x = 0, y = 0, z = 0, xx = 0, xy = 0, yy = 0, xz = 0, yz = 0, zz = 0, base = 0;
  for (int b = std::max(0, j + dj - half); b <= std::min(ground.ny - 1, j + dj + half); ++b)
    for (int a = std::max(0, i + di - half); a <= std::min(ground.nx - 1, i + di + half); ++a) {
      const double height = ground.value[ground.at(a, b)];
      if (std::isnan(height)) continue;
      if (n == 0) base = height;
      const double u = a - i, v = b - j, w = height - base;
      n += 1, x += u, y += v, z += w, xx += u * u, xy += u * v, yy += v * v, xz += u * w, yz += v * w, zz += w * w;
    }
  if (n < fewest) return {};
  x /= n, y /= n, z /= n;
  xx -= n * x * x, xy -= n * x * y, yy -= n * y * y, xz -= n * x * z, yz -= n * y * z, zz -= n * z * z;
  const double determinant = xx * yy - xy * xy;
  // Cells in a line, or nearly, leave the plane open.
  if (xx < n || yy < n || determinant < 0.05 * xx * yy) return {};
  const double east = (xz * yy - yz * xy) / determinant, north = (yz * xx - xz * xy) / determinant;
  const double spread = std::sqrt(std::max(0.0, zz - east * xz - north * yz) / (n - 3.0));
  const double error = std::hypot(spread, least_spread) * std::sqrt(1.0 / n + (x * x * yy - 2.0 * x * y * xy + y * y * xx) / determinant);
  return {base + z - east * x - north * y, east, north, spread, error, true};
}

/// True where the surface falls off the plane at (i, j) within `most` cells to both sides along (di, dj).
bool falls_off(const Raster& filled, const Foretold& plane, int i, int j, int di, int dj, int most) {
  const double step = std::hypot(di, dj);
  const auto falls = [&](int side) {
    for (int k = 1; k * step <= most; ++k) {
      const int u = side * k * di, v = side * k * dj;
      if (!filled.holds(i + u, j + v)) return false;
      const double height = filled.value[filled.at(i + u, j + v)];
      if (plane.height + plane.east * u + plane.north * v - height > fall + fall_per_run * k * step) return true;
    }
    return false;
  };
  return falls(1) && falls(-1);
}

bool is_object(const Raster& filled, const Foretold& plane, int i, int j, int widest) {
  for (size_t k = 0; k < directions.size() / 2; ++k)
    if (falls_off(filled, plane, i, j, directions[k].first, directions[k].second, widest / 2)) return true;
  return false;
}

}  // namespace

CrestReach crest_reach(const CrestOptions& o) {
  const int grown = (rounds - 1) * (away + half);
  return {grown + std::max(away + half, around.support()), grown + o.widest / 2};
}

void restore_crests(Raster& ground, const Raster& surface, const Raster& filled, const CrestOptions& o) {
  const Raster without = inpaint(ground, around);
  std::vector<size_t> cut_off;
  for (size_t c = 0; c < ground.value.size(); ++c)
    if (std::isnan(ground.value[c]) && surface.value[c] - without.value[c] > o.cut - near - roughest) cut_off.push_back(c);
  const auto is_crest = [&](size_t c) {
    const int i = static_cast<int>(c % static_cast<size_t>(ground.nx)), j = static_cast<int>(c / static_cast<size_t>(ground.nx));
    for (const auto& [di, dj] : directions) {
      const Foretold plane = foretold(ground, i, j, away * di, away * dj);
      if (plane.known && plane.spread <= roughest && std::abs(surface.value[c] - plane.height) <= near + plane.spread &&
          plane.height - without.value[c] > o.cut + sigmas * plane.error && !is_object(filled, plane, i, j, o.widest))
        return true;
    }
    return false;
  };
  for (int k = 0; k < rounds && !cut_off.empty(); ++k) {
    const auto crest = std::partition(cut_off.begin(), cut_off.end(), [&](size_t c) { return !is_crest(c); });
    for (auto c = crest; c != cut_off.end(); ++c) ground.value[*c] = surface.value[*c];
    cut_off.erase(crest, cut_off.end());
  }
}

}  // namespace swath::filters
