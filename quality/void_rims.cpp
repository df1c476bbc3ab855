// SPDX-License-Identifier: GPL-3.0-or-later
// A water that swallows the pulses leaves a void whose rim is level, for the water is, and below the ground around, for it runs there.
// What else makes voids does not: the shadow of a building has a roof on one side and on the other ground that goes on as high; dark
// asphalt and roofing lie level with what is beside them, or above; a gap between lines runs over ground of any height. Not distinguished
// from water: a sunken car park whose surface returns nothing at all. Not found: a canal whose quays are upright and as high as the
// streets, where no return lies below them (class water or breaklines show it).
#include "quality/void_rims.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <tuple>

#include "core/statistics.h"

namespace swath::quality {
namespace {

constexpr int beside_void = 6;                                         // cells: 1.5 ANPS
constexpr double from = 3.0, to = 6.0;                                 // m, the ground behind
constexpr size_t fewest_behind = 5;                                    // returns
constexpr double bin = 2.0;                                            // m, of the ground's index
constexpr size_t fewest_pieces = 8, nearest = 40, most_judged = 2000;  // pieces
constexpr double level_share = 0.2, tolerance = 0.3, least_level = 0.4;
constexpr double rise = 0.1, least_rising = 0.8, most_falling = 0.15, above_level = 0.2;

/// The void's cells by rows, to find the nearest to a place.
class Rows {
 public:
  explicit Rows(const std::vector<VoidRun>& runs) {
    for (const VoidRun& r : runs) rows_[r.j].push_back({r.i0, r.i1});
    for (auto& [j, row] : rows_) std::sort(row.begin(), row.end());
  }
  /// False where none is within `beside`.
  bool near(std::int32_t i, std::int32_t j, std::int32_t& vi, std::int32_t& vj) const {
    std::int64_t best = std::int64_t{beside_void} * beside_void + 1;
    for (auto row = rows_.lower_bound(j - beside_void); row != rows_.end() && row->first <= j + beside_void; ++row) {
      auto at = std::lower_bound(row->second.begin(), row->second.end(), std::pair(i - beside_void, i - beside_void));
      if (at != row->second.begin() && std::prev(at)->second > i - beside_void) --at;
      for (; at != row->second.end() && at->first <= i + beside_void; ++at) {
        const std::int32_t u = std::clamp(i, at->first, at->second - 1);
        const std::int64_t d = std::int64_t{u - i} * (u - i) + std::int64_t{row->first - j} * (row->first - j);
        if (d < best) best = d, vi = u, vj = row->first;
      }
    }
    return best <= std::int64_t{beside_void} * beside_void;
  }

 private:
  std::map<std::int32_t, std::vector<std::pair<std::int32_t, std::int32_t>>> rows_;
};

/// Returns of the ground by squares of `bin`.
class Ground {
 public:
  explicit Ground(const core::Block& b) : block_(b) {
    const auto is_ground = [&](size_t p) { return !b.classification.empty() && b.classification[p] == core::point_class::ground; };
    bool any = false;
    for (size_t p = 0; p < b.size() && !any; ++p) any = is_ground(p);
    for (size_t p = 0; p < b.size(); ++p)
      if (core::is_usable(b, p) && (any ? is_ground(p) : core::is_last_return(b, p))) rows_.emplace_back(bin_of(b.x[p], b.y[p]), p);
    std::sort(rows_.begin(), rows_.end());
  }
  /// x, y from the block's origin.
  float behind(double x, double y) const {
    std::vector<double> heights;
    const auto [i0, j0] = bin_of(x - to, y - to);
    const auto [i1, j1] = bin_of(x + to, y + to);
    for (std::int32_t i = i0; i <= i1; ++i)
      for (auto at = std::lower_bound(rows_.begin(), rows_.end(), Row{{i, j0}, 0}); at != rows_.end() && at->first <= Bin{i, j1}; ++at) {
        const double d = std::hypot(block_.x[at->second] - x, block_.y[at->second] - y);
        if (d >= from && d <= to) heights.push_back(block_.origin.z() + block_.z[at->second]);
      }
    return heights.size() < fewest_behind ? std::numeric_limits<float>::quiet_NaN() : static_cast<float>(core::median(heights));
  }

