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
#include <span>
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
    std::int32_t west = runs[0].i0, east = runs[0].i1, south = runs[0].j, north = south;
    for (const VoidRun& r : runs) {
      west = std::min(west, r.i0), east = std::max(east, r.i1);
      south = std::min(south, r.j), north = std::max(north, r.j);
      runs_.push_back({r.j, r.i0, r.i1});
    }
    std::sort(runs_.begin(), runs_.end());
    south_ = south;
    for (std::int32_t j = south; j <= north + 1; ++j)
      start_.push_back(std::lower_bound(runs_.begin() + (start_.empty() ? 0 : start_.back()), runs_.end(), Run{j, west, west}) -
                       runs_.begin());
    const auto index = [](double v) { return core::cell_index(v, square); };
    squares_ = core::lattice_of(square, west - beside_void, south - beside_void, east + beside_void, north + 1 + beside_void);
    near_.assign(squares_.size(), 0);
    for (const Run& r : runs_)
      for (std::int64_t v = index(r.j - beside_void); v <= index(r.j + beside_void); ++v)
        for (std::int64_t u = index(r.i0 - beside_void); u <= index(r.i1 - 1 + beside_void); ++u)
          near_[squares_.at(static_cast<int>(u - squares_.i0), static_cast<int>(v - squares_.j0))] = 1;
  }
  /// False where none is within `beside_void`.
  bool near(std::int32_t i, std::int32_t j, std::int32_t& vi, std::int32_t& vj) const {
    const std::int64_t u = core::cell_index(i, square) - squares_.i0, v = core::cell_index(j, square) - squares_.j0;
    if (u < 0 || v < 0 || u >= squares_.nx || v >= squares_.ny || !near_[squares_.at(static_cast<int>(u), static_cast<int>(v))])
      return false;
    std::int64_t best = std::int64_t{beside_void} * beside_void + 1;
    const auto rows = static_cast<std::int32_t>(start_.size()) - 1;
    for (std::int32_t row = std::max(0, j - beside_void - south_); row < rows && row <= j + beside_void - south_; ++row) {
      const auto first = runs_.begin() + start_[static_cast<size_t>(row)], end = runs_.begin() + start_[static_cast<size_t>(row) + 1];
      auto at = std::lower_bound(first, end, Run{south_ + row, i - beside_void, i - beside_void});
      if (at != first && std::prev(at)->i1 > i - beside_void) --at;
      for (; at != end && at->i0 <= i + beside_void; ++at) {
        const std::int32_t c = std::clamp(i, at->i0, at->i1 - 1);
        const std::int64_t d = std::int64_t{c - i} * (c - i) + std::int64_t{at->j - j} * (at->j - j);
        if (d < best) best = d, vi = c, vj = at->j;
      }
    }
    return best <= std::int64_t{beside_void} * beside_void;
  }

 private:
  struct Run {
    std::int32_t j, i0, i1;
    auto operator<=>(const Run&) const = default;
  };
  static constexpr double square = 16.0;  // cells: most returns are near no void, which a raster of these shows
  std::vector<Run> runs_;
  std::int32_t south_ = 0;
  std::vector<std::ptrdiff_t> start_;  ///< of each row from south_ on, and the end
  core::Lattice squares_;
  std::vector<std::uint8_t> near_;
};

float order_statistic(std::span<float> values, size_t number) {
  const auto at = values.begin() + static_cast<std::ptrdiff_t>(number);
  std::nth_element(values.begin(), at, values.end());
  return *at;
}

/// The middle value, as core::median has it, of many: a sample says between which two it lies, and only those are put in order. Changes
/// the order; `between` is a store as long.
float median_of(std::span<float> values, std::span<float> between) {
  constexpr size_t sampled = 512;
  const size_t middle = values.size() / 2;
  if (values.size() < 4 * sampled) return order_statistic(values, middle);
  for (size_t k = 0; k < sampled; ++k) between[k] = values[k * values.size() / sampled];
  std::sort(between.begin(), between.begin() + sampled);
  const float low = between[sampled * 43 / 100], high = between[sampled * 57 / 100];
  size_t below = 0, n = 0;
  for (const float v : values) {  // without branches
    between[n] = v;
    below += v < low;
    n += v >= low && v <= high;
  }
  const bool found = below <= middle && middle < below + n;
  return found ? order_statistic(between.first(n), middle - below) : order_statistic(values, middle);
}

