// SPDX-License-Identifier: GPL-3.0-or-later
// A surface is grown from cell to cell over steps that ground and roofs both have, and is judged by all of its border: a roof ends at walls
// on every side, ground goes on somewhere. An opening by a disk (Pingel et al. 2013) judges by width alone, so that a hall wider than the
// disk stays, and a roof cut by the rim of the data too, because nothing beyond the rim stops the disk. The border decides in place of the
// width as in Sithole & Vosselman 2005, "Filtering of airborne laser scanner data based on segmented point clouds", IAPRS 36. Deviation:
// only cells whose whole neighbourhood lies on the surface lead on, so that a hedge or a tree at an eave is not a way down.
#include "filters/ground/walls.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numeric>
#include <vector>

#include "core/wide.h"

namespace swath::filters {
namespace {

constexpr int gap = 4;                             // cells without return to the next on a surface: one return per 5 m2 suffices
constexpr int facade = 3;                          // cells within which a wall comes down
constexpr int beyond_rim = 10;                     // cells without return: the rim of the data
constexpr double link = 0.6, link_per_run = 0.6;   // m, m per m: step on one surface
constexpr double wall = 1.2, wall_per_run = 0.6;   // m, m per m: what falls by more falls along a wall
constexpr double walled = 0.7;                     // share of walls in the border that is seen
constexpr double cut = 0.1;                        // share of the border at the rim from which the rim cuts it
constexpr double beside_higher = 0.3;              // walls per ray that ends at something higher: what stands beside it decides nothing
constexpr double most_walled = 0.45;               // share of walls in all of the border; a straight rim leaves a hall more than a half
constexpr double doubtful = 0.5;                   // the same of a surface that stays and is reported
constexpr double one_sided = 0.7, opposite = 0.8;  // of a terrace: the mean of its walls' directions, and how far uphill is against it
constexpr int fewest = 4;                          // cells that lead on

struct Ray {
  int i, j;
  double run;  ///< cells per step
};
constexpr double diagonal = 1.4142135623730951;
constexpr std::array<Ray, 8> rays{
    {{1, 0, 1.0}, {0, 1, 1.0}, {1, 1, diagonal}, {1, -1, diagonal}, {-1, 0, 1.0}, {0, -1, 1.0}, {-1, -1, diagonal}, {-1, 1, diagonal}}};

double tolerance(double run) { return link + link_per_run * run; }
/// No float lies between this and the value.
float float_up_to(double v) {
  const auto f = static_cast<float>(v);
  return static_cast<double>(f) > v ? std::nextafter(f, 0.0F) : f;
}

/// 1 where a cell's step to all eight cells around is at most `side`, `corner`; 0 where one of them has no value. Rows of n + 2 cells, from
/// the one before.
SWATH_WIDE void linked_all_around(const float* south, const float* row, const float* north, std::int32_t* all, int n, float side,
                                  float corner) {
  for (int i = 0; i < n; ++i) {
    const float z = row[i + 1];
    const auto near = [z](float v, float step) { return static_cast<std::int32_t>(std::abs(v - z) <= step); };
    all[i] = near(row[i], side) & near(row[i + 2], side) & near(south[i + 1], side) & near(north[i + 1], side) & near(south[i], corner) &
             near(south[i + 2], corner) & near(north[i], corner) & near(north[i + 2], corner);
  }
}

/// 1 where all eight cells around lie on the cell's surface.
SWATH_WIDE void alike_all_around(const std::uint32_t* south, const std::uint32_t* row, const std::uint32_t* north, std::int32_t* all,
                                 int n) {
  for (int i = 0; i < n; ++i) {
    const std::uint32_t on = row[i + 1];
    all[i] = (row[i] == on) & (row[i + 2] == on) & (south[i] == on) & (south[i + 1] == on) & (south[i + 2] == on) & (north[i] == on) &
             (north[i + 1] == on) & (north[i + 2] == on);
  }
}

/// Rays in each direction.
using Directions = std::array<int, rays.size()>;

/// The border of one surface.
struct Border {
  int cells = 0, west = 0, east = 0, south = 0, north = 0;
  int walls = 0, open = 0, higher = 0, rim = 0, pits = 0;  ///< rays that leave it
  Directions walls_to{}, higher_to{};
  bool any = false;
  double falls = 0;                                          ///< m, sum over the walls
  std::int64_t n = 0, i = 0, j = 0, ii = 0, jj = 0, ij = 0;  ///< sums over all its cells
  void add(std::int64_t x, std::int64_t y) { ++n, i += x, j += y, ii += x * x, jj += y * y, ij += x * y; }
  int across() const { return std::max(east - west, north - south) + 1; }
};

class Surfaces {
 public:
  Surfaces(const Raster& lowest, double cell)
      : cell_(cell), z_(lowest), parent_(lowest.value.size()), leads_(lowest.value.size(), 0), on_(lowest.value.size(), none) {
    std::iota(parent_.begin(), parent_.end(), 0U);
    const float side = float_up_to(tolerance(cell)), corner = float_up_to(tolerance(diagonal * cell));
    const auto linked = [&](size_t south, size_t row, size_t north, std::int32_t* all, int n) {
      linked_all_around(z_.value.data() + south, z_.value.data() + row, z_.value.data() + north, all, n, side, corner);
    };
    for_each(linked, [&](int i, int j, size_t c, bool all) { leads_[c] = all || leads(i, j, c); });
    for_each([&](int i, int j, size_t c) { join(i, j, c); });
    for_each([&](int, int, size_t c) {
      if (!leads_[c]) return;
      const std::uint32_t first = root(static_cast<std::uint32_t>(c));
      on_[c] = first == c ? count_++ : on_[first];
    });
    for_each([&](int i, int j, size_t c) {
      if (!leads_[c]) on_[c] = nearest(i, j, c);
    });
  }

