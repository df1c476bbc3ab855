// SPDX-License-Identifier: GPL-3.0-or-later
#include "quality/pulse_density.h"

#include <algorithm>
#include <cmath>
#include <map>

namespace swath::quality {
namespace {

constexpr double least_inner = 0.1;   // of a line's cells: with fewer inner ones (a narrow corridor) all cells count
constexpr double least_pulses = 0.1;  // of the mean line: a line of fewer, a cross line's rest, is not the sparsest

/// Around both; an empty one counts for nothing.
core::Box around_both(const core::Box& a, const core::Box& b) {
  if (!(a.x1 > a.x0)) return b;
  if (!(b.x1 > b.x0)) return a;
  return {std::min(a.x0, b.x0), std::min(a.y0, b.y0), std::max(a.x1, b.x1), std::max(a.y1, b.y1)};
}

core::Box box_of_cell(const core::Lattice& l, int i, int j) {
  const double x = static_cast<double>(l.i0 + i) * l.cell, y = static_cast<double>(l.j0 + j) * l.cell;
  return {x, y, x + l.cell, y + l.cell};
}

/// First returns by cell of a lattice that reaches one cell farther than the window.
using CellCounts = std::vector<std::uint32_t>;

std::map<int, CellCounts> counts_by_line(const core::Block& b, const core::Lattice& around, const std::vector<std::uint8_t>& repeated,
                                         std::uint64_t& duplicates) {
  std::map<int, CellCounts> out;
  CellCounts* counts = nullptr;  // of the line of the point before
  int last = all_lines;
  for (size_t p = 0; p < b.size(); ++p) {
    if (!is_first(b, p)) continue;
    const std::int64_t i = core::cell_index(b.origin.x() + b.x[p], around.cell) - around.i0,
                       j = core::cell_index(b.origin.y() + b.y[p], around.cell) - around.j0;
    if (i < 0 || j < 0 || i >= around.nx || j >= around.ny) continue;
    if (!repeated.empty() && repeated[p]) {
      duplicates += i > 0 && j > 0 && i + 1 < around.nx && j + 1 < around.ny;
      continue;
    }
    if (const int line = b.strip.empty() ? 0 : b.strip[p]; line != last) {
      counts = &out[last = line];
      if (counts->empty()) counts->assign(around.size(), 0);
    }
    ++(*counts)[around.at(static_cast<int>(i), static_cast<int>(j))];
  }
  return out;
}

bool is_inner(const CellCounts& counts, const core::Lattice& around, int i, int j) {
  for (int v = j - 1; v <= j + 1; ++v)
    for (int u = i - 1; u <= i + 1; ++u)
      if (counts[around.at(u, v)] == 0) return false;
  return true;
}

PulseSums sums_of(int line, const CellCounts& counts, const core::Lattice& around, std::map<std::uint32_t, std::uint64_t>* bins) {
  PulseSums s{line};
  for (int j = 1; j + 1 < around.ny; ++j)
    for (int i = 1; i + 1 < around.nx; ++i) {
      const std::uint32_t n = counts[around.at(i, j)];
      if (n == 0) continue;
      ++s.cells, s.pulses += n;
      if (line == all_lines) s.extent = around_both(s.extent, box_of_cell(around, i, j));
      if (!is_inner(counts, around, i, j)) continue;
      ++s.inner_cells, s.inner_pulses += n;
      if (bins) ++(*bins)[n];
    }
  return s;
}

LineDensity density_of(const PulseSums& s, double cell) {
  LineDensity d{s.line, s.pulses};
  const bool by_inner = static_cast<double>(s.inner_cells) > least_inner * static_cast<double>(s.cells);
  d.area = static_cast<double>(by_inner ? s.inner_cells : s.cells) * cell * cell;
  d.density = static_cast<double>(by_inner ? s.inner_pulses : s.pulses) / d.area;
  d.spacing = 1.0 / std::sqrt(d.density);
  return d;
}

}  // namespace

PulseCells count_pulses(const core::Block& block, const core::Lattice& w, const std::vector<std::uint8_t>& repeated) {
  PulseCells out{core::Grid(w), core::Grid(w), {}, {}};
  out.density.count.assign(w.size(), 0);
  const core::Lattice around{w.cell, w.i0 - 1, w.j0 - 1, w.nx + 2, w.ny + 2};
  CellCounts all(around.size(), 0);
  const double area = w.cell * w.cell;
  std::uint64_t duplicates = 0;
  for (const auto& [line, counts] : counts_by_line(block, around, repeated, duplicates)) {
    out.lines.push_back(sums_of(line, counts, around, nullptr));
    for (size_t c = 0; c < all.size(); ++c) all[c] += counts[c];
    for (int j = 0; j < w.ny; ++j)
      for (int i = 0; i < w.nx; ++i) {
        const std::uint32_t n = counts[around.at(i + 1, j + 1)];
        if (n == 0) continue;
        const size_t c = w.at(i, j);
        ++out.density.count[c];
        const auto own = static_cast<float>(n / area);
        if (!(out.single.height[c] >= own)) out.single.height[c] = own;
        out.single.reason[c] = core::Void::none;
      }
  }
  std::map<std::uint32_t, std::uint64_t> bins;
  out.lines.push_back(sums_of(all_lines, all, around, &bins));
  out.lines.back().duplicates = duplicates;
  for (const auto& [pulses, cells] : bins) out.bins.push_back({pulses, cells});
  for (int j = 0; j < w.ny; ++j)
    for (int i = 0; i < w.nx; ++i)
      if (const std::uint32_t n = all[around.at(i + 1, j + 1)]; n > 0) {
        out.density.height[w.at(i, j)] = static_cast<float>(n / area);
        out.density.reason[w.at(i, j)] = core::Void::none;
      }
  return out;
}

SwathDensity judge_density(const std::vector<PulseSums>& lines, const std::vector<PulseBin>& bins, double cell) {
  std::map<int, PulseSums> sums;
  for (const PulseSums& s : lines) {
    PulseSums& to = sums[s.line];
    to.line = s.line;
    to.cells += s.cells, to.pulses += s.pulses, to.inner_cells += s.inner_cells, to.inner_pulses += s.inner_pulses;
    to.duplicates += s.duplicates;
    to.extent = around_both(to.extent, s.extent);
  }
  SwathDensity out{cell};
  for (const auto& [line, s] : sums) {
    if (s.pulses == 0) continue;
    if (line == all_lines)
      out.all = density_of(s, cell);
    else
      out.lines.push_back(density_of(s, cell));
  }
  out.extent = sums[all_lines].extent;
  out.duplicates = sums[all_lines].duplicates;
  if (out.duplicates > 0) out.duplicate_share = static_cast<double>(out.duplicates) / static_cast<double>(out.all.pulses + out.duplicates);
  for (const LineDensity& l : out.lines)
    if (static_cast<double>(l.pulses * out.lines.size()) > least_pulses * static_cast<double>(out.all.pulses) &&
        (out.single_density == 0.0 || l.density < out.single_density))
      out.single_density = l.density, out.single_spacing = l.spacing;
  std::map<std::uint32_t, std::uint64_t> by_count;
  std::uint64_t all = 0;
  for (const PulseBin& b : bins) by_count[b.pulses] += b.cells, all += b.cells;
  const auto quantile = [&](double share) {
    std::uint64_t below = 0;
    for (const auto& [pulses, cells] : by_count)
      if (below += cells; static_cast<double>(below) >= share * static_cast<double>(all)) return pulses / (cell * cell);
    return std::nan("");
  };
  out.low = quantile(0.05), out.median = quantile(0.5), out.high = quantile(0.95);
  return out;
}

}  // namespace swath::quality
