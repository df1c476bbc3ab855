// SPDX-License-Identifier: GPL-3.0-or-later
// After Melzer & Briese 2004, "Extraction and modeling of power lines from ALS point clouds" (28th OEAGM workshop): lines in plan, then
// catenaries in their vertical planes; and McLaughlin 2006, "Extracting transmission lines from airborne LIDAR data", IEEE GRSL 3: foliage
// and surfaces told from wires by what is beside the line. Deviations: in place of a Hough transform of the whole scene, lines through the
// point and each of its neighbours are tried, so that the reach is bounded; a parabola stands for the catenary (1 mm off over 40 m where
// its parameter is 300 m).
#include "filters/wires.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <optional>
#include <tuple>

#include "filters/bins.h"

namespace swath::filters {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr double reach = 25.0;          // m from the point
constexpr double shortest = 15.0;       // m of line
constexpr double longest_gap = 7.0;     // m between returns of one wire
constexpr double widest_gap = 16.0;     // m between groups of returns where lines of scan run nearly along it
constexpr int fewest_over_gaps = 7;     // returns on the line with such gaps
constexpr double least_baseline = 4.0;  // m from the point to the one that gives the direction
constexpr double near_line = 0.5;       // m from the line through two returns, each off the wire by up to half the beam's width
constexpr double on_line = 0.4;         // m from the line through all; holds a bundle of conductors together
constexpr double clear_tube = 1.5;      // m around the line
constexpr double sleeve = 0.5;          // m around the line: empty beside a wire, not beside the edge of a surface
constexpr double most_close = 0.1;      // points in it, of the returns on the line
constexpr double cross_cell = 0.5;      // m, raster of the tube's cross-section
constexpr double most_beside = 0.25;    // cells of it beside the line, of the returns on the line
constexpr int fewest = 5;               // returns on the line
constexpr double steepest = 0.58;       // rise / run: a span of 150 m up a slope of 30 degrees
constexpr double most_bent = 0.01;      // 1 / m: twice that of a catenary of parameter 200 m; as much downwards, for noise
constexpr double thinned = 1.0;         // m: of each cube of this side one return takes part in the search for lines
constexpr size_t most_nearest = 96;     // neighbours looked at
constexpr size_t crowd = 4;             // within the tube's radius: fewer pass unseen

struct Neighbour {
  double distance2;
  Vector3d to;
};

std::vector<Neighbour> within(const Bins& bins, const core::Block& b, size_t p, double radius, size_t most) {
  std::vector<Neighbour> out;
  const core::Lattice& l = bins.lattice();
  const CellIndex c = cell_of(l, b, p);
  const Vector3d at(b.x[p], b.y[p], b.z[p]);
  for (int dj = -1; dj <= 1; ++dj)
    for (int di = -1; di <= 1; ++di)
      for (const Bins::Point& q : bins.in(c.i + di, c.j + dj)) {
        const Vector3d to = Vector3d(q.x, q.y, q.z) - at;
        const double d2 = to.squaredNorm();
        if (d2 > 0.0 && d2 <= radius * radius) out.push_back({d2, to});
      }
  const auto before = [](const Neighbour& a, const Neighbour& o) {
    return std::make_tuple(a.distance2, a.to.x(), a.to.y(), a.to.z()) < std::make_tuple(o.distance2, o.to.x(), o.to.y(), o.to.z());
  };
  if (out.size() > most) {
    std::nth_element(out.begin(), out.begin() + static_cast<std::ptrdiff_t>(most), out.end(), before);
    out.resize(most);
  }
  std::sort(out.begin(), out.end(), before);
  return out;
}

/// Cells of a line's cross-section that hold points.
class CrossSection {
 public:
  void add(double v, double w) {
    cells_.emplace_back(static_cast<int>(std::floor(v / cross_cell)), static_cast<int>(std::floor(w / cross_cell)));
  }
  size_t taken() {
    std::sort(cells_.begin(), cells_.end());
    return static_cast<size_t>(std::unique(cells_.begin(), cells_.end()) - cells_.begin());
  }