  /// Number of the surface that a cell lies on; `none` where it lies on none.
  std::uint32_t of(size_t c) const { return on_[c]; }
  std::vector<Border> borders() const;
  /// The cell of surface `on` next to the hill's middle; the southernmost, then westernmost of those as near.
  void find_middle(WalledHill& hill, std::uint32_t on, const Border& b) const;

  static constexpr std::uint32_t none = 0xffffffffU;

 private:
  struct Next {
    size_t cell;
    double run;  ///< m; 0 where nothing is within the gap
  };

  template <class Take>
  void for_each(const Take& take) const {
    for (int j = 0; j < z_.ny; ++j)
      for (int i = 0; i < z_.nx; ++i)
        if (const size_t c = z_.at(i, j); !std::isnan(z_.value[c])) take(i, j, c);
  }

  /// The same with take(i, j, c, all); `all`: what flag(south, row, north, all, n) finds of the cells with all eight around them.
  template <class Flag, class Take>
  void for_each(const Flag& flag, const Take& take) const {
    std::vector<std::int32_t> all(static_cast<size_t>(z_.nx), 0);
    for (int j = 0; j < z_.ny; ++j) {
      const bool inside = j > 0 && j + 1 < z_.ny && z_.nx > 2;
      if (inside) flag(z_.at(0, j - 1), z_.at(0, j), z_.at(0, j + 1), all.data() + 1, z_.nx - 2);
      for (int i = 0; i < z_.nx; ++i)
        if (const size_t c = z_.at(i, j); !std::isnan(z_.value[c])) take(i, j, c, inside && all[static_cast<size_t>(i)]);
    }
  }

  Next next(int i, int j, const Ray& r, int within = gap) const {
    if (i >= within && j >= within && i + within < z_.nx && j + within < z_.ny) {
      const std::ptrdiff_t step = std::ptrdiff_t{r.j} * z_.nx + r.i;
      const float* at = z_.value.data() + z_.at(i, j);
      for (int k = 1; k <= within; ++k)
        if (!std::isnan(at[k * step])) return {z_.at(i + k * r.i, j + k * r.j), k * r.run * cell_};
      return {0, 0.0};
    }
    for (int k = 1; k <= within && z_.holds(i + k * r.i, j + k * r.j); ++k)
      if (const size_t c = z_.at(i + k * r.i, j + k * r.j); !std::isnan(z_.value[c])) return {c, k * r.run * cell_};
    return {0, 0.0};
  }

