// SPDX-License-Identifier: GPL-3.0-or-later
#include "filters/noise/sparse_returns.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "core/config/units.h"
#include "core/floor_div.h"

namespace swath::filters {
namespace {

constexpr int district_cells = 8;       // cells, a side of the squares that the usual number is counted for
constexpr int districts_around = 2;     // on each side
constexpr double usual_returns = 50.0;  // in the circle

std::uint16_t line_of(const core::Block& b, std::uint32_t row) { return b.strip.empty() ? std::uint16_t{0} : b.strip[row]; }

/// Are there at most `most` returns of the line within the radius of p, itself among them?
bool is_sparse(const core::Block& b, const Bins& bins, int i, int j, const Bins::Point& p, std::uint16_t line, double radius, int most) {
  const int reach = static_cast<int>(std::ceil(radius / bins.lattice().cell));
  int n = 0;
  for (int ring = 0; ring <= reach; ++ring)  // the own cell first: most returns are done with there
    for (int dj = -ring; dj <= ring; ++dj)
      for (int di = -ring; di <= ring; ++di) {
        if (std::max(std::abs(di), std::abs(dj)) != ring || !bins.lattice().holds(i + di, j + dj)) continue;
        const auto points = bins.in(i + di, j + dj);
        const auto rows = bins.rows(i + di, j + dj);
        for (size_t k = 0; k < points.size(); ++k) {
          if (line_of(b, rows[k]) != line) continue;
          const double dx = points[k].x - p.x, dy = points[k].y - p.y;
          if (dx * dx + dy * dy <= radius * radius && ++n > most) return false;
        }
      }
  return true;
}

/// For each cell the number of returns in a cell that half of the returns in the districts around have at most.
std::vector<double> usual_counts(const core::Lattice& l, const std::vector<std::uint32_t>& counts) {
  std::vector<double> out(l.size(), 0.0);
  if (l.size() == 0) return out;
  std::vector<std::uint32_t> sorted;
  for (std::int64_t v = core::floor_div(l.j0, district_cells); v <= core::floor_div(l.j0 + l.ny - 1, district_cells); ++v)
    for (std::int64_t u = core::floor_div(l.i0, district_cells); u <= core::floor_div(l.i0 + l.nx - 1, district_cells); ++u) {
      const auto range = [](std::int64_t from, std::int64_t to, std::int64_t first, int n) {
        return std::pair{static_cast<int>(std::max<std::int64_t>(from * district_cells - first, 0)),
                         static_cast<int>(std::min<std::int64_t>(to * district_cells - first, n))};
      };
      const auto [i0, i1] = range(u - districts_around, u + districts_around + 1, l.i0, l.nx);
      const auto [j0, j1] = range(v - districts_around, v + districts_around + 1, l.j0, l.ny);
      sorted.clear();
      std::uint64_t total = 0;
      for (int j = j0; j < j1; ++j)
        for (int i = i0; i < i1; ++i)
          if (const std::uint32_t n = counts[l.at(i, j)]; n > 0) sorted.push_back(n), total += n;
      if (total == 0) continue;
      std::sort(sorted.begin(), sorted.end());
      std::uint64_t sum = 0;
      double usual = 0;
      for (const std::uint32_t n : sorted) {
        sum += n;
        usual = n;
        if (2 * sum >= total) break;
      }
      const auto [a0, a1] = range(u, u + 1, l.i0, l.nx);
      const auto [b0, b1] = range(v, v + 1, l.j0, l.ny);
      for (int j = b0; j < b1; ++j)
        for (int i = a0; i < a1; ++i) out[l.at(i, j)] = usual;
    }
  return out;
}

}  // namespace

SparseReturns sparse_returns(const core::Block& b, const Bins& bins, double share) {
  const core::Lattice& l = bins.lattice();
  SparseReturns out{std::vector<std::uint8_t>(b.size(), 0), std::vector<double>(l.size(), 0.0)};
  std::map<std::uint16_t, std::vector<std::uint32_t>> counts;
  for (int j = 0; j < l.ny; ++j)
    for (int i = 0; i < l.nx; ++i)
      for (const std::uint32_t row : bins.rows(i, j)) {
        auto& of_line = counts[line_of(b, row)];
        of_line.resize(l.size(), 0);
        ++of_line[l.at(i, j)];
      }
  for (const auto& [line, of_line] : counts) {
    const std::vector<double> usual = usual_counts(l, of_line);
    for (int j = 0; j < l.ny; ++j)
      for (int i = 0; i < l.nx; ++i) {
        const size_t c = l.at(i, j);
        out.usual[c] = std::max(out.usual[c], usual[c]);
        if (of_line[c] == 0 || usual[c] <= 0.0) continue;
        const double radius = std::min(l.cell * std::sqrt(usual_returns / (core::pi * usual[c])), l.cell * sparse_circle);
        const double most = share * usual[c] * core::pi * radius * radius / (l.cell * l.cell);
        if (most < 1.0) continue;  // too thin to judge
        const auto points = bins.in(i, j);
        const auto rows = bins.rows(i, j);
        for (size_t k = 0; k < points.size(); ++k)
          if (line_of(b, rows[k]) == line && is_sparse(b, bins, i, j, points[k], line, radius, static_cast<int>(most)))
            out.sparse[rows[k]] = 1;
      }
  }
  return out;
}

}  // namespace swath::filters