 private:
  std::vector<std::pair<int, int>> cells_;
};

/// Do the points within the tube's radius of the point itself lie on a line with it or on few beside it, as far as they are many?
bool is_airy(const std::vector<Neighbour>& near) {
  if (near.size() < crowd) return true;
  return std::any_of(near.begin(), near.end(), [&](const Neighbour& n) {
    const Vector3d along = n.to / std::sqrt(n.distance2), across = along.unitOrthogonal(), third = along.cross(across);
    CrossSection beside;
    for (const Neighbour& q : near)
      if (std::sqrt(std::pow(across.dot(q.to), 2) + std::pow(third.dot(q.to), 2)) > on_line) beside.add(across.dot(q.to), third.dot(q.to));
    return static_cast<double>(beside.taken()) <= most_beside * static_cast<double>(near.size() + 1);
  });
}

/// u along, v across in plan, both from the point; w = level + rise u + bend u^2 / 2 in height.
struct Line {
  Vector2d along;
  double across = 0, level = 0, rise = 0, bend = 0;
  double u(const Vector3d& to) const { return along.dot(to.head<2>()); }
  double v(const Vector3d& to) const { return along.x() * to.y() - along.y() * to.x() - across; }
  double w(const Vector3d& to) const {
    const double s = u(to);
    return to.z() - level - rise * s - 0.5 * bend * s * s;
  }
  double off(const Vector3d& to) const { return std::sqrt(v(to) * v(to) + w(to) * w(to)); }
};

/// Least squares: a straight line in plan, a parabola in height.
std::optional<Line> fit(const std::vector<Vector3d>& on, const Vector2d& roughly) {
  const auto n = static_cast<double>(on.size());
  Vector2d mean = Vector2d::Zero();
  for (const Vector3d& q : on) mean += q.head<2>() / n;
  Eigen::Matrix2d spread = Eigen::Matrix2d::Zero();
  for (const Vector3d& q : on) spread += (q.head<2>() - mean) * (q.head<2>() - mean).transpose();
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d> axes(spread);
  Line line;
  line.along = axes.eigenvectors().col(1);
  if (line.along.dot(roughly) < 0) line.along = -line.along;
  line.across = line.along.x() * mean.y() - line.along.y() * mean.x();
  Eigen::Matrix3d normal = Eigen::Matrix3d::Zero();
  Vector3d right = Vector3d::Zero();
  for (const Vector3d& q : on) {
    const double u = line.u(q);
    const Vector3d row(1.0, u, 0.5 * u * u);
    normal += row * row.transpose();
    right += row * q.z();
  }
  const Vector3d parabola = normal.ldlt().solve(right);
  if (!parabola.allFinite()) return std::nullopt;
  line.level = parabola(0), line.rise = parabola(1), line.bend = parabola(2);
  return line;
}

/// Of the marked points one in each cube of the survey's lattice, the first by coordinates.
std::vector<std::uint8_t> thin(const core::Block& b, const std::vector<std::uint8_t>& marked) {
  struct Entry {
    std::int64_t i, j, k;
    std::uint32_t row;
  };
  std::vector<Entry> entries;
  for (std::uint32_t p = 0; p < b.size(); ++p)
    if (marked[p])
      entries.push_back({core::cell_index(b.origin.x() + b.x[p], thinned), core::cell_index(b.origin.y() + b.y[p], thinned),
                         core::cell_index(b.origin.z() + b.z[p], thinned), p});
  std::sort(entries.begin(), entries.end(), [&](const Entry& a, const Entry& o) {
    return std::tie(a.i, a.j, a.k, b.x[a.row], b.y[a.row], b.z[a.row]) < std::tie(o.i, o.j, o.k, b.x[o.row], b.y[o.row], b.z[o.row]);
  });
  std::vector<std::uint8_t> out(b.size(), 0);
  for (size_t n = 0; n < entries.size(); ++n) {
    const Entry &e = entries[n], *before = n > 0 ? &entries[n - 1] : nullptr;
    out[e.row] = !before || std::tie(e.i, e.j, e.k) != std::tie(before->i, before->j, before->k);
  }
  return out;
}

class Search {
 public:
  Search(const core::Block& b, const std::vector<std::uint8_t>& candidate, const std::vector<std::uint8_t>& surface)
      : block_(b),
        surface_(surface),
        close_(b, clear_tube, 1, [&](size_t p) { return candidate[p] || surface[p]; }),
        airy_(airy(candidate)),
        wide_(b, reach, 1, [few = thin(b, airy_)](size_t p) { return few[p] != 0; }) {}

