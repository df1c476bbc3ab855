// SPDX-License-Identifier: GPL-3.0-or-later
// Planes as in quality/line_cells.h, on cells of one size and without blocks. Distributions are kept as counts of narrow bins: a survey of
// any size passes through, and a quantile is known to half a bin, 0.25 mm.
// The variance that a line's points predict for its plane at the cell's centre: what their sigma holds beyond the scatter about the plane
// is shared by all of them, the scatter itself averages out over their number (the centre lies near their mean).
#include "quality/overlap_cells.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <span>

#include "quality/binned_errors.h"
#include "quality/cell_planes.h"

namespace swath::quality {
namespace {

constexpr double level_slope = 0.176327;   // tan 10 deg: steeper cells are in the image alone (USGS Lidar Base Specification, interswath)
constexpr double difference_bin = 0.5e-3;  // m
constexpr double scatter_bin = 0.1e-3;     // m
constexpr double histogram_bin = 5e-3;     // m

struct LinePlane {
  int line;
  double n;
  CellPlane plane;
  double variance;  ///< m2, of the height at the centre by the points' own sigmas; NaN without them
};

/// x, y from the window's corner.
ReturnsByCell returns_in(const core::Block& b, const core::Lattice& window) {
  const double west = window.west(), south = window.south();
  const auto cell_of = [&](size_t p) {
    if (!is_single(b, p)) return no_cell;
    const std::int64_t i = core::cell_index(b.origin.x() + b.x[p], window.cell) - window.i0,
                       j = core::cell_index(b.origin.y() + b.y[p], window.cell) - window.j0;
    if (i < 0 || j < 0 || i >= window.nx || j >= window.ny) return no_cell;
    return static_cast<std::uint32_t>(window.at(static_cast<int>(i), static_cast<int>(j)));
  };
  const auto return_of = [&](size_t p) {
    return CellReturn{b.origin.x() + b.x[p] - west, b.origin.y() + b.y[p] - south, b.z[p], b.sigma_v.empty() ? 0.0F : b.sigma_v[p],
                      b.strip.empty() ? std::uint16_t{0} : b.strip[p]};
  };
  return {b.size(), window.size(), cell_of, return_of};
}

/// The lines' planes in one cell, by rising line.
std::vector<LinePlane> planes_in(std::span<const CellReturn> returns, int i, int j, double cell, const LineOptions& o) {
  std::vector<LinePlane> out;
  const double cx = (i + 0.5) * cell, cy = (j + 0.5) * cell;
  for (size_t begin = 0, end = 0; begin < returns.size(); begin = end) {
    PlaneSums sums;
    double squares = 0.0;
    for (; end < returns.size() && returns[end].line == returns[begin].line; ++end) {
      sums.add(returns[end].x, returns[end].y, returns[end].z);
      squares += static_cast<double>(returns[end].sigma) * static_cast<double>(returns[end].sigma);
    }
    if (sums.n < o.least) continue;
    const std::optional<CellPlane> plane = plane_of(sums, cx, cy, cell);
    if (!plane || plane->rms > o.roughness.value) continue;
    const double own = squares / sums.n, scatter = plane->rms * plane->rms;
    out.push_back({returns[begin].line, sums.n, *plane,
                   own > 0.0 ? std::max(0.0, own - scatter) + scatter / sums.n : std::numeric_limits<double>::quiet_NaN()});
  }
  return out;
}

/// Sums by pair and line while a tile is gone through.
class OverlapBooks {
 public:
  void see(const std::vector<LinePlane>& planes, double x, double y) {
    for (const LinePlane& p : planes) {
      if (p.plane.slope_squared() > level_slope * level_slope) continue;
      SmoothSums& sums = lines_[p.line];
      sums.line = p.line;
      ++sums.cells;
      sums.freedom += p.n - 3.0;
      sums.squares += p.plane.rms * p.plane.rms * (p.n - 3.0);
      ++line_bins_[{p.line, bin_of(p.plane.rms / quartile_of(p.n - 3.0), scatter_bin)}];
    }
    for (size_t a = 0; a < planes.size(); ++a)
      for (size_t b = a + 1; b < planes.size(); ++b) compare(planes[a], planes[b], x, y);
  }
  void give(OverlapCells& out) const {
    for (const auto& [key, sums] : pairs_) out.pairs.push_back(sums);
    for (const auto& [key, cells] : bins_) out.bins.push_back({key[0], key[1], key[2], cells});
    for (const auto& [line, sums] : lines_) out.lines.push_back(sums);
    for (const auto& [key, cells] : line_bins_) out.line_bins.push_back({key.first, key.second, cells});
  }

 private:
  void compare(const LinePlane& a, const LinePlane& b, double x, double y) {
    const double east = 0.5 * (a.plane.east + b.plane.east), north = 0.5 * (a.plane.north + b.plane.north);
    if (east * east + north * north > level_slope * level_slope) return;
    const double d = a.plane.height - b.plane.height;
    const auto [at, fresh] = pairs_.try_emplace({a.line, b.line}, OverlapSums{a.line, b.line});
    OverlapSums& s = at->second;
    if (fresh) s.west = s.east = x, s.south = s.north = y;
    s.west = std::min(s.west, x), s.east = std::max(s.east, x);
    s.south = std::min(s.south, y), s.north = std::max(s.north, y);
    ++s.cells;
    s.sum += d, s.squares += d * d;
    if (const double variance = a.variance + b.variance; !std::isnan(variance)) {
      ++s.predicted_cells;
      s.predicted += variance, s.squares_there += d * d;
    }
    ++bins_[{a.line, b.line, bin_of(d, difference_bin)}];
  }

