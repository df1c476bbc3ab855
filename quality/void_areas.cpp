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

/// What the survey covers, on footprint cells: a bit for each, for a corridor's box is nearly empty and may have 10^8.
struct Footprint {
  core::Lattice lattice;
  std::vector<bool> covered;
  bool holds(std::int64_t i, std::int64_t j) const {
    i -= lattice.i0, j -= lattice.j0;
    return i >= 0 && j >= 0 && i < lattice.nx && j < lattice.ny && covered[lattice.at(static_cast<int>(i), static_cast<int>(j))];
  }
};

/// Closing by a disc of `reach` cells, of a lattice whose cells that near to the border are not covered. In bands of rows, with as many on
/// either side as a cell of the band may depend on.
void close_gaps(Footprint& f, double reach) {
  constexpr int band = 256;
  const int nx = f.lattice.nx, ny = f.lattice.ny, halo = 2 * (static_cast<int>(reach) + 2);
  std::vector<bool> closed = f.covered;
  for (int a = 0; a < ny; a += band) {
    const int b = std::min(ny, a + band), first = std::max(0, a - halo), last = std::min(ny, b + halo);
    std::vector<std::uint8_t> mask(static_cast<size_t>(nx) * static_cast<size_t>(last - first));
    const size_t offset = f.lattice.at(0, first);
    for (size_t c = 0; c < mask.size(); ++c) mask[c] = f.covered[offset + c];
    if (std::find(mask.begin(), mask.end(), 1) == mask.end()) continue;
    std::vector<float> d = squared_distances(mask, nx, last - first);
    for (size_t c = 0; c < mask.size(); ++c) mask[c] = static_cast<double>(d[c]) > reach * reach;
    d = squared_distances(mask, nx, last - first);
    for (size_t c = f.lattice.at(0, a) - offset; c < f.lattice.at(0, b) - offset; ++c)
      if (static_cast<double>(d[c]) > reach * reach) closed[offset + c] = true;
  }
  f.covered.swap(closed);
}

/// Covers what is not joined to the lattice's border, where nothing is covered.
void fill_enclosed(Footprint& f) {
  std::vector<VoidRun> empty;  // of cells, row by row
  for (int j = 0; j < f.lattice.ny; ++j)
    for (int i = 0; i < f.lattice.nx; ++i) {
      if (f.covered[f.lattice.at(i, j)]) continue;
      if (empty.empty() || empty.back().j != j || empty.back().i1 != i) empty.push_back({j, i, i});
      ++empty.back().i1;
    }
  const std::vector<std::vector<size_t>> groups = joined_runs(empty);
  for (const std::vector<size_t>& group : groups) {
    if (group.front() == 0) continue;  // with the lattice's first row
    for (const size_t k : group)
      for (int i = empty[k].i0; i < empty[k].i1; ++i) f.covered[f.lattice.at(i, empty[k].j)] = true;
  }
}

/// Leaves out the cells beside one that is not covered, across a corner, too.
void shrink(Footprint& f) {
  const int nx = f.lattice.nx, ny = f.lattice.ny;
  std::vector<bool> out(f.covered.size(), false);
  for (int j = 1; j + 1 < ny; ++j) {
    int run = 0;  // columns that are covered in all three rows, up to this one
    for (int i = 0; i < nx; ++i) {
      const bool all = f.covered[f.lattice.at(i, j - 1)] && f.covered[f.lattice.at(i, j)] && f.covered[f.lattice.at(i, j + 1)];
      run = all ? run + 1 : 0;
      if (run >= 3) out[f.lattice.at(i - 1, j)] = true;
    }
  }
  f.covered.swap(out);
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
  f.covered.assign(f.lattice.size(), false);
  for (const FootprintCell& c : cells)
    f.covered[f.lattice.at(static_cast<int>(c.i - f.lattice.i0), static_cast<int>(c.j - f.lattice.j0))] = true;
  if (reach >= 0.5) close_gaps(f, reach);
  fill_enclosed(f);
  shrink(f);
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
  out.judged = static_cast<double>(std::count(f.covered.begin(), f.covered.end(), true)) * side * side;
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