/// Returns of the ground by squares of `bin`, column by column (counting sort).
class Ground {
 public:
  explicit Ground(const core::Block& b) {
    const auto is_ground = [&](size_t p) { return !b.classification.empty() && b.classification[p] == core::point_class::ground; };
    bool any = false;
    for (size_t p = 0; p < b.size() && !any; ++p) any = is_ground(p);
    constexpr double far = std::numeric_limits<double>::infinity();
    double west = far, south = far, east = -far, north = -far;
    std::vector<std::uint32_t> rows;
    for (std::uint32_t p = 0; p < b.size(); ++p) {
      if (!core::is_usable(b, p) || !(any ? is_ground(p) : core::is_last_return(b, p))) continue;
      if (!std::isfinite(b.x[p]) || !std::isfinite(b.y[p])) continue;
      rows.push_back(p);
      west = std::min(west, b.x[p]), east = std::max(east, b.x[p]);
      south = std::min(south, b.y[p]), north = std::max(north, b.y[p]);
    }
    if (!rows.empty()) {  // the easternmost and northernmost may lie on the border of a square
      const std::int64_t i0 = core::cell_index(west, bin), j0 = core::cell_index(south, bin);
      squares_ = {bin, i0, j0, static_cast<int>(core::cell_index(east, bin) - i0 + 1),
                  static_cast<int>(core::cell_index(north, bin) - j0 + 1)};
    }
    std::vector<std::uint32_t> square;
    for (const std::uint32_t p : rows) square.push_back(static_cast<std::uint32_t>(at(column(b.x[p]), row(b.y[p]))));
    start_.assign(squares_.size() + 1, 0);
    for (const std::uint32_t s : square) ++start_[s];
    std::uint32_t sum = 0;
    for (std::uint32_t& s : start_) s = sum += s;  // the end of each, which moves to the start as it is filled
    for (auto* values : {&x_, &y_}) values->resize(sum);
    for (auto* values : {&z_, &heights_, &between_}) values->resize(sum);
    for (size_t k = rows.size(); k-- > 0;) {
      const std::uint32_t p = rows[k], place = --start_[square[k]];
      x_[place] = b.x[p], y_[place] = b.y[p], z_[place] = static_cast<float>(b.origin.z() + b.z[p]);
    }
  }
  /// x, y from the block's origin.
  float behind(double x, double y) {
    size_t n = 0;
    const std::int64_t j0 = std::max<std::int64_t>(row(y - to), 0), j1 = std::min<std::int64_t>(row(y + to), squares_.ny - 1);
    for (std::int64_t i = std::max<std::int64_t>(column(x - to), 0); i <= std::min<std::int64_t>(column(x + to), squares_.nx - 1); ++i) {
      if (j0 > j1) break;
      const std::uint32_t end = start_[at(i, j1) + 1];
      for (std::uint32_t k = start_[at(i, j0)]; k < end; ++k) {
        heights_[n] = z_[k];
        n += in_ring(x_[k] - x, y_[k] - y);
      }
    }
    if (n < fewest_behind) return std::numeric_limits<float>::quiet_NaN();
    return median_of({heights_.data(), n}, between_);
  }

 private:
  std::int64_t column(double x) const { return core::cell_index(x, bin) - squares_.i0; }
  std::int64_t row(double y) const { return core::cell_index(y, bin) - squares_.j0; }
  size_t at(std::int64_t i, std::int64_t j) const { return static_cast<size_t>(i * squares_.ny + j); }
  static bool in_ring(double dx, double dy) {
    constexpr double rounding = 1e-9;  // m2: nearer to a border the exact distance decides
    const double d = dx * dx + dy * dy;
    if (std::abs(d - from * from) > rounding && std::abs(d - to * to) > rounding) return d > from * from && d < to * to;
    const double exact = std::hypot(dx, dy);
    return exact >= from && exact <= to;
  }

  core::Lattice squares_;
  std::vector<std::uint32_t> start_;  ///< of each square's returns, and the end
  std::vector<double> x_, y_;
  std::vector<float> z_;
  std::vector<float> heights_, between_;  ///< stores of behind()
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
  Ground ground(b);
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
    if (std::pair(vi, vj) < std::pair(at->second.void_i, at->second.void_j)) at->second.void_i = vi, at->second.void_j = vj;
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
