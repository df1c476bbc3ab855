// SPDX-License-Identifier: GPL-3.0-or-later
#include "calib/ties/line_heights.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "core/statistics.h"

namespace swath::calib {
namespace {

struct CellPlane {
  double height, slope, rms;
};

/// Least squares z = h + bx x + by y, coordinates from the cell's centre in cells. Nothing where the returns do not span the cell: the
/// height at its centre would be a guess.
template <class M>
std::optional<CellPlane> plane_of(const M& m, double cell) {
  constexpr double least_spread = 0.15;  // of a cell, rms about the mean along the worse direction: 0.29 for an even spread
  constexpr double farthest = 0.35;      // of a cell, from the mean of the returns to the centre
  const double mx = m.x / m.n, my = m.y / m.n, mz = m.z / m.n;
  const double xx = m.xx / m.n - mx * mx, xy = m.xy / m.n - mx * my, yy = m.yy / m.n - my * my;
  const double half = 0.5 * (xx + yy), narrow = half - std::sqrt(std::max(0.0, half * half - (xx * yy - xy * xy)));
  if (!(narrow > least_spread * least_spread) || std::hypot(mx, my) > farthest) return std::nullopt;
  const double xz = m.xz / m.n - mx * mz, yz = m.yz / m.n - my * mz, zz = m.zz / m.n - mz * mz;
  const double det = xx * yy - xy * xy;
  const double bx = (yy * xz - xy * yz) / det, by = (xx * yz - xy * xz) / det;
  const double rest = std::max(0.0, zz - bx * xz - by * yz) * m.n / (m.n - 3);
  const double slope = std::hypot(bx, by) / cell;
  return CellPlane{mz - bx * mx - by * my, slope, std::sqrt(rest / (1 + slope * slope))};
}

}  // namespace

void LineHeights::add(int line, const core::Block& b) {
  if (line != line_) close();
  line_ = line;
  const double cell = cell_;
  for (size_t i = 0; i < b.size(); ++i) {
    if (!core::is_last_return(b, i) || (!b.return_number.empty() && b.return_number[i] > 1)) continue;
    const double x = (b.x[i] + b.origin.x()) / cell, y = (b.y[i] + b.origin.y()) / cell;
    const double column = std::floor(x), row = std::floor(y);
    const Key page{static_cast<std::int64_t>(std::floor(column / page_side)), static_cast<std::int64_t>(std::floor(row / page_side))};
    if (!last_ || page != last_page_) {
      last_ = &pages_[page];
      last_->resize(static_cast<size_t>(page_side) * page_side);
      last_page_ = page;
    }
    const auto at =
        (static_cast<std::int64_t>(row) - page.second * page_side) * page_side + static_cast<std::int64_t>(column) - page.first * page_side;
    Moments& m = (*last_)[static_cast<size_t>(at)];
    const double dx = x - column - 0.5, dy = y - row - 0.5, z = b.z[i];  // z from the block's origin: its square keeps its digits
    m.n += 1;
    m.x += dx, m.y += dy, m.z += z;
    m.xx += dx * dx, m.xy += dx * dy, m.yy += dy * dy;
    m.xz += dx * z, m.yz += dy * z, m.zz += z * z;
    origin_height_ = b.origin.z();
  }
}

void LineHeights::close() {
  std::map<Key, Cell>& cells = lines_[line_];
  for (const auto& [page, moments] : pages_)
    for (size_t k = 0; k < moments.size(); ++k) {
      const Moments& m = moments[k];
      if (m.n < options_.least) continue;
      const std::optional<CellPlane> plane = plane_of(m, cell_);
      if (!plane || plane->rms > options_.roughness.value) continue;
      const Key key{page.first * page_side + static_cast<std::int64_t>(k % page_side),
                    page.second * page_side + static_cast<std::int64_t>(k / page_side)};
      Cell& cell = cells[key];
      if (cell.count < m.n) cell = {plane->height + origin_height_, static_cast<float>(plane->slope), static_cast<std::uint32_t>(m.n)};
    }
  if (cells.empty()) lines_.erase(line_);
  pages_.clear();
  last_ = nullptr;
}

const std::map<int, std::map<LineHeights::Key, LineHeights::Cell>>& LineHeights::lines() {
  close();
  return lines_;
}

std::vector<LineDifferenceMap> line_differences(LineHeights& heights, std::uint64_t least) {
  const auto& lines = heights.lines();
  std::vector<LineDifferenceMap> out;
  for (auto a = lines.begin(); a != lines.end(); ++a)
    for (auto b = std::next(a); b != lines.end(); ++b) {
      struct Both {
        LineHeights::Key key;
        double difference, slope;
      };
      std::vector<Both> both;
      std::int64_t i0 = 0, j0 = 0, i1 = 0, j1 = 0;
      auto other = b->second.begin();
      for (const auto& [key, cell] : a->second) {
        while (other != b->second.end() && other->first < key) ++other;
        if (other == b->second.end()) break;
        if (other->first != key) continue;
        if (both.empty()) i0 = i1 = key.first, j0 = j1 = key.second;
        i0 = std::min(i0, key.first), i1 = std::max(i1, key.first);
        j0 = std::min(j0, key.second), j1 = std::max(j1, key.second);
        both.push_back({key, cell.height - other->second.height, 0.5 * (cell.slope + other->second.slope)});
      }
      if (both.size() < least) continue;
      LineDifferenceMap map{{a->first, b->first, both.size()},
                            core::Grid({heights.cell(), i0, j0, static_cast<int>(i1 - i0 + 1), static_cast<int>(j1 - j0 + 1)})};
      double sum = 0, squares = 0;
      std::vector<double> sizes;
      for (const Both& one : both) {
        const size_t at = map.grid.lattice.at(static_cast<int>(one.key.first - i0), static_cast<int>(one.key.second - j0));
        map.grid.height[at] = static_cast<float>(one.difference);
        map.grid.reason[at] = core::Void::none;
        const double distance = one.difference / std::sqrt(1 + one.slope * one.slope);
        sum += distance;
        squares += distance * distance;
        sizes.push_back(std::abs(distance));
      }
      const auto n = static_cast<double>(both.size());
      map.statistics.mean = sum / n;
      map.statistics.rms = std::sqrt(squares / n);
      map.statistics.median_abs = core::median(std::move(sizes));
      out.push_back(std::move(map));
    }
  return out;
}

double overall_rms(const std::vector<LineDifferenceMap>& maps) {
  double squares = 0, n = 0;
  for (const LineDifferenceMap& m : maps) {
    const auto cells = static_cast<double>(m.statistics.cells);
    squares += cells * m.statistics.rms * m.statistics.rms;
    n += cells;
  }
  return n > 0 ? std::sqrt(squares / n) : 0.0;
}

}  // namespace swath::calib
