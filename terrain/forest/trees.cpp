// SPDX-License-Identifier: GPL-3.0-or-later
// Local maxima in windows that grow with the height (Popescu and Wynne 2004), crowns by the nearest top instead of a watershed: the support
// is finite, so that tiles do not matter. Trees below others have no top and are not found.
#include "terrain/forest/trees.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>
#include <tuple>

#include "core/grid.h"
#include "terrain/forest/canopy.h"

namespace swath::terrain {
namespace {

using Eigen::Vector2d;

constexpr double tallest = 60.0;                       // m: windows and crowns grow no further
constexpr double crown_share = 0.35, crown_rim = 1.0;  // of the height; m
constexpr double crown_depth = 0.4;                    // of the height: lower cells are of something else

double window_of(double height, const TreeOptions& o) { return o.window + o.window_share * std::min(height, tallest); }
double reach_of(double height) { return crown_share * std::min(height, tallest) + crown_rim; }

/// The highest return of each cell, and smoothed heights.
class Canopy {
 public:
  static constexpr std::uint32_t nobody = std::numeric_limits<std::uint32_t>::max();

  Canopy(const core::Block& b, const TreeOptions& o) : block_(b) {
    double west = 1e300, south = 1e300, east = -1e300, north = -1e300;
    for (size_t p = 0; p < b.size(); ++p) {
      if (!is_of_forest(b, p)) continue;
      west = std::min(west, b.origin.x() + b.x[p]), east = std::max(east, b.origin.x() + b.x[p]);
      south = std::min(south, b.origin.y() + b.y[p]), north = std::max(north, b.origin.y() + b.y[p]);
    }
    if (west > east) return;
    lattice_ = core::lattice_of(o.cell, west, south, east + o.cell, north + o.cell);
    highest_.assign(lattice_.size(), nobody);
    for (std::uint32_t p = 0; p < b.size(); ++p)
      if (is_of_forest(b, p) && b.height[p] > 0.0f) {
        std::uint32_t& q = highest_[lattice_.at(column(p), row(p))];
        if (q == nobody || is_higher(p, q)) q = p;
      }
    smooth_.assign(lattice_.size(), 0.0f);
    for (int j = 0; j < lattice_.ny; ++j)
      for (int i = 0; i < lattice_.nx; ++i) smooth_[lattice_.at(i, j)] = mean_around(i, j);
  }

  const core::Lattice& lattice() const { return lattice_; }
  float smooth(int i, int j) const { return smooth_[lattice_.at(i, j)]; }
  float height(int i, int j) const {
    const std::uint32_t p = highest_[lattice_.at(i, j)];
    return p == nobody ? 0.0f : block_.height[p];
  }
  std::uint32_t highest_around(int i, int j) const {
    std::uint32_t best = nobody;
    for (int v = std::max(0, j - 1); v <= std::min(lattice_.ny - 1, j + 1); ++v)
      for (int u = std::max(0, i - 1); u <= std::min(lattice_.nx - 1, i + 1); ++u) {
        const std::uint32_t p = highest_[lattice_.at(u, v)];
        if (p != nobody && (best == nobody || is_higher(p, best))) best = p;
      }
    return best;
  }

 private:
  int column(std::uint32_t p) const {
    return static_cast<int>(core::cell_index(block_.origin.x() + block_.x[p], lattice_.cell) - lattice_.i0);
  }
  int row(std::uint32_t p) const {
    return static_cast<int>(core::cell_index(block_.origin.y() + block_.y[p], lattice_.cell) - lattice_.j0);
  }
  bool is_higher(std::uint32_t p, std::uint32_t q) const {
    return std::tie(block_.height[p], block_.x[p], block_.y[p]) > std::tie(block_.height[q], block_.x[q], block_.y[q]);
  }
  /// Of the cells with returns; summed in the order of the lattice.
  float mean_around(int i, int j) const {
    double sum = 0.0, n = 0.0;
    for (int v = std::max(0, j - 1); v <= std::min(lattice_.ny - 1, j + 1); ++v)
      for (int u = std::max(0, i - 1); u <= std::min(lattice_.nx - 1, i + 1); ++u)
        if (highest_[lattice_.at(u, v)] != nobody) sum += static_cast<double>(height(u, v)), ++n;
    return n > 0.0 ? static_cast<float>(sum / n) : 0.0f;
  }