  bool linked(size_t a, const Next& b) const { return std::abs(z_.value[a] - z_.value[b.cell]) <= tolerance(b.run); }

  bool leads(int i, int j, size_t c) const {
    int seen = 0;
    for (const Ray& r : rays) {
      const Next n = next(i, j, r);
      if (n.run == 0.0) continue;
      if (!linked(c, n)) return false;
      ++seen;
    }
    return seen >= 3;
  }

  std::uint32_t root(std::uint32_t c) {
    while (parent_[c] != c) c = parent_[c] = parent_[parent_[c]];
    return c;
  }

  void join(int i, int j, size_t c) {
    if (!leads_[c]) return;
    for (size_t k = 0; k < rays.size() / 2; ++k) {
      const Next n = next(i, j, rays[k]);
      if (n.run == 0.0 || !leads_[n.cell]) continue;
      const std::uint32_t a = root(static_cast<std::uint32_t>(c)), b = root(static_cast<std::uint32_t>(n.cell));
      parent_[std::max(a, b)] = std::min(a, b);
    }
  }

  /// Of the surfaces beside a cell that does not lead on, the one of the smallest step.
  std::uint32_t nearest(int i, int j, size_t c) const {
    std::uint32_t best = none;
    float least = 0.0F;
    for (const Ray& r : rays) {
      const Next n = next(i, j, r);
      if (n.run == 0.0 || !leads_[n.cell] || !linked(c, n)) continue;
      const float step = std::abs(z_.value[c] - z_.value[n.cell]);
      if (best == none || step < least) best = on_[n.cell], least = step;
    }
    return best;
  }

  void leave(Border& b, int i, int j, size_t c, size_t direction) const;

