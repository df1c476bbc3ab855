// SPDX-License-Identifier: GPL-3.0-or-later
#include "quality/void_areas.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>

#include "core/floor_div.h"
#include "quality/distances.h"
#include "quality/outlines.h"
#include "quality/pulse_density.h"

namespace swath::quality {
namespace {

constexpr int cells_a_side = 64;    // of a footprint cell
constexpr double rule_side = 16.0;  // void cells: (4 ANPS)^2 in cells of a quarter of it

/// What the survey covers, on footprint cells.
struct Footprint {
  core::Lattice lattice;
  std::vector<std::uint8_t> covered;
  bool holds(std::int64_t i, std::int64_t j) const {
    i -= lattice.i0, j -= lattice.j0;
    return i >= 0 && j >= 0 && i < lattice.nx && j < lattice.ny && covered[lattice.at(static_cast<int>(i), static_cast<int>(j))] != 0;
  }
};

/// Cells that are not covered and are joined to the lattice's border, where nothing is covered.
std::vector<std::uint8_t> outside_of(const Footprint& f) {
  std::vector<std::uint8_t> out(f.covered.size(), 0);
  std::vector<std::pair<int, int>> open{{0, 0}};
  out[0] = 1;
  while (!open.empty()) {
    const auto [i, j] = open.back();
    open.pop_back();
    for (const auto& [di, dj] : {std::pair{1, 0}, {-1, 0}, {0, 1}, {0, -1}}) {
      const int u = i + di, v = j + dj;
      if (!f.lattice.holds(u, v)) continue;
      const size_t c = f.lattice.at(u, v);
      if (f.covered[c] || out[c]) continue;
      out[c] = 1;
      open.push_back({u, v});
    }
  }
  return out;
}

/// A closing by a disc as wide as the widest gap, with what it encloses, without its outermost cells.
Footprint footprint_around(const std::vector<FootprintCell>& cells, double side, double max_gap) {
  Footprint f;
  if (cells.empty()) return f;
  const double reach = 0.5 * max_gap / side;
  const auto [west, east] = std::minmax_element(cells.begin(), cells.end(), [](const auto& a, const auto& b) { return a.i < b.i; });
  const auto [south, north] = std::minmax_element(cells.begin(), cells.end(), [](const auto& a, const auto& b) { return a.j < b.j; });
  const int rim = static_cast<int>(reach) + 3;
  f.lattice = {side, west->i - rim, south->j - rim, east->i - west->i + 1 + 2 * rim, north->j - south->j + 1 + 2 * rim};
  f.covered.assign(f.lattice.size(), 0);
  for (const FootprintCell& c : cells)
    f.covered[f.lattice.at(static_cast<int>(c.i - f.lattice.i0), static_cast<int>(c.j - f.lattice.j0))] = 1;
  const int nx = f.lattice.nx, ny = f.lattice.ny;
  if (reach >= 0.5) {
    std::vector<float> d = squared_distances(f.covered, nx, ny);
    std::vector<std::uint8_t> beyond(d.size());
    for (size_t c = 0; c < d.size(); ++c) beyond[c] = static_cast<double>(d[c]) > reach * reach;
    d = squared_distances(beyond, nx, ny);
    for (size_t c = 0; c < d.size(); ++c) f.covered[c] |= static_cast<double>(d[c]) > reach * reach;
  }
  const std::vector<float> to_outside = squared_distances(outside_of(f), nx, ny);
  for (size_t c = 0; c < to_outside.size(); ++c) f.covered[c] = to_outside[c] > 2.0F;  // farther than a neighbour across a corner
  return f;
}

/// The runs within the footprint, joined where they touch.
std::vector<VoidRun> cut_runs(std::vector<VoidRun> runs, const Footprint& f) {
  std::sort(runs.begin(), runs.end());
  std::vector<VoidRun> out;
  for (const VoidRun& r : runs) {
    bool first = true;
    for (std::int32_t i0 = r.i0; i0 < r.i1;) {
      const std::int64_t column = core::floor_div(i0, cells_a_side);
      const auto end = static_cast<std::int32_t>(std::min<std::int64_t>(r.i1, (column + 1) * cells_a_side));
      if (f.holds(column, core::floor_div(r.j, cells_a_side))) {
        if (!out.empty() && out.back().j == r.j && out.back().i1 >= i0)
          out.back().i1 = std::max(out.back().i1, end);
        else
          out.push_back({r.j, i0, end});
        VoidRun& to = out.back();
        const double share = static_cast<double>(end - i0) / (r.i1 - r.i0);
        to.water += static_cast<std::uint32_t>(std::lround(share * r.water));
        if (first) to.rim += r.rim, to.rim_water += r.rim_water;
        first = false;
      }
      i0 = end;
    }
  }
  return out;
}

/// All cells of a box without points, where any of it is covered. Near its border returns of its neighbours would make the void smaller, by
/// a few spacings.
void add_box(const core::Box& box, const Footprint& f, double cell, std::vector<VoidRun>& runs) {
  const core::Lattice in_footprint = core::lattice_of(f.lattice.cell, box.x0, box.y0, box.x1, box.y1);
  bool any = false;
  for (int j = 0; j < in_footprint.ny && !any; ++j)
    for (int i = 0; i < in_footprint.nx && !any; ++i) any = f.holds(in_footprint.i0 + i, in_footprint.j0 + j);
  if (!any) return;
  const auto index = [cell](double v) { return static_cast<std::int32_t>(core::cell_index(v, cell)); };
  for (std::int32_t j = index(box.y0); j < index(box.y1); ++j) runs.push_back({j, index(box.x0), index(box.x1)});
}

/// Numbers of runs that are joined through neighbouring rows.
std::vector<std::vector<size_t>> joined_runs(const std::vector<VoidRun>& runs) {
  std::vector<size_t> parent(runs.size());
  std::iota(parent.begin(), parent.end(), size_t{0});
  const auto root = [&parent](size_t k) {
    while (parent[k] != k) k = parent[k] = parent[parent[k]];
    return k;
  };
  size_t below = 0;
  for (size_t k = 0; k < runs.size(); ++k) {
    while (below < k && (runs[below].j < runs[k].j - 1 || (runs[below].j == runs[k].j - 1 && runs[below].i1 <= runs[k].i0))) ++below;
    for (size_t n = below; n < k && runs[n].j == runs[k].j - 1 && runs[n].i0 < runs[k].i1; ++n)
      if (const size_t a = root(n), b = root(k); a != b) parent[std::max(a, b)] = std::min(a, b);
  }
  std::map<size_t, std::vector<size_t>> groups;
  for (size_t k = 0; k < runs.size(); ++k) groups[root(k)].push_back(k);
  std::vector<std::vector<size_t>> out;
  for (auto& [first, group] : groups) out.push_back(std::move(group));
  return out;
}

VoidArea area_of_runs(const std::vector<VoidRun>& runs, double cell) {
  VoidArea out;
  double cells = 0.0, rim = 0.0, rim_water = 0.0, water = 0.0;
  for (const VoidRun& r : runs) {
    const double n = r.i1 - r.i0;
    cells += n, rim += r.rim, rim_water += r.rim_water, water += r.water;
    out.x += n * 0.5 * (r.i0 + r.i1) * cell, out.y += n * (r.j + 0.5) * cell;
  }
  out.x /= cells, out.y /= cells;
  out.area = cells * cell * cell;
  if (water >= 0.5 * cells)
    out.water = WaterBy::known;
  else if (rim > 0.0 && rim_water >= 0.5 * rim)
    out.water = WaterBy::points;
  return out;
}

/// The pieces of each group of runs; `runs` rise.
std::vector<std::vector<RimPiece>> rims_by_group(const std::vector<RimPiece>& rims, const std::vector<VoidRun>& runs,
                                                 const std::vector<std::vector<size_t>>& groups) {
  std::vector<size_t> group_of(runs.size(), 0);
  for (size_t g = 0; g < groups.size(); ++g)
    for (const size_t k : groups[g]) group_of[k] = g;
  std::vector<std::vector<RimPiece>> out(groups.size());
  for (const RimPiece& p : rims) {
    const auto next = std::upper_bound(runs.begin(), runs.end(), p, [](const RimPiece& a, const VoidRun& r) {
      return std::pair(a.void_j, a.void_i) < std::pair(r.j, r.i0);
    });
    if (next == runs.begin()) continue;
    const auto at = std::prev(next);
    if (at->j == p.void_j && at->i1 > p.void_i) out[group_of[static_cast<size_t>(at - runs.begin())]].push_back(p);
  }
  return out;
}

}  // namespace

std::string VoidArea::evidence() const {
  return is_water() ? std::string(core::Choices<WaterBy>::names[static_cast<size_t>(water)]) : std::string();
}

std::vector<FootprintCell> footprint_of(const core::Block& b, size_t own, const PulseSpacing& spacing) {
  std::vector<FootprintCell> out;
  const double side = footprint_cell(spacing);
  for (size_t p = 0; p < own; ++p) {
    if (!is_first(b, p)) continue;
    const FootprintCell cell{static_cast<std::int32_t>(core::cell_index(b.origin.x() + b.x[p], side)),
                             static_cast<std::int32_t>(core::cell_index(b.origin.y() + b.y[p], side))};
    if (out.empty() || out.back() != cell) out.push_back(cell);
  }
  std::sort(out.begin(), out.end());
  out.erase(std::unique(out.begin(), out.end()), out.end());
  return out;
}

SwathVoids judge_voids(std::vector<VoidRun> runs, const std::vector<FootprintCell>& cells, const std::vector<core::Box>& without_points,
                       const PulseSpacing& spacing, double max_gap, const std::vector<RimPiece>& rims) {
  const double cell = void_cell(spacing), side = footprint_cell(spacing);
  const Footprint f = footprint_around(cells, side, max_gap);
  SwathVoids out;
  out.least = rule_side * rule_side * cell * cell;
  out.judged = static_cast<double>(std::count(f.covered.begin(), f.covered.end(), 1)) * side * side;
  for (const core::Box& box : without_points) add_box(box, f, cell, runs);
  const std::vector<VoidRun> all = cut_runs(std::move(runs), f);
  const std::vector<std::vector<size_t>> groups = joined_runs(all);
  std::vector<std::vector<RimPiece>> pieces = rims_by_group(rims, all, groups);
  for (size_t g = 0; g < groups.size(); ++g) {
    std::vector<VoidRun> mine;
    for (const size_t k : groups[g]) mine.push_back(all[k]);
    VoidArea v = area_of_runs(mine, cell);
    if (v.area < out.least) continue;
    if (!v.is_water() && is_shore(std::move(pieces[g]))) v.water = WaterBy::shore;
    v.rings = outlines_of(mine);
    for (auto& ring : v.rings)
      for (Eigen::Vector2d& corner : ring) corner *= cell;
    (v.is_water() ? out.water_area : out.area) += v.area;
    out.voids.push_back(std::move(v));
  }
  std::stable_sort(out.voids.begin(), out.voids.end(), [](const VoidArea& a, const VoidArea& b) { return a.area > b.area; });
  return out;
}

}  // namespace swath::quality
