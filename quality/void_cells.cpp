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

core::Lattice grown(const core::Lattice& l, int by) { return {l.cell, l.i0 - by, l.j0 - by, l.nx + 2 * by, l.ny + 2 * by}; }

/// The squares of block_cells that a window is cut into.
struct Squares {
  core::Lattice window;
  int across, rows;
  explicit Squares(const core::Lattice& w)
      : window(w), across((w.nx + block_cells - 1) / block_cells), rows((w.ny + block_cells - 1) / block_cells) {}
  core::Lattice lattice(int column, int row) const {
    const int i = column * block_cells, j = row * block_cells;
    return {window.cell, window.i0 + i, window.j0 + j, std::min(block_cells, window.nx - i), std::min(block_cells, window.ny - j)};
  }
  size_t at(int column, int row) const { return static_cast<size_t>(row) * static_cast<size_t>(across) + static_cast<size_t>(column); }
  /// Calls see(square, i, j) for every square from which cell (i, j) of the window is no farther than around_window; i, j from the corner
  /// of what is so near to it.
  template <class See>
  void each_near(int i, int j, See&& see) const {
    const auto first = [](int c) { return std::max(0, (c - around_window) / block_cells); };
    const auto last = [](int c, int n) { return std::min(n - 1, (c + around_window) / block_cells); };
    const auto within = [](int c, int square) { return static_cast<std::uint16_t>(c - square * block_cells + around_window); };
    for (int row = first(j); row <= last(j, rows); ++row)
      for (int column = first(i); column <= last(i, across); ++column) see(at(column, row), within(i, column), within(j, row));
  }
};

/// The first returns of a window by the squares that they are near to (counting sort).
class PlacedReturns {
 public:
  PlacedReturns(const core::Block& b, const Squares& squares) : start_(squares.at(0, squares.rows) + 1, 0) {
    const core::Lattice around = grown(squares.window, around_window);
    int i = 0, j = 0;
    const auto each = [&](auto&& see) {
      for (size_t p = 0; p < b.size(); ++p)
        if (is_first(b, p) && cell_of(b, p, around, i, j))
          squares.each_near(i - around_window, j - around_window,
                            [&](size_t square, std::uint16_t u, std::uint16_t v) { see(p, square, u, v); });
    };
    each([&](size_t, size_t square, std::uint16_t, std::uint16_t) { ++start_[square]; });
    std::uint32_t sum = 0;
    for (std::uint32_t& s : start_) s = sum += s;  // the end of each, which moves to the start as it is filled
    returns_.resize(sum);
    each([&](size_t p, size_t square, std::uint16_t u, std::uint16_t v) {
      const bool is_water = !b.classification.empty() && b.classification[p] == core::point_class::water;
      returns_[--start_[square]] = {u, v, is_water ? has_water : has_return};
    });
  }
  /// Of a square and around_window farther, which is `lattice`.
  Mask mask(size_t square, const core::Lattice& lattice) const {
    Mask out(lattice);
    for (std::uint32_t k = start_[square]; k < start_[square + 1]; ++k)
      out.set[lattice.at(returns_[k].i, returns_[k].j)] |= returns_[k].kind;
    return out;
  }

 private:
  struct Return {
    std::uint16_t i, j;
    std::uint8_t kind;
  };
  std::vector<std::uint32_t> start_;  ///< of each square, and the end
  std::vector<Return> returns_;
};

/// Is there a square block of cells without returns? Without one no disc is empty, and no distance need be known.
bool has_empty_block(const Mask& m) {
  const core::Lattice& l = m.lattice;
  const auto width = static_cast<size_t>(l.nx);
  std::vector<std::uint8_t> band(width);
  std::uint8_t* const to = band.data();
  for (int j = 0; j + empty_block <= l.ny; j += empty_block) {
    std::fill(band.begin(), band.end(), std::uint8_t{0});
    for (int v = j; v < j + empty_block; ++v) {
      const std::uint8_t* row = m.set.data() + l.at(0, v);
      for (size_t i = 0; i < width; ++i) to[i] = static_cast<std::uint8_t>(to[i] | row[i]);
    }
    for (size_t i = 0; i + empty_block <= width; i += empty_block)
      if (std::all_of(to + i, to + i + empty_block, [](std::uint8_t c) { return c == 0; })) return true;
  }
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
  std::vector<size_t> of_row(static_cast<size_t>(around.ny) + 1, before);  // the first run of each row
  for (int j = around_window; j < around.ny - around_window; ++j) {
    for (int i = around_window; i < around.nx - around_window; ++i) {
      if (!voids.set[around.at(i, j)]) continue;
      const auto column = static_cast<std::int32_t>(around.i0 + i), row = static_cast<std::int32_t>(around.j0 + j);
      if (out.size() == before || out.back().j != row || out.back().i1 != column) out.push_back({row, column, column});
      ++out.back().i1;
    }
    of_row[static_cast<size_t>(j) + 1] = out.size();
  }
  if (out.size() == before) return;
  const auto run_at = [&](int i, int j) -> VoidRun* {  // null outside the square
    if (i < around_window || j < around_window || i >= around.nx - around_window || j >= around.ny - around_window) return nullptr;
    const auto column = static_cast<std::int32_t>(around.i0 + i);
    const auto begin = out.begin() + static_cast<std::ptrdiff_t>(of_row[static_cast<size_t>(j)]),
               end = out.begin() + static_cast<std::ptrdiff_t>(of_row[static_cast<size_t>(j) + 1]);
    return &*std::prev(std::upper_bound(begin, end, column, [](std::int32_t c, const VoidRun& r) { return c < r.i0; }));
  };
  const std::vector<std::uint8_t> near_void = cells_within(voids.set, around.nx, around.ny, beside);
  int vi = 0, vj = 0;
  for (int j = 0; j < around.ny; ++j)
    for (int i = 0; i < around.nx; ++i) {
      const size_t c = around.at(i, j);
      if (!returns.set[c] || !near_void[c] || !nearest_void(voids, i, j, vi, vj)) continue;
      VoidRun* const run = run_at(vi, vj);
      if (!run) continue;  // of another square
      ++run->rim;
      run->rim_water += returns.set[c] == has_water;
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
  const Squares squares(w);
  const PlacedReturns returns(b, squares);
  std::vector<VoidRun> out;
  for (int row = 0; row < squares.rows; ++row)
    for (int column = 0; column < squares.across; ++column) {
      const core::Lattice square = squares.lattice(column, row);
      const Mask mask = returns.mask(squares.at(column, row), grown(square, around_window));
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
  std::vector<std::uint8_t>& all = lines.at(all_lines).set;
  std::vector<std::uint8_t>* own = nullptr;  // of the line of the point before
  int i = 0, j = 0, last = all_lines;
  for (size_t p = 0; p < b.size(); ++p) {
    if (!is_first(b, p) || !cell_of(b, p, around, i, j)) continue;
    if (const int line = b.strip.empty() ? 0 : b.strip[p]; line != last) own = &lines.try_emplace(last = line, around).first->second.set;
    all[around.at(i, j)] = (*own)[around.at(i, j)] = 1;
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
