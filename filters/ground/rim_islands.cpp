// SPDX-License-Identifier: GPL-3.0-or-later
// A roof that the rim of the data cuts shows one wall or two, or none where higher parts of the house stand behind it: too few to judge it
// by its border (walls.h). But ground does not begin two metres above all other ground without a way up to it. The height of the other
// ground is predicted by a plane through its lowest cells, fitted again without what lies above it (Kraus & Pfeifer 1998 with weights of 0
// and 1). Where the terrain is not a plane the residuals show it.
#include "filters/ground/rim_islands.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <iterator>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "core/statistics.h"
#include "filters/bins.h"

namespace swath::filters {
namespace {

constexpr int outside = 6;                        // cells without return around a cell that is outside
constexpr int rim_width = 2;                      // cells, outermost
constexpr double gap = 3.0;                       // cells to the next return
constexpr double link = 0.6, link_per_run = 0.5;  // m, m per m: step on one surface; lower than a storey over the widest gap
constexpr int around = 40;                        // cells from an island's middle
constexpr int block = 6;                          // cells, whose lowest ground the plane goes through
constexpr size_t fewest = 8;                      // blocks
constexpr int rounds = 4;
constexpr double upper = 1.5, upper_least = 0.5;  // sigmas, m: what lies higher above the plane is left out of the next
constexpr double least_rise = 1.5;                // m: lower steps are kerbs, ramps and garden walls
constexpr double sigmas = 10.0;                   // of the plane's error at the island

constexpr std::array<CellIndex, 8> rays{{{1, 0}, {0, 1}, {1, 1}, {1, -1}, {-1, 0}, {0, -1}, {-1, -1}, {-1, 1}}};

/// 1 in all cells within `half` columns and rows of a cell that has 1.
std::vector<char> spread(std::vector<char> cells, int nx, int ny, int half) {
  const auto along = [&](int n, size_t first, size_t step) {
    std::vector<char> line(static_cast<size_t>(n), 0);
    int last = -half - 1;
    for (int k = 0; k < n + half; ++k) {
      if (k < n && cells[first + static_cast<size_t>(k) * step]) last = k;
      if (k >= half) line[static_cast<size_t>(k - half)] = last >= k - 2 * half;
    }
    for (int k = 0; k < n; ++k) cells[first + static_cast<size_t>(k) * step] = line[static_cast<size_t>(k)];
  };
  for (int j = 0; j < ny; ++j) along(nx, static_cast<size_t>(j) * static_cast<size_t>(nx), 1);
  for (int i = 0; i < nx; ++i) along(ny, static_cast<size_t>(i), static_cast<size_t>(nx));
  return cells;
}

/// The plane height + east dx + north dy.
struct Plane {
  double height = 0.0, east = 0.0, north = 0.0;
  double error = 0.0;  ///< m, standard deviation at the origin of one more datum about the plane

  double at(double x, double y) const { return height + east * x + north * y; }
};

struct Place {
  double x, y, z;  ///< cells from the island's middle; m
};

std::optional<Plane> plane_through(std::span<const Place> places) {
  double n = 0, x = 0, y = 0, z = 0, xx = 0, xy = 0, yy = 0, xz = 0, yz = 0, zz = 0;
  for (const Place& p : places) n += 1, x += p.x, y += p.y, z += p.z;
  x /= n, y /= n, z /= n;
  for (const Place& p : places) {
    const double a = p.x - x, b = p.y - y, c = p.z - z;
    xx += a * a, xy += a * b, yy += b * b, xz += a * c, yz += b * c, zz += c * c;
  }
  const double determinant = xx * yy - xy * xy;
  if (determinant < 0.01 * xx * yy || determinant == 0.0) return std::nullopt;
  const double east = (xz * yy - yz * xy) / determinant, north = (yz * xx - xz * xy) / determinant;
  const double variance = std::max(0.0, zz - east * xz - north * yz) / (n - 3.0);
  const double lever = (x * x * yy - 2.0 * x * y * xy + y * y * xx) / determinant;
  return Plane{z - east * x - north * y, east, north, std::sqrt(variance * (1.0 + 1.0 / n + lever))};
}

/// The same without what lies above it.
std::optional<Plane> lower_plane(std::vector<Place> places) {
  std::optional<Plane> plane;
  std::vector<Place> kept = places;
  for (int round = 0; round < rounds; ++round) {
    if (kept.size() < fewest) return std::nullopt;
    plane = plane_through(kept);
    if (!plane) return std::nullopt;
    double square = 0.0;
    for (const Place& p : kept) square += (p.z - plane->at(p.x, p.y)) * (p.z - plane->at(p.x, p.y));
    const double most = std::max(upper_least, upper * std::sqrt(square / static_cast<double>(kept.size())));
    kept.clear();
    std::copy_if(places.begin(), places.end(), std::back_inserter(kept), [&](const Place& p) { return p.z - plane->at(p.x, p.y) < most; });
  }
  return plane;
}

class Islands {
 public:
  Islands(Raster& ground, const Raster& rim) : ground_(ground), rim_(rim), visited_(ground.value.size(), 0) {}