 private:
  using Bin = std::pair<std::int32_t, std::int32_t>;
  using Row = std::pair<Bin, size_t>;
  static Bin bin_of(double x, double y) {
    return {static_cast<std::int32_t>(core::cell_index(x, bin)), static_cast<std::int32_t>(core::cell_index(y, bin))};
  }
  const core::Block& block_;
  std::vector<Row> rows_;
};

/// The level at a piece: of those nearest to it.
double level_at(const std::vector<RimPiece>& rim, const RimPiece& p) {
  std::vector<std::pair<std::int64_t, double>> by_distance;
  for (const RimPiece& q : rim)
    by_distance.emplace_back(std::int64_t{p.i - q.i} * (p.i - q.i) + std::int64_t{p.j - q.j} * (p.j - q.j), static_cast<double>(q.low));
  const size_t n = std::min(nearest, by_distance.size());
  std::partial_sort(by_distance.begin(), by_distance.begin() + static_cast<std::ptrdiff_t>(n), by_distance.end());
  std::vector<double> lows;
  for (size_t k = 0; k < n; ++k) lows.push_back(by_distance[k].second);
  return core::quantile(lows, level_share);
}

}  // namespace

std::vector<RimPiece> rims_of(const core::Block& b, const std::vector<VoidRun>& runs, const PulseSpacing& spacing) {
  if (runs.empty()) return {};
  const double cell = void_cell(spacing), side = rim_side(spacing.rule);
  const Rows rows(runs);
  const Ground ground(b);
  std::map<std::tuple<std::int32_t, std::int32_t, std::int32_t, std::int32_t>, RimPiece> pieces;  // by square, and that of the void's cell
  std::map<std::pair<std::int32_t, std::int32_t>, float> behind;
  const auto index = [](double v, double of) { return static_cast<std::int32_t>(core::cell_index(v, of)); };
  std::int32_t vi = 0, vj = 0;
  for (size_t p = 0; p < b.size(); ++p) {
    if (!core::is_usable(b, p)) continue;
    const double x = b.origin.x() + b.x[p], y = b.origin.y() + b.y[p];
    if (!rows.near(index(x, cell), index(y, cell), vi, vj)) continue;
    const std::int32_t i = index(x, side), j = index(y, side);
    const auto z = static_cast<float>(b.origin.z() + b.z[p]);
    const auto [at, is_new] = pieces.try_emplace({i, j, vi >> 4, vj >> 4}, RimPiece{i, j, vi, vj, z, 0.0F});
    at->second.low = std::min(at->second.low, z);
    if (!is_new) continue;
    const auto [ground_at, is_first] = behind.try_emplace({i, j}, 0.0F);
    if (is_first) ground_at->second = ground.behind((i + 0.5) * side - b.origin.x(), (j + 0.5) * side - b.origin.y());
    at->second.behind = ground_at->second;
  }
  std::vector<RimPiece> out;
  for (const auto& [key, piece] : pieces) out.push_back(piece);
  return out;
}

bool is_shore(std::vector<RimPiece> rim) {
  // Of pieces of one square the lowest; those that know no ground behind say nothing.
  std::sort(rim.begin(), rim.end(),
            [](const RimPiece& a, const RimPiece& b) { return std::tuple(a.i, a.j, a.low) < std::tuple(b.i, b.j, b.low); });
  rim.erase(std::unique(rim.begin(), rim.end(), [](const RimPiece& a, const RimPiece& b) { return a.i == b.i && a.j == b.j; }), rim.end());
  std::erase_if(rim, [](const RimPiece& p) { return !std::isfinite(p.behind); });
  if (rim.size() < fewest_pieces) return false;
  double all = 0.0, level = 0.0, rising = 0.0, falling = 0.0;
  std::vector<double> above;
  for (size_t k = 0; k < rim.size(); k += 1 + rim.size() / most_judged) {
    const auto low = static_cast<double>(rim[k].low), behind = static_cast<double>(rim[k].behind), here = level_at(rim, rim[k]);
    ++all;
    above.push_back(behind - here);
    if (std::abs(low - here) > tolerance) continue;
    ++level, rising += behind - low >= rise, falling += behind - low <= -rise;
  }
  return level >= least_level * all && rising >= least_rising * level && falling <= most_falling * level &&
         core::median(above) >= above_level;
}

}  // namespace swath::quality