  std::map<std::pair<int, int>, OverlapSums> pairs_;
  std::map<std::array<std::int32_t, 3>, std::uint32_t> bins_;
  std::map<int, SmoothSums> lines_;
  std::map<std::pair<std::int32_t, std::int32_t>, std::uint64_t> line_bins_;
};

SwathPair pair_of(const OverlapSums& s, const Bins& bins) {
  SwathPair p{s.line_a, s.line_b, s.cells};
  const auto n = static_cast<double>(s.cells);
  p.mean = s.sum / n;
  p.median = bin_quantile(bins, 0.5, difference_bin);
  p.rms = std::sqrt(s.squares / n);
  p.q95 = std::max(0.0, bin_quantile(distances_from(bins, 0.0, difference_bin), 0.95, difference_bin));
  const auto predicted = static_cast<double>(s.predicted_cells);
  p.predicted = std::sqrt(s.predicted / predicted);  // not a number without predicted cells
  p.error_over_sigma = std::sqrt(s.squares_there / s.predicted);
  p.west = s.west, p.south = s.south, p.east = s.east, p.north = s.north;
  return p;
}

void join(OverlapSums& into, const OverlapSums& s) {
  if (into.cells == 0) into.west = s.west, into.south = s.south, into.east = s.east, into.north = s.north;
  into.cells += s.cells, into.predicted_cells += s.predicted_cells;
  into.sum += s.sum, into.squares += s.squares;
  into.predicted += s.predicted, into.squares_there += s.squares_there;
  into.west = std::min(into.west, s.west), into.east = std::max(into.east, s.east);
  into.south = std::min(into.south, s.south), into.north = std::max(into.north, s.north);
}

std::vector<SwathLine> lines_of(const OverlapCells& c) {
  std::map<int, SmoothSums> lines;
  std::map<int, Bins> bins;
  for (const SmoothSums& s : c.lines) {
    SmoothSums& sums = lines[s.line];
    sums.cells += s.cells, sums.squares += s.squares, sums.freedom += s.freedom;
  }
  for (const SmoothBin& b : c.line_bins) bins[b.line][b.bin] += static_cast<double>(b.cells);
  std::vector<SwathLine> out;
  for (const auto& [line, s] : lines)
    out.push_back({line, s.cells, std::sqrt(s.squares / s.freedom), bin_quantile(bins[line], 0.25, scatter_bin)});
  return out;
}

}  // namespace

OverlapCells compare_overlaps(const core::Block& block, const core::Lattice& window, const LineOptions& o) {
  OverlapCells out{core::Grid(window), {}, {}, {}, {}};
  out.difference.count.assign(window.size(), 0);
  const ReturnsByCell returns = returns_in(block, window);
  OverlapBooks books;
  for (size_t cell = 0; cell < window.size(); ++cell) {
    const int i = static_cast<int>(cell) % window.nx, j = static_cast<int>(cell) / window.nx;
    const std::vector<LinePlane> planes = planes_in(returns.in(cell), i, j, window.cell, o);
    out.difference.count[cell] = static_cast<std::uint32_t>(planes.size());
    books.see(planes, window.centre_x(i), window.centre_y(j));
    if (planes.size() < 2) continue;
    double largest = 0.0;
    for (size_t a = 0; a < planes.size(); ++a)
      for (size_t b = a + 1; b < planes.size(); ++b)
        if (const double d = planes[a].plane.height - planes[b].plane.height; std::abs(d) > std::abs(largest)) largest = d;
    out.difference.height[cell] = static_cast<float>(largest);
    out.difference.reason[cell] = core::Void::none;
  }
  books.give(out);
  return out;
}

SwathOverlaps judge_overlaps(const OverlapCells& c) {
  SwathOverlaps out;
  std::map<std::pair<int, int>, OverlapSums> pairs;
  std::map<std::pair<int, int>, Bins> bins;
  OverlapSums whole;
  Bins all, wide;
  for (const OverlapSums& s : c.pairs) {
    const auto [at, fresh] = pairs.try_emplace({s.line_a, s.line_b}, OverlapSums{s.line_a, s.line_b});
    join(at->second, s);
    join(whole, s);
  }
  for (const OverlapBin& b : c.bins) {
    bins[{b.line_a, b.line_b}][b.bin] += b.cells;
    all[b.bin] += b.cells;
    wide[bin_of(b.bin * difference_bin, histogram_bin)] += b.cells;
  }
  for (const auto& [key, sums] : pairs) out.pairs.push_back(pair_of(sums, bins[key]));
  out.all = pair_of(whole, all);
  out.lines = lines_of(c);
  double squares = 0.0;
  for (const SwathLine& l : out.lines) squares += l.hard * l.hard;
  out.hard = std::sqrt(squares / static_cast<double>(out.lines.size()));
  for (const auto& [bin, cells] : wide) {
    out.bins.push_back(bin * histogram_bin);
    out.bin_cells.push_back(cells);
  }
  return out;
}

}  // namespace swath::quality
