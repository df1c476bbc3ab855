// SPDX-License-Identifier: GPL-3.0-or-later
// Search by rings of lattice columns around the point's own, until the columns left out are farther than the k-th neighbour found. The
// columns are made so wide that the first ring mostly is enough; three columns in a row are one stretch of memory. Surveys are thin in
// height, so that columns in place of cubes cost little. The ball that holds a point's neighbours bounds where those of the next point in
// the column can lie. How wide the columns are decides the time, not the result. A crowded column has a tree of its own: otherwise many
// returns at one place, walls and masts would be compared each with each.
#include "filters/noise/neighbours.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <unordered_map>

#include "filters/bins.h"
#include "filters/noise/column_tree.h"

namespace swath::filters {
namespace {

constexpr double points_per_column = 3.5;
constexpr std::ptrdiff_t crowded = 100;  // points of a column, from which on a tree is faster
constexpr double rounding = 1e-6;        // m, on the safe side of a column's border

/// Side of columns that hold points_per_column on average where there are points at all.
double column_side(const core::Block& b, const std::vector<std::uint8_t>& takes_part, double reach) {
  const core::Lattice coarse = lattice_around(b, reach, 0);
  std::vector<std::uint8_t> occupied(coarse.size(), 0);
  double points = 0;
  for (size_t p = 0; p < b.size(); ++p) {
    if (!takes_part[p]) continue;
    const CellIndex c = cell_of(coarse, b, p);
    occupied[coarse.at(c.i, c.j)] = 1;
    ++points;
  }
  const double area = static_cast<double>(std::count(occupied.begin(), occupied.end(), 1)) * reach * reach;
  double side = std::clamp(std::sqrt(points_per_column * area / std::max(points, 1.0)), 1e-3 * reach, reach);
  // Not more columns than memory for the points themselves.
  const double extent = static_cast<double>(coarse.size()) * reach * reach;
  return std::max(side, std::sqrt(extent / (2.0 * points + 1e4)));
}

/// The k least of the numbers offered that are below a limit, ascending; the places of those not found hold the limit. Without branches
/// where k is known to the compiler.
template <int K>
class Least {
 public:
  explicit Least(int k) : k_(k) {}
  void start(double limit) {
    limit_ = limit;
    std::fill_n(value_.begin(), size(), limit);
  }
  void offer(double v) {
    if (!(v < worst())) return;
    size_t at = size() - 1;
    if constexpr (K > 0) {
      for (; at > 0; --at) value_[at] = std::max(value_[at - 1], std::min(v, value_[at]));
      value_[0] = std::min(v, value_[0]);
    } else {
      for (; at > 0 && value_[at - 1] > v; --at) value_[at] = value_[at - 1];
      value_[at] = v;
    }
  }
  bool full() const { return worst() < limit_; }
  double worst() const { return value_[size() - 1]; }
  int count() const {
    return static_cast<int>(std::lower_bound(value_.begin(), value_.begin() + static_cast<std::ptrdiff_t>(size()), limit_) -
                            value_.begin());
  }
  double operator[](int i) const { return value_[static_cast<size_t>(i)]; }

 private:
  constexpr size_t size() const { return K > 0 ? static_cast<size_t>(K) : static_cast<size_t>(k_); }
  int k_;
  double limit_ = 0;
  static constexpr size_t most = static_cast<size_t>(K == 0 ? most_neighbours + 1 : K);
  std::array<double, most> value_{};
};

double distance(const Bins::Point& a, const Bins::Point& b) {
  return std::sqrt((a.x - b.x) * (a.x - b.x) + (a.y - b.y) * (a.y - b.y) + (a.z - b.z) * (a.z - b.z));
}

/// The points that take part, by columns.
class Columns {
 public:
  Columns(const core::Block& b, double side, const std::vector<std::uint8_t>& takes_part)
      : bins_(b, side, 0, [&](size_t p) { return takes_part[p] != 0; }) {
    const core::Lattice& l = bins_.lattice();
    for (int j = 0; j < l.ny; ++j)
      for (int i = 0; i < l.nx; ++i)
        if (const auto points = bins_.in(i, j); std::ssize(points) > crowded) trees_.try_emplace(l.at(i, j), points);
  }
  const Bins& bins() const { return bins_; }