  void remove() {
    std::vector<std::vector<CellIndex>> found;
    for (int j = 0; j < ground_.ny; ++j)
      for (int i = 0; i < ground_.nx; ++i)
        if (rim_.value[ground_.at(i, j)] > 0.0F && is_ground({i, j}) && !visited_[ground_.at(i, j)])
          if (std::vector<CellIndex> island = island_from({i, j}); !island.empty()) found.push_back(std::move(island));
    // All are judged by the ground as it was.
    found.erase(std::remove_if(found.begin(), found.end(), [&](const auto& island) { return !stands_above(island); }), found.end());
    for (const std::vector<CellIndex>& island : found)
      for (const CellIndex c : island) ground_.value[ground_.at(c.i, c.j)] = std::nanf("");
  }

 private:
  bool has_return(CellIndex c) const { return !std::isnan(rim_.value[ground_.at(c.i, c.j)]); }
  bool is_ground(CellIndex c) const { return has_return(c) && !std::isnan(ground_.value[ground_.at(c.i, c.j)]); }

  /// The cell of ground that a ray from c leads to: its next return is ground and lies on the same surface.
  std::optional<CellIndex> next(CellIndex c, CellIndex ray) const {
    const double run = std::hypot(ray.i, ray.j);
    for (int k = 1; k * run <= gap; ++k) {
      const CellIndex to{c.i + k * ray.i, c.j + k * ray.j};
      if (!ground_.holds(to.i, to.j)) return std::nullopt;
      if (!has_return(to)) continue;
      const double step = std::abs(ground_.value[ground_.at(to.i, to.j)] - ground_.value[ground_.at(c.i, c.j)]);
      if (is_ground(to) && step <= link + link_per_run * k * run) return to;
      return std::nullopt;
    }
    return std::nullopt;
  }

  /// Empty where the ground goes on for longer than an island does.
  std::vector<CellIndex> island_from(CellIndex first) {
    constexpr char queued = 1, wide = 2;
    std::vector<CellIndex> cells{first};
    visited_[ground_.at(first.i, first.j)] = queued;
    int west = first.i, east = first.i, south = first.j, north = first.j;
    bool is_wide = false;
    for (size_t k = 0; k < cells.size() && !is_wide; ++k)
      for (const CellIndex ray : rays) {
        const std::optional<CellIndex> to = next(cells[k], ray);
        if (!to) continue;
        char& visited = visited_[ground_.at(to->i, to->j)];
        is_wide = is_wide || visited == wide;
        if (visited) continue;
        visited = queued;
        cells.push_back(*to);
        west = std::min(west, to->i), east = std::max(east, to->i), south = std::min(south, to->j), north = std::max(north, to->j);
        is_wide = is_wide || std::max(east - west, north - south) >= rim_island_across;
      }
    if (!is_wide) return cells;
    for (const CellIndex c : cells) visited_[ground_.at(c.i, c.j)] = wide;
    return {};
  }

  /// The lowest ground of each block around the island's middle.
  std::vector<Place> lowest_around(const std::vector<CellIndex>& island, CellIndex middle) const {
    constexpr int blocks = 2 * around / block + 1;
    std::array<std::optional<Place>, blocks * blocks> lowest;
    std::vector<size_t> own;
    for (const CellIndex c : island) own.push_back(ground_.at(c.i, c.j));
    std::sort(own.begin(), own.end());
    for (int b = -around; b <= around; ++b)
      for (int a = -around; a <= around; ++a) {
        const CellIndex c{middle.i + a, middle.j + b};
        if (a * a + b * b > around * around || !ground_.holds(c.i, c.j) || !is_ground(c)) continue;
        const size_t at = ground_.at(c.i, c.j);
        std::optional<Place>& low = lowest[static_cast<size_t>((b + around) / block * blocks + (a + around) / block)];
        const double z = ground_.value[at];
        if ((!low || z < low->z) && !std::binary_search(own.begin(), own.end(), at)) low = Place{double(a), double(b), z};
      }
    std::vector<Place> places;
    for (const std::optional<Place>& p : lowest)
      if (p) places.push_back(*p);
    return places;
  }

  bool stands_above(const std::vector<CellIndex>& island) const {
    std::int64_t i = 0, j = 0;
    for (const CellIndex c : island) i += c.i, j += c.j;
    const auto n = static_cast<std::int64_t>(island.size());
    const CellIndex middle{static_cast<int>(i / n), static_cast<int>(j / n)};
    const std::optional<Plane> plane = lower_plane(lowest_around(island, middle));
    if (!plane) return false;
    std::vector<double> rise;
    for (const CellIndex c : island) rise.push_back(ground_.value[ground_.at(c.i, c.j)] - plane->at(c.i - middle.i, c.j - middle.j));
    return core::median(std::move(rise)) >= std::max(least_rise, sigmas * plane->error);
  }

  Raster& ground_;
  const Raster& rim_;
  std::vector<char> visited_;
};

}  // namespace

const int rim_island_support = rim_island_across + around;
const int rim_support = 2 * outside + rim_width;

Raster rim_cells(const Raster& lowest) {
  std::vector<char> near(lowest.value.size());
  for (size_t c = 0; c < near.size(); ++c) near[c] = !std::isnan(lowest.value[c]);
  near = spread(std::move(near), lowest.nx, lowest.ny, outside);
  for (char& c : near) c = !c;
  const std::vector<char> rim = spread(std::move(near), lowest.nx, lowest.ny, outside + rim_width);
  Raster out = lowest;
  for (size_t c = 0; c < rim.size(); ++c)
    if (!std::isnan(out.value[c])) out.value[c] = rim[c] ? 1.0F : 0.0F;
  return out;
}

void remove_rim_islands(Raster& ground, const Raster& rim) { Islands(ground, rim).remove(); }

}  // namespace swath::filters