  std::vector<std::uint8_t> in_line() const {
    std::vector<std::uint8_t> out(block_.size(), 0);
    for (size_t p = 0; p < block_.size(); ++p) {
      if (!airy_[p]) continue;
      const std::vector<Neighbour> around = within(wide_, block_, p, reach, most_nearest);
      if (around.size() + 1 < fewest) continue;
      out[p] = std::any_of(around.begin(), around.end(), [&](const Neighbour& n) { return is_wire(p, around, n.to); });
    }
    return out;
  }

  /// And the airy points that carry on a line of `found` ones.
  std::vector<std::uint8_t> with_ends(const std::vector<std::uint8_t>& found) const {
    std::vector<std::uint8_t> out = found;
    const Bins lines(block_, reach, 1, [&](size_t p) { return found[p] != 0; });
    for (size_t p = 0; p < block_.size(); ++p) {
      if (!airy_[p] || found[p]) continue;
      const std::vector<Neighbour> around = within(lines, block_, p, shortest, most_nearest);
      if (around.size() + 1 < fewest || around.front().distance2 > longest_gap * longest_gap) continue;
      out[p] = std::any_of(around.begin(), around.end(), [&](const Neighbour& n) { return carries_on(around, n.to); });
    }
    return out;
  }

 private:
  std::vector<std::uint8_t> airy(const std::vector<std::uint8_t>& candidate) const {
    std::vector<std::uint8_t> out(block_.size(), 0);
    for (size_t p = 0; p < block_.size(); ++p) out[p] = candidate[p] && is_airy(within(close_, block_, p, clear_tube, most_nearest));
    return out;
  }

  /// Those near the straight line through the point and `to`, the point among them.
  static std::vector<Vector3d> along(const std::vector<Neighbour>& around, const Vector3d& to) {
    std::vector<Vector3d> out;
    const double run = to.head<2>().norm();
    if (run < least_baseline || std::abs(to.z()) > steepest * run) return out;
    Line line{to.head<2>() / run};
    line.rise = to.z() / run;
    out.emplace_back(Vector3d::Zero());
    for (const Neighbour& q : around)
      if (line.off(q.to) <= near_line) out.push_back(q.to);
    return out;
  }

  bool is_wire(size_t p, const std::vector<Neighbour>& around, const Vector3d& to) const {
    const std::vector<Vector3d> roughly = along(around, to);
    if (roughly.size() < fewest) return false;
    const auto line = fit(roughly, to.head<2>());
    if (!line || std::abs(line->bend) > most_bent || std::abs(line->rise) > steepest || line->off(Vector3d::Zero()) > on_line) return false;
    std::vector<double> on;
    for (const Vector3d& q : roughly)
      if (line->off(q) <= on_line) on.push_back(line->u(q));
    std::sort(on.begin(), on.end());
    const auto here = std::lower_bound(on.begin(), on.end(), line->u(Vector3d::Zero()));
    return is_clear_stretch(p, *line, on, here, longest_gap, fewest) || is_clear_stretch(p, *line, on, here, widest_gap, fewest_over_gaps);
  }