  const core::Block& block_;
  core::Lattice lattice_{1.0, 0, 0, 0, 0};
  std::vector<std::uint32_t> highest_;
  std::vector<float> smooth_;
};

struct Top {
  int i = 0, j = 0;
  std::uint32_t point = 0;
  double height = 0.0;
};

/// Is no cell within the window higher? Of equal ones the last of the lattice is the top.
bool is_top(const Canopy& c, int i, int j, double radius) {
  const float h = c.smooth(i, j);
  const int n = static_cast<int>(std::floor(radius / c.lattice().cell));
  for (int v = -n; v <= n; ++v)
    for (int u = -n; u <= n; ++u) {
      if ((u == 0 && v == 0) || !c.lattice().holds(i + u, j + v) || std::hypot(u, v) * c.lattice().cell > radius) continue;
      const float other = c.smooth(i + u, j + v);
      if (other > h || (other == h && std::pair(v, u) > std::pair(0, 0))) return false;
    }
  return true;
}

std::vector<Top> tops_of(const core::Block& b, const Canopy& c, const TreeOptions& o) {
  std::vector<Top> out;
  std::set<std::uint32_t> taken;  // two tops beside one return are one tree
  for (int j = 0; j < c.lattice().ny; ++j)
    for (int i = 0; i < c.lattice().nx; ++i) {
      const double h = static_cast<double>(c.smooth(i, j));
      if (h < 0.5 * o.least_height || !is_top(c, i, j, window_of(h, o))) continue;
      const std::uint32_t p = c.highest_around(i, j);
      if (p == Canopy::nobody || static_cast<double>(b.height[p]) < o.least_height || !taken.insert(p).second) continue;
      out.push_back({i, j, p, static_cast<double>(b.height[p])});
    }
  return out;
}

double turn(const Vector2d& a, const Vector2d& b, const Vector2d& c) { return (b - a).x() * (c - a).y() - (b - a).y() * (c - a).x(); }

std::vector<Vector2d> hull(std::vector<Vector2d> p) {
  const auto less = [](const Vector2d& a, const Vector2d& b) { return std::pair(a.x(), a.y()) < std::pair(b.x(), b.y()); };
  std::sort(p.begin(), p.end(), less);
  std::vector<Vector2d> out;
  for (int side = 0; side < 2; ++side) {
    const size_t begin = out.size();
    for (const Vector2d& q : p) {
      while (out.size() >= begin + 2 && turn(out[out.size() - 2], out.back(), q) <= 0.0) out.pop_back();
      out.push_back(q);
    }
    out.pop_back();
    std::reverse(p.begin(), p.end());
  }
  return out;
}

/// The number of the tree that each cell belongs to.
class Crowns {
 public:
  Crowns(const Canopy& c, const std::vector<Top>& tops) : canopy_(c), tree_(c.lattice().size(), -1), away_(c.lattice().size(), 1e300) {
    for (size_t k = 0; k < tops.size(); ++k) claim(tops[k], static_cast<int>(k));
  }
  bool is_of(int i, int j, size_t tree) const { return tree_[canopy_.lattice().at(i, j)] == static_cast<int>(tree); }

 private:
  void claim(const Top& t, int number) {
    const core::Lattice& l = canopy_.lattice();
    const double reach = reach_of(t.height);
    const int n = static_cast<int>(std::ceil(reach / l.cell));
    for (int j = std::max(0, t.j - n); j <= std::min(l.ny - 1, t.j + n); ++j)
      for (int i = std::max(0, t.i - n); i <= std::min(l.nx - 1, t.i + n); ++i) {
        const double d = std::hypot(i - t.i, j - t.j) * l.cell;
        if (d > reach || static_cast<double>(canopy_.height(i, j)) < crown_depth * t.height) continue;
        double& away = away_[l.at(i, j)];
        if (d / t.height < away) away = d / t.height, tree_[l.at(i, j)] = number;  // tops come in the order of the lattice
      }
  }

  const Canopy& canopy_;
  std::vector<int> tree_;
  std::vector<double> away_;
};

}  // namespace

double trees_halo(const TreeOptions& o) { return 2.0 * reach_of(tallest) + window_of(tallest, o) + 6.0 * o.cell; }

std::vector<Tree> find_trees(const core::Block& b, size_t own, const TreeOptions& o) {
  std::vector<Tree> out;
  const Canopy canopy(b, o);
  const std::vector<Top> tops = tops_of(b, canopy, o);
  const Crowns crowns(canopy, tops);
  const core::Lattice& l = canopy.lattice();
  for (size_t k = 0; k < tops.size(); ++k) {
    const Top& t = tops[k];
    if (t.point >= own) continue;
    Tree tree{b.x[t.point], b.y[t.point], b.z[t.point], t.height};
    std::vector<Vector2d> corners;
    const int n = static_cast<int>(std::ceil(reach_of(t.height) / l.cell));
    for (int j = std::max(0, t.j - n); j <= std::min(l.ny - 1, t.j + n); ++j)
      for (int i = std::max(0, t.i - n); i <= std::min(l.nx - 1, t.i + n); ++i) {
        if (!crowns.is_of(i, j, k)) continue;
        tree.crown_area += l.cell * l.cell;
        for (const double u : {-0.5, 0.5})
          for (const double v : {-0.5, 0.5})
            corners.emplace_back(l.centre_x(i) + u * l.cell - b.origin.x(), l.centre_y(j) + v * l.cell - b.origin.y());
      }
    if (corners.empty()) continue;
    tree.crown = hull(std::move(corners));
    out.push_back(std::move(tree));
  }
  std::sort(out.begin(), out.end(), [](const Tree& p, const Tree& q) { return std::tie(p.x, p.y) < std::tie(q.x, q.y); });
  return out;
}

}  // namespace swath::terrain