  /// Offers the squared distances from p to the points of the columns i0 to i1 of row j, at least those that `least` would take.
  template <int K>
  void offer_row(int i0, int i1, int j, const Bins::Point& p, Least<K>& least) const {
    const core::Lattice& l = bins_.lattice();
    if (j < 0 || j >= l.ny) return;
    i0 = std::max(i0, 0);
    i1 = std::min(i1, l.nx - 1);
    if (i0 > i1) return;
    const auto last = bins_.in(i1, j);
    const Bins::Point *const begin = bins_.in(i0, j).data(), *const end = last.data() + last.size();
    if (end - begin <= crowded) {
      offer_all(begin, end, p, least);
      return;
    }
    for (int i = i0; i <= i1; ++i) {
      const auto points = bins_.in(i, j);
      if (std::ssize(points) > crowded)
        trees_.at(l.at(i, j)).offer(p, least);
      else
        offer_all(points.data(), points.data() + points.size(), p, least);
    }
  }

 private:
  template <int K>
  static void offer_all(const Bins::Point* q, const Bins::Point* end, const Bins::Point& p, Least<K>& least) {
    for (; q != end; ++q) {
      const double dx = q->x - p.x, dy = q->y - p.y, dz = q->z - p.z;
      least.offer(dx * dx + dy * dy + dz * dz);
    }
  }

  Bins bins_;
  std::unordered_map<size_t, ColumnTree> trees_;  ///< of the crowded columns, by their place in the lattice
};

template <int K>
std::vector<double> mean_distance(const core::Block& b, const std::vector<std::uint8_t>& takes_part,
                                  const std::vector<std::uint8_t>& wanted, int k, double reach) {
  std::vector<double> mean(b.size(), std::numeric_limits<double>::quiet_NaN());
  if (b.size() == 0) return mean;
  const double side = column_side(b, takes_part, reach);
  const Columns columns(b, side, takes_part);
  const Bins& bins = columns.bins();
  const core::Lattice& l = bins.lattice();
  Least<K> least(k + 1);  // the point itself is one of them
  for (int j = 0; j < l.ny; ++j)
    for (int i = 0; i < l.nx; ++i) {
      const auto points = bins.in(i, j);
      const auto rows = bins.rows(i, j);
      const double west = static_cast<double>(l.i0 + i) * side - b.origin.x(), south = static_cast<double>(l.j0 + j) * side - b.origin.y();
      const Bins::Point* before = nullptr;  // the point before in this column, its neighbours all found
      for (size_t n = 0; n < points.size(); ++n) {
        if (!wanted[rows[n]]) continue;
        const Bins::Point& p = points[n];
        const double margin = std::min(std::min(p.x - west, west + side - p.x), std::min(p.y - south, south + side - p.y)) - rounding;
        const double farthest = before ? std::sqrt(least.worst()) + distance(*before, p) + rounding : reach;
        least.start(farthest < reach ? farthest * farthest : reach * reach);
        for (int dj = -1; dj <= 1; ++dj) columns.offer_row(i - 1, i + 1, j + dj, p, least);
        for (int ring = 1;; ++ring) {
          const double searched = margin + ring * side;
          if (searched >= reach || (least.full() && least.worst() <= searched * searched)) break;
          const int r = ring + 1;
          columns.offer_row(i - r, i + r, j - r, p, least);
          columns.offer_row(i - r, i + r, j + r, p, least);
          for (int dj = -ring; dj <= ring; ++dj) {
            columns.offer_row(i - r, i - r, j + dj, p, least);
            columns.offer_row(i + r, i + r, j + dj, p, least);
          }
        }
        double sum = (k + 1 - least.count()) * reach;
        for (int m = 1; m < least.count(); ++m) sum += std::sqrt(least[m]);
        mean[rows[n]] = least.count() == 1 ? reach : sum / k;
        before = least.full() ? &p : nullptr;
      }
    }
  return mean;
}

}  // namespace

std::vector<double> mean_neighbour_distance(const core::Block& b, const std::vector<std::uint8_t>& takes_part,
                                            const std::vector<std::uint8_t>& wanted, int k, double reach) {
  constexpr int usual = 4;  // the default of filters.outlier
  return k == usual ? mean_distance<usual + 1>(b, takes_part, wanted, k, reach) : mean_distance<0>(b, takes_part, wanted, k, reach);
}

}  // namespace swath::filters