  double cell_;  ///< m
  const Raster& z_;
  std::vector<std::uint32_t> parent_;
  std::vector<char> leads_;
  std::vector<std::uint32_t> on_;
  std::uint32_t count_ = 0;
};

/// One ray from a cell of the surface.
void Surfaces::leave(Border& b, int i, int j, size_t c, size_t direction) const {
  const Ray& r = rays[direction];
  const Next n = next(i, j, r, beyond_rim);
  if (n.run == 0.0) {
    ++b.rim;
    return;
  }
  if (on_[n.cell] == on_[c]) return;
  for (int k = 1; k <= std::max(facade, static_cast<int>(std::lround(n.run / (r.run * cell_)))); ++k) {
    if (!z_.holds(i + k * r.i, j + k * r.j)) break;
    const size_t other = z_.at(i + k * r.i, j + k * r.j);
    if (z_.value[c] - z_.value[other] > wall + wall_per_run * k * r.run * cell_) {
      if (on_[other] == none) {
        ++b.pits;
        return;
      }
      ++b.walls, ++b.walls_to[direction];
      b.falls += static_cast<double>(z_.value[c] - z_.value[other]);
      return;
    }
  }
  const double rise = z_.value[n.cell] - z_.value[c];
  // A cell on no surface is an edge, a chimney or a bush: it leads nowhere.
  if (rise > tolerance(n.run))
    ++b.higher, ++b.higher_to[direction];
  else
    b.open += on_[n.cell] != none;
}

std::vector<Border> Surfaces::borders() const {
  std::vector<Border> all(count_);
  const auto alike = [&](size_t south, size_t row, size_t north, std::int32_t* flags, int n) {
    alike_all_around(on_.data() + south, on_.data() + row, on_.data() + north, flags, n);
  };
  for_each(alike, [&](int i, int j, size_t c, bool inside) {
    if (on_[c] == none) return;
    Border& b = all[on_[c]];
    if (!b.any) b.any = true, b.west = b.east = i, b.south = b.north = j;
    b.west = std::min(b.west, i), b.east = std::max(b.east, i), b.south = std::min(b.south, j), b.north = std::max(b.north, j);
    b.cells += leads_[c];
    b.add(i, j);
    if (inside) return;
    for (size_t k = 0; k < rays.size(); ++k) leave(b, i, j, c, k);
  });
  return all;
}

/// The mean of the rays' directions: of length 1 where all are the same.
std::array<double, 2> mean(const Directions& to) {
  double n = 0, east = 0, north = 0;
  for (size_t k = 0; k < to.size(); ++k) n += to[k], east += to[k] * rays[k].i / rays[k].run, north += to[k] * rays[k].j / rays[k].run;
  return {east / n, north / n};
}

/// A step of a slope: it falls along walls to one side, and on the opposite one the slope goes on above it, along as much of its border.
bool is_terrace(const Border& b) {
  if (b.higher < b.walls || b.rim > cut * (b.walls + b.open + b.rim)) return false;
  const auto [east, north] = mean(b.walls_to);
  const auto [up_east, up_north] = mean(b.higher_to);
  const double steep = std::hypot(east, north);
  return steep >= one_sided && -(east * up_east + north * up_north) >= opposite * steep * std::hypot(up_east, up_north);
}

bool may_be_object(const Border& b) {
  return b.walls > 0 && b.pits <= 3 * b.walls && b.cells >= fewest && b.walls >= beside_higher * b.higher && !is_terrace(b);
}

bool is_object(const Border& b, const WallOptions& o) {
  const int seen = b.walls + b.open, all = seen + b.rim;
  if (!may_be_object(b) || b.across() > o.longest || b.walls < walled * seen) return false;
  return b.rim <= cut * all || b.walls >= most_walled * all || (b.walls >= o.walled_at_rim * all && b.across() <= 2 * o.widest);
}

/// The rectangle with the surface's moments; its cell next to the middle is still to be found.
WalledHill hill_of(const Border& b) {
  const auto n = static_cast<double>(b.n);
  const double east = static_cast<double>(b.i) / n, north = static_cast<double>(b.j) / n;
  const double ii = static_cast<double>(b.ii) / n - east * east, jj = static_cast<double>(b.jj) / n - north * north,
               ij = static_cast<double>(b.ij) / n - east * north;
  const double middle = 0.5 * (ii + jj), off = std::hypot(0.5 * (ii - jj), ij);
  const auto side = [](double variance) { return std::sqrt(12.0 * std::max(0.0, variance)); };
  return {-1, -1, 0.0F, b.falls / b.walls, east + 0.5, north + 0.5, side(middle + off), side(middle - off)};
}

bool is_doubtful(const Border& b, const WallOptions& o) {
  const int seen = b.walls + b.open;
  return may_be_object(b) && b.across() <= o.farthest && b.walls >= doubtful * seen && b.walls >= most_walled * (seen + b.rim);
}

void Surfaces::find_middle(WalledHill& hill, std::uint32_t on, const Border& b) const {
  double nearest = std::numeric_limits<double>::infinity();
  for (int j = b.south; j <= b.north; ++j)
    for (int i = b.west; i <= b.east; ++i) {
      if (on_[z_.at(i, j)] != on) continue;
      const double d = std::hypot(i + 0.5 - hill.east, j + 0.5 - hill.north);
      if (d < nearest) nearest = d, hill.i = i, hill.j = j, hill.height = z_.value[z_.at(i, j)];
    }
}

}  // namespace

int wall_support(const WallOptions& o) { return o.longest > 0 ? o.longest + 2 * gap + beyond_rim : 0; }

std::vector<WalledHill> remove_walled(Raster& lowest, const WallOptions& o) {
  if (o.longest == 0) return {};
  const Surfaces surfaces(lowest, o.cell);
  const std::vector<Border> borders = surfaces.borders();
  std::vector<WalledHill> hills;
  std::vector<std::uint32_t> number;
  for (std::uint32_t k = 0; k < borders.size(); ++k) {
    if (is_object(borders[k], o) || !is_doubtful(borders[k], o)) continue;
    if (const WalledHill hill = hill_of(borders[k]); hill.width > 0.5 * o.widest) hills.push_back(hill), number.push_back(k);
  }
  for (size_t k = 0; k < hills.size(); ++k) surfaces.find_middle(hills[k], number[k], borders[number[k]]);
  for (size_t c = 0; c < lowest.value.size(); ++c)
    if (const std::uint32_t on = surfaces.of(c); on != Surfaces::none && is_object(borders[on], o)) lowest.value[c] = std::nanf("");
  return hills;
}

}  // namespace swath::filters
