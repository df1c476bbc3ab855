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

/// The returns of one line, by cells that hold few where they are dense.
class LineReturns {
 public:
  /// `rows`: there must be one; `widest`: of a cell's sides.
  LineReturns(const core::Block& b, const std::vector<std::uint32_t>& rows, double widest) {
    constexpr double per_cell = 2.0;
    double east = b.x[rows[0]], north = b.y[rows[0]];
    west_ = east, south_ = north;
    for (const std::uint32_t p : rows) {
      west_ = std::min(west_, b.x[p]), east = std::max(east, b.x[p]);
      south_ = std::min(south_, b.y[p]), north = std::max(north, b.y[p]);
    }
    const double longest = std::max(east - west_, north - south_) / static_cast<double>(rows.size());  // all in one row of cells
    side_ = std::clamp(std::sqrt(per_cell * (east - west_) * (north - south_) / static_cast<double>(rows.size())),
                       std::max(1e-3, per_cell * longest), std::max({widest, 1e-3, per_cell * longest}));
    nx_ = cell(east, west_) + 1, ny_ = cell(north, south_) + 1;
    start_.assign(static_cast<size_t>(nx_) * static_cast<size_t>(ny_) + 1, 0);
    const auto at = [&](std::uint32_t p) { return index(cell(b.x[p], west_), cell(b.y[p], south_)); };
    for (const std::uint32_t p : rows) ++start_[at(p) + 1];
    for (size_t c = 1; c < start_.size(); ++c) start_[c] += start_[c - 1];
    std::vector<std::uint32_t> next(start_.begin(), start_.end() - 1);
    places_.resize(rows.size());
    for (const std::uint32_t p : rows) places_[next[at(p)]++] = {b.x[p], b.y[p]};
  }

  /// Are there at most `most` within the radius of a place?
  bool are_few(double x, double y, double radius, int most) const {
    constexpr double rounding = 1e-6;  // m, on the safe side of a cell's border
    const double reach = radius + rounding;
    const int i0 = std::max(0, cell(x - reach, west_)), i1 = std::min(nx_ - 1, cell(x + reach, west_));
    const int j0 = std::max(0, cell(y - reach, south_)), j1 = std::min(ny_ - 1, cell(y + reach, south_));
    int n = 0;
    const auto row_is_full = [&](int j) {
      for (std::uint32_t k = start_[index(i0, j)]; k < start_[index(i1, j) + 1]; ++k) {
        const double dx = places_[k].x - x, dy = places_[k].y - y;
        if (dx * dx + dy * dy <= radius * radius && ++n > most) return true;
      }
      return false;
    };
    const int middle = std::clamp(cell(y, south_), j0, j1);  // its row first: most returns are done with there
    if (row_is_full(middle)) return false;
    for (int j = j0; j <= j1; ++j)
      if (j != middle && row_is_full(j)) return false;
    return true;
  }

 private:
  struct Place {
    double x, y;
  };
  int cell(double v, double first) const { return static_cast<int>(std::floor((v - first) / side_)); }
  size_t index(int i, int j) const { return static_cast<size_t>(j) * static_cast<size_t>(nx_) + static_cast<size_t>(i); }

  double west_ = 0.0, south_ = 0.0, side_ = 1.0;
  int nx_ = 0, ny_ = 0;
  std::vector<std::uint32_t> start_;
  std::vector<Place> places_;
};

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
  std::map<std::uint16_t, std::vector<std::uint32_t>> lines;  // rows
  for (int j = 0; j < l.ny; ++j)
    for (int i = 0; i < l.nx; ++i)
      for (const std::uint32_t row : bins.rows(i, j)) lines[line_of(b, row)].push_back(row);
  std::vector<std::uint32_t> counts(l.size());
  const auto cell_at = [&](std::uint32_t row) {
    const CellIndex c = cell_of(l, b, row);
    return l.at(c.i, c.j);
  };
  for (const auto& [line, rows] : lines) {
    std::fill(counts.begin(), counts.end(), 0);
    for (const std::uint32_t row : rows) ++counts[cell_at(row)];
    const std::vector<double> usual = usual_counts(l, counts);
    for (size_t c = 0; c < l.size(); ++c) out.usual[c] = std::max(out.usual[c], usual[c]);
    const LineReturns returns(b, rows, l.cell);
    for (const std::uint32_t row : rows) {
      const double here = usual[cell_at(row)];
      if (here <= 0.0) continue;
      const double radius = std::min(l.cell * std::sqrt(usual_returns / (core::pi * here)), l.cell * sparse_circle);
      const double most = share * here * core::pi * radius * radius / (l.cell * l.cell);
      if (most < 1.0) continue;  // too thin to judge
      if (returns.are_few(b.x[row], b.y[row], radius, static_cast<int>(most))) out.sparse[row] = 1;
    }
  }
  return out;
}

}  // namespace swath::filters