  /// Are there enough of the places `on` the line, ascending, around `here` without longer gaps, and nearly nothing beside them?
  bool is_clear_stretch(size_t p, const Line& line, const std::vector<double>& on, std::vector<double>::const_iterator here, double gap,
                        int least) const {
    auto first = here, last = here;
    while (first != on.begin() && *first - *(first - 1) <= gap) --first;
    while (last + 1 != on.end() && *(last + 1) - *last <= gap) ++last;
    const auto n = last - first + 1;
    if (n < least || *last - *first < shortest) return false;
    const Beside b = beside(p, line, *first, *last);
    return static_cast<double>(b.cells) <= most_beside * static_cast<double>(n) &&
           static_cast<double>(b.close) <= most_close * static_cast<double>(n);
  }

  /// What is within the tube around the line from u0 to u1 and not on it.
  struct Beside {
    size_t close = 0;  ///< points of the sleeve around the line, and those of surfaces anywhere in the tube
    size_t cells = 0;  ///< of the cross-section that hold any
  };
  Beside beside(size_t p, const Line& line, double u0, double u1) const {
    const core::Lattice& l = close_.lattice();
    const Vector3d at(block_.x[p], block_.y[p], block_.z[p]);
    Beside found;
    CrossSection cells;
    const auto steps = static_cast<int>(std::ceil((u1 - u0) / clear_tube));
    for (int k = 0; k <= steps; ++k) {
      const double middle = std::min(u0 + k * clear_tube, u1);
      const Vector2d place = at.head<2>() + middle * line.along + line.across * Vector2d(-line.along.y(), line.along.x());
      const int i = static_cast<int>(core::cell_index(block_.origin.x() + place.x(), l.cell) - l.i0),
                j = static_cast<int>(core::cell_index(block_.origin.y() + place.y(), l.cell) - l.j0);
      for (int dj = -1; dj <= 1; ++dj)
        for (int di = -1; di <= 1; ++di) {
          if (!l.holds(i + di, j + dj)) continue;
          const auto points = close_.in(i + di, j + dj);
          const auto rows = close_.rows(i + di, j + dj);
          for (size_t m = 0; m < points.size(); ++m) {
            const Vector3d to = Vector3d(points[m].x, points[m].y, points[m].z) - at;
            if (const double u = line.u(to); u < u0 || u > u1) continue;
            const double away = line.off(to);
            if (away <= on_line || away > clear_tube) continue;
            cells.add(line.v(to), line.w(to));
            found.close += away <= sleeve || surface_[rows[m]] != 0;
          }
        }
    }
    found.cells = cells.taken();
    return found;
  }

  static bool carries_on(const std::vector<Neighbour>& around, const Vector3d& to) {
    std::vector<Vector3d> roughly = along(around, to);
    if (roughly.size() < fewest) return false;
    roughly.erase(roughly.begin());  // the line must not follow the point
    const auto line = fit(roughly, to.head<2>());
    if (!line || std::abs(line->bend) > most_bent || line->off(Vector3d::Zero()) > on_line) return false;
    return std::any_of(roughly.begin(), roughly.end(),
                       [&](const Vector3d& q) { return line->off(q) <= on_line && q.norm() <= longest_gap; });
  }

  const core::Block& block_;
  const std::vector<std::uint8_t>& surface_;
  Bins close_;
  std::vector<std::uint8_t> airy_;
  Bins wide_;
};

}  // namespace

double wire_points_halo() { return clear_tube + reach + shortest + reach; }

std::vector<std::uint8_t> wire_points(const core::Block& b, const std::vector<std::uint8_t>& candidate,
                                      const std::vector<std::uint8_t>& surface) {
  if (b.size() == 0) return {};
  const Search search(b, candidate, surface);
  return search.with_ends(search.in_line());
}

}  // namespace swath::filters
