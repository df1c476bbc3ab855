// SPDX-License-Identifier: GPL-3.0-or-later
// An opening of the empty space by a disc, on cells of a quarter of the spacing, by exact distances. A square of (4 ANPS)^2 (USGS Lidar
// Base Specification, data voids) holds such a disc; that a void has this area is judged when the tiles are joined (quality/void_areas.h).
#include "quality/void_cells.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "core/floor_div.h"
#include "quality/distances.h"
#include "quality/pulse_density.h"

namespace swath::quality {
namespace {

constexpr int disc = 8;            // radius of 2 ANPS in cells
constexpr int empty_block = 5;     // cells: a disc without returns holds a whole block of this side
constexpr int around_window = 24;  // cells: twice the disc, and the reach of what lies beside a void
constexpr double gap = 0.55;       // of the spacing, from the outermost returns to the void's edge
constexpr double beside = 6.0;     // cells: a first return this near to a void lies on its rim

constexpr std::uint8_t has_return = 1, has_water = 3;  // bits: a return of class water is a return
constexpr int block_cells = 1024;  // voids are looked for in squares of this side, so that their distances need little memory

struct Mask {
  core::Lattice lattice;
  std::vector<std::uint8_t> set;
  explicit Mask(const core::Lattice& l) : lattice(l), set(l.size(), 0) {}
};

/// Cell of a point, false outside the lattice.
bool cell_of(const core::Block& b, size_t p, const core::Lattice& l, int& i, int& j) {
  const std::int64_t u = core::cell_index(b.origin.x() + b.x[p], l.cell) - l.i0, v = core::cell_index(b.origin.y() + b.y[p], l.cell) - l.j0;
  if (u < 0 || v < 0 || u >= l.nx || v >= l.ny) return false;
  i = static_cast<int>(u), j = static_cast<int>(v);
  return true;
}

/// A first return of a window, by the square of block_cells that holds it.
struct PlacedReturn {
  std::uint32_t square;
  std::int32_t i, j;  ///< cell, from the window's corner
  std::uint8_t kind;
};

/// The squares of a window in rows, with a ring of them around it.
struct Squares {
  int across;
  explicit Squares(const core::Lattice& window) : across((window.nx + block_cells - 1) / block_cells + 2) {}
  std::uint32_t at(int column, int row) const { return static_cast<std::uint32_t>((row + 1) * across + column + 1); }
};

std::vector<PlacedReturn> placed_returns(const core::Block& b, const core::Lattice& window, const core::Lattice& around) {
  const Squares squares(window);
  std::vector<PlacedReturn> out;
  int i = 0, j = 0;
  for (size_t p = 0; p < b.size(); ++p) {
    if (!is_first(b, p) || !cell_of(b, p, around, i, j)) continue;
    i -= around_window, j -= around_window;
    const bool is_water = !b.classification.empty() && b.classification[p] == core::point_class::water;
    const auto square = [](int cell) { return static_cast<int>(core::floor_div(cell, block_cells)); };
    out.push_back({squares.at(square(i), square(j)), i, j, is_water ? has_water : has_return});
  }
  std::sort(out.begin(), out.end(), [](const PlacedReturn& a, const PlacedReturn& c) { return a.square < c.square; });
  return out;
}

/// The returns of a square and around_window farther.
Mask mask_of(const std::vector<PlacedReturn>& returns, const core::Lattice& window, int column, int row, const core::Lattice& lattice) {
  const Squares squares(window);
  Mask out(lattice);
  for (int v = row - 1; v <= row + 1; ++v)
    for (int u = column - 1; u <= column + 1; ++u) {
      const std::uint32_t square = squares.at(u, v);
      auto at =
          std::lower_bound(returns.begin(), returns.end(), square, [](const PlacedReturn& r, std::uint32_t s) { return r.square < s; });
      for (; at != returns.end() && at->square == square; ++at) {
        const auto i = static_cast<int>(window.i0 + at->i - lattice.i0), j = static_cast<int>(window.j0 + at->j - lattice.j0);
        if (lattice.holds(i, j)) out.set[lattice.at(i, j)] |= at->kind;
      }
    }
  return out;
}

core::Lattice grown(const core::Lattice& l, int by) { return {l.cell, l.i0 - by, l.j0 - by, l.nx + 2 * by, l.ny + 2 * by}; }

/// Is there a square block of cells without returns? Without one no disc is empty, and no distance need be known.
bool has_empty_block(const Mask& m) {
  const core::Lattice& l = m.lattice;
  std::vector<std::uint8_t> blocks(static_cast<size_t>(l.nx / empty_block + 1) * static_cast<size_t>(l.ny / empty_block + 1), 0);
  const auto at = [&](int i, int j) {
    return static_cast<size_t>(j / empty_block) * static_cast<size_t>(l.nx / empty_block + 1) + static_cast<size_t>(i / empty_block);
  };
  for (int j = 0; j < l.ny; ++j)
    for (int i = 0; i < l.nx; ++i) blocks[at(i, j)] |= m.set[l.at(i, j)];
  for (int j = 0; j + empty_block <= l.ny; j += empty_block)
    for (int i = 0; i + empty_block <= l.nx; i += empty_block)
      if (!blocks[at(i, j)]) return true;
  return false;
}

Mask void_mask(const Mask& returns, const PulseSpacing& spacing) {
  const core::Lattice& l = returns.lattice;
  Mask out(l);
  std::vector<std::uint8_t> centres = cells_within(returns.set, l.nx, l.ny, disc);
  for (std::uint8_t& c : centres) c = !c;
  // The outermost returns fill their cell, half of which belongs to the gap already.
  // Of points far sparser than the rule nothing is taken back: all that a disc of it does not find covered is void.
  const double reach = std::max(0.0, disc - std::max(0.0, gap * spacing.actual / l.cell - 0.5));
  out.set = cells_within(centres, l.nx, l.ny, reach);
  return out;
}

/// The cell of the void nearest to (i, j), false where none is beside it.
bool nearest_void(const Mask& m, int i, int j, int& vi, int& vj) {
  const int reach = static_cast<int>(beside);
  double best = beside * beside + 0.5;
  for (int v = std::max(0, j - reach); v <= std::min(m.lattice.ny - 1, j + reach); ++v)
    for (int u = std::max(0, i - reach); u <= std::min(m.lattice.nx - 1, i + reach); ++u) {
      const double d = (u - i) * (u - i) + (v - j) * (v - j);
      if (d < best && m.set[m.lattice.at(u, v)]) best = d, vi = u, vj = v;
    }
  return best <= beside * beside;
}

/// The voids in a square; `returns` reaches around_window farther.
void add_runs(const Mask& returns, const PulseSpacing& spacing, std::vector<VoidRun>& out) {
  const core::Lattice& around = returns.lattice;
  const Mask voids = void_mask(returns, spacing);
  const size_t before = out.size();
  std::vector<int> run_at(around.size(), -1);
  for (int j = around_window; j < around.ny - around_window; ++j)
    for (int i = around_window; i < around.nx - around_window; ++i) {
      if (!voids.set[around.at(i, j)]) continue;
      const auto column = static_cast<std::int32_t>(around.i0 + i), row = static_cast<std::int32_t>(around.j0 + j);
      if (out.size() == before || out.back().j != row || out.back().i1 != column) out.push_back({row, column, column});
      ++out.back().i1;
      run_at[around.at(i, j)] = static_cast<int>(out.size()) - 1;
    }
  if (out.size() == before) return;
  const std::vector<std::uint8_t> near_void = cells_within(voids.set, around.nx, around.ny, beside);
  int vi = 0, vj = 0;
  for (int j = 0; j < around.ny; ++j)
    for (int i = 0; i < around.nx; ++i) {
      const size_t c = around.at(i, j);
      if (!returns.set[c] || !near_void[c] || !nearest_void(voids, i, j, vi, vj)) continue;
      const int run = run_at[around.at(vi, vj)];
      if (run < 0) continue;  // of another square
      ++out[static_cast<size_t>(run)].rim;
      out[static_cast<size_t>(run)].rim_water += returns.set[c] == has_water;
    }
}

/// All of a square that no return comes near.
void add_rows(const core::Lattice& square, std::vector<VoidRun>& out) {
  for (int j = 0; j < square.ny; ++j) {
    const auto first = static_cast<std::int32_t>(square.i0);
    out.push_back({static_cast<std::int32_t>(square.j0 + j), first, first + square.nx});
  }
}

}  // namespace

std::vector<VoidRun> find_voids(const core::Block& b, const core::Lattice& w, const PulseSpacing& spacing) {
  const std::vector<PlacedReturn> returns = placed_returns(b, w, grown(w, around_window));
  std::vector<VoidRun> out;
  for (int row = 0; row * block_cells < w.ny; ++row)
    for (int column = 0; column * block_cells < w.nx; ++column) {
      const int i = column * block_cells, j = row * block_cells;
      const core::Lattice square{w.cell, w.i0 + i, w.j0 + j, std::min(block_cells, w.nx - i), std::min(block_cells, w.ny - j)};
      const Mask mask = mask_of(returns, w, column, row, grown(square, around_window));
      if (std::none_of(mask.set.begin(), mask.set.end(), [](std::uint8_t s) { return s != 0; }))
        add_rows(square, out);
      else if (has_empty_block(mask))
        add_runs(mask, spacing, out);
    }
  return out;
}

EvenSwath even_cells(const core::Block& b, const core::Lattice& w) {
  // Squares of 2 x 2 cells of the absolute lattice, with one around the window's.
  const std::int64_t i0 = 2 * (core::floor_of(0.5 * static_cast<double>(w.i0)) - 1),
                     j0 = 2 * (core::floor_of(0.5 * static_cast<double>(w.j0)) - 1);
  const auto reach = [](std::int64_t first, std::int64_t end) { return static_cast<int>((end - first + 1) / 2 * 2 + 2); };
  const core::Lattice around{w.cell, i0, j0, reach(i0, w.i0 + w.nx), reach(j0, w.j0 + w.ny)};
  std::map<int, Mask> lines;
  lines.emplace(all_lines, around);
  int i = 0, j = 0;
  for (size_t p = 0; p < b.size(); ++p) {
    if (!is_first(b, p) || !cell_of(b, p, around, i, j)) continue;
    lines.at(all_lines).set[around.at(i, j)] = 1;
    lines.try_emplace(b.strip.empty() ? 0 : b.strip[p], around).first->second.set[around.at(i, j)] = 1;
  }
  EvenSwath out{core::Grid(w), {}};
  for (const auto& [line, mask] : lines) {
    const core::Lattice squares{2.0 * w.cell, i0 / 2, j0 / 2, around.nx / 2, around.ny / 2};
    std::vector<std::uint8_t> has(squares.size(), 0);
    for (int v = 0; v < around.ny; ++v)
      for (int u = 0; u < around.nx; ++u) has[squares.at(u / 2, v / 2)] |= mask.set[around.at(u, v)];
    EvenCells counts{line};
    for (int v = 0; v < w.ny; ++v)
      for (int u = 0; u < w.nx; ++u) {
        const int x = u + static_cast<int>(w.i0 - i0), y = v + static_cast<int>(w.j0 - j0);
        bool inner = true;
        for (int sy = y / 2 - 1; sy <= y / 2 + 1 && inner; ++sy)
          for (int sx = x / 2 - 1; sx <= x / 2 + 1 && inner; ++sx) inner = has[squares.at(sx, sy)] != 0;
        if (!inner) continue;
        ++counts.cells;
        counts.hit += mask.set[around.at(x, y)];
        if (line != all_lines) continue;
        out.hit.height[w.at(u, v)] = mask.set[around.at(x, y)];
        out.hit.reason[w.at(u, v)] = core::Void::none;
      }
    out.lines.push_back(counts);
  }
  return out;
}

}  // namespace swath::quality
