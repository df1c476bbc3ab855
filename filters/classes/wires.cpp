// SPDX-License-Identifier: GPL-3.0-or-later
// After Melzer & Briese 2004, "Extraction and modeling of power lines from ALS point clouds" (28th OEAGM workshop): lines in plan, then
// catenaries in their vertical planes; and McLaughlin 2006, "Extracting transmission lines from airborne LIDAR data", IEEE GRSL 3: foliage
// and surfaces differ from wires by what is beside the line. Deviations: in place of a Hough transform of the whole scene, lines through
// the point and each of its neighbours are tried, so that the reach is bounded; a parabola stands for the catenary (1 mm off over 40 m
// where its parameter is 300 m).
#include "filters/classes/wires.h"

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <optional>
#include <tuple>

#include "core/parallel.h"
#include "filters/bins.h"
#include "filters/classes/wire_directions.h"
#include "filters/classes/wire_neighbours.h"
#include "filters/classes/wire_sieve.h"

namespace swath::filters {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;
using namespace wire;

constexpr double reach = 25.0;                // m from the point
constexpr double longest_gap = 7.0;           // m between returns of one wire
constexpr double widest_line_gap = 16.0;      // m between groups of returns where lines of scan run nearly along it
constexpr int fewest_over_gaps = 7;           // returns on the line with such gaps
constexpr double tube_bin = 1.7;              // m: holds what is within the tube and half a step of it along the line
constexpr double sleeve = 0.5;                // m around the line: empty beside a wire, not beside the edge of a surface
constexpr double most_close = 0.1;            // points in it, of the returns on the line
constexpr double most_bent = 0.01;            // 1 / m: twice that of a catenary of parameter 200 m; as much downwards, for noise
constexpr size_t wire_points_at_once = 1024;  // of one thread
constexpr double support_gap = 12.0;          // m of a wire among the returns of its support
constexpr double thinned = 1.0;               // m: of each cube of this side one return takes part in the search for lines

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
  Search(const core::Block& b, const std::vector<std::uint8_t>& candidate, const std::vector<std::uint8_t>& surface, const Districts& where)
      : block_(b),
        candidate_(candidate),
        surface_(surface),
        close_(b, tube_bin, 1, [&](size_t p) { return candidate[p] || surface[p]; }),
        airy_(airy_points(b, candidate, surface, where)),
        few_(thin(b, airy_)) {}

  /// Of the returns that stand for those of their cubes.
  std::vector<std::uint8_t> in_line(const OwnBox& needed) const {
    std::vector<std::uint8_t> out(block_.size(), 0);
    const Bins wide(block_, reach / bins_of_reach, 0, [this](size_t p) { return few_[p] != 0; });
    const auto mark = [&](const auto& may_be) {
      core::in_parallel(block_.size(), wire_points_at_once, [&](size_t from, size_t to) {
        LinesThrough lines(*this, wide);
        for (size_t p = from; p < to; ++p)
          if (needed.holds(block_, p) && may_be(p)) out[p] = lines.any(p);
      });
    };
    mark([this](size_t p) { return few_[p] != 0; });
    if (std::find(out.begin(), out.end(), 1) == out.end()) return out;
    // The others of their cubes.
    const std::vector<std::uint8_t> seeds = out;
    const Bins found(block_, thinned, 0, [&](size_t p) { return seeds[p] != 0; });
    mark([&](size_t p) {
      if (!airy_[p] || few_[p]) return false;
      const CellIndex c = cell_of(found.lattice(), block_, p);
      return !found.in(c.i, c.j).empty();
    });
    return out;
  }

  /// And the candidates that carry on a line of `found` ones, airy or not.
  std::vector<std::uint8_t> with_ends(const std::vector<std::uint8_t>& found, const OwnBox& needed) const {
    std::vector<std::uint8_t> out = found;
    if (std::find(found.begin(), found.end(), 1) == found.end()) return out;
    // Of dense returns the nearest show no direction.
    const auto stands_for = [&](size_t p) { return found[p] && few_[p]; };
    const Bins lines(block_, shortest / bins_of_reach, 0, stands_for), long_lines(block_, reach / bins_of_reach, 0, stands_for);
    core::in_parallel(block_.size(), wire_points_at_once, [&](size_t from, size_t to) {
      WireNeighbours around;
      for (size_t p = from; p < to; ++p) {
        if (!candidate_[p] || found[p] || !needed.holds(block_, p)) continue;
        if (airy_[p] && carried(around, lines, p, shortest, longest_gap, false))
          out[p] = wire_carried_on;
        else if (carried(around, long_lines, p, reach, support_gap, true))
          out[p] = wire_at_support;
      }
    });
    return out;
  }

 private:
  /// Searches wires through points, one after the other.
  class LinesThrough {
   public:
    LinesThrough(const Search& search, const Bins& wide) : search_(search), wide_(wide) {}

    bool any(size_t p) {
      around_.find(wide_, search_.block_, p, reach);
      if (around_.size() + 1 < fewest) return false;
      around_.vote(directions_);
      if (!directions_.any()) return false;
      for (size_t k = 0; k < around_.size(); ++k)
        if (around_.is_line(k) && around_.lies_in(directions_, k) && around_.may_be_wire(k) && search_.is_wire(p, around_, around_[k]))
          return true;
      return false;
    }

   private:
    const Search& search_;
    const Bins& wide_;
    WireNeighbours around_;
    WireDirections directions_{static_cast<float>(near_line), static_cast<float>(steepest),
                               static_cast<float>(0.5 * (shortest - near_line))};
  };

  /// Those near the straight line through the point and `to`, the point among them.
  static std::vector<Vector3d> along(const WireNeighbours& around, const Vector3d& to) {
    std::vector<Vector3d> out;
    const double run = to.head<2>().norm();
    Line line{to.head<2>() / run};
    line.rise = to.z() / run;
    out.emplace_back(Vector3d::Zero());
    for (size_t k = 0; k < around.size(); ++k)
      if (line.off(around[k]) <= near_line) out.push_back(around[k]);
    std::sort(out.begin() + 1, out.end(), [](const Vector3d& a, const Vector3d& b) {
      return std::make_tuple(a.x(), a.y(), a.z()) < std::make_tuple(b.x(), b.y(), b.z());
    });
    return out;
  }

  bool is_wire(size_t p, const WireNeighbours& around, const Vector3d& to) const {
    const std::vector<Vector3d> roughly = along(around, to);
    if (roughly.size() < fewest) return false;
    std::vector<double> on;
    for (const Vector3d& q : roughly) on.push_back(to.head<2>().normalized().dot(q.head<2>()));
    if (!has_stretch(on)) return false;
    const auto line = fit(roughly, to.head<2>());
    if (!line || std::abs(line->bend) > most_bent || std::abs(line->rise) > steepest || line->off(Vector3d::Zero()) > on_line) return false;
    on.clear();
    for (const Vector3d& q : roughly)
      if (line->off(q) <= on_line) on.push_back(line->u(q));
    std::sort(on.begin(), on.end());
    const auto here = std::lower_bound(on.begin(), on.end(), line->u(Vector3d::Zero()));
    return is_clear_stretch(p, *line, on, here, longest_gap, fewest) ||
           is_clear_stretch(p, *line, on, here, widest_line_gap, fewest_over_gaps);
  }

  /// May there be a stretch of line around the point itself, the first of the places? Before the line is fitted.
  static bool has_stretch(std::vector<double>& on) {
    std::sort(on.begin(), on.end());
    auto first = std::lower_bound(on.begin(), on.end(), 0.0), last = first;
    while (first != on.begin() && *first - *(first - 1) <= widest_line_gap + near_line) --first;
    while (last + 1 != on.end() && *(last + 1) - *last <= widest_line_gap + near_line) ++last;
    return last - first + 1 >= fewest && *last - *first >= shortest - near_line;
  }

  /// Are there enough of the places `on` the line, ascending, around `here` without longer gaps, and nearly nothing beside them?
  bool is_clear_stretch(size_t p, const Line& line, const std::vector<double>& on, std::vector<double>::const_iterator here, double gap,
                        int least) const {
    auto first = here, last = here;
    while (first != on.begin() && *first - *(first - 1) <= gap) --first;
    while (last + 1 != on.end() && *(last + 1) - *last <= gap) ++last;
    const auto n = last - first + 1;
    if (n < least || *last - *first < shortest) return false;
    return is_clear(p, line, *first, *last, most_beside * static_cast<double>(n), most_close * static_cast<double>(n));
  }

  /// Do points within the tube around the line from u0 to u1 that are not on it take at most `most_cells` of its cross-section, and are at
  /// most `most_points` in the sleeve around the line or of surfaces?
  bool is_clear(size_t p, const Line& line, double u0, double u1, double most_cells, double most_points) const {
    const core::Lattice& l = close_.lattice();
    const Vector3d at(block_.x[p], block_.y[p], block_.z[p]);
    size_t close = 0;
    CrossSection cells;
    const auto steps = static_cast<int>(std::ceil((u1 - u0) / clear_tube));
    for (int k = 0; k <= steps; ++k) {
      const double middle = u0 + k * clear_tube;
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
            const double u = line.u(to);
            if (u < u0 || u > u1 || static_cast<int>(std::lround((u - u0) / clear_tube)) != k) continue;  // each counts once
            const double away = line.off(to);
            if (away <= on_line || away > clear_tube) continue;
            cells.add(line.v(to), line.w(to));
            close += away <= sleeve || surface_[rows[m]] != 0;
          }
        }
      if (static_cast<double>(cells.taken()) > most_cells || static_cast<double>(close) > most_points) return false;
    }
    return true;
  }

  bool carried(WireNeighbours& around, const Bins& lines, size_t p, double radius, double gap, bool one_side) const {
    around.find(lines, block_, p, radius);
    if (around.size() + 1 < fewest || !around.any_within(gap)) return false;
    for (size_t k = 0; k < around.size(); ++k)
      if (around.is_line(k) && around.may_carry_on(k) && carries_on(around, around[k], gap, one_side)) return true;
    return false;
  }

  /// `one_side`: wires change their slope at a support, so that what is beyond it says nothing.
  static bool carries_on(const WireNeighbours& around, const Vector3d& to, double gap, bool one_side) {
    std::vector<Vector3d> roughly = along(around, to);
    roughly.erase(roughly.begin());  // the line must not follow the point
    if (one_side) std::erase_if(roughly, [&](const Vector3d& q) { return q.head<2>().dot(to.head<2>()) < 0.0; });
    if (roughly.size() + 1 < fewest) return false;
    const auto line = fit(roughly, to.head<2>());
    if (!line || std::abs(line->bend) > most_bent || line->off(Vector3d::Zero()) > on_line) return false;
    return std::any_of(roughly.begin(), roughly.end(), [&](const Vector3d& q) { return line->off(q) <= on_line && q.norm() <= gap; });
  }

  const core::Block& block_;
  const std::vector<std::uint8_t>&candidate_, &surface_;
  Bins close_;
  std::vector<std::uint8_t> airy_, few_;
};

}  // namespace

double wire_points_halo() { return airy_points_halo() + clear_tube + reach + reach + thinned + reach + wires_beyond; }

std::vector<std::uint8_t> wire_points(const core::Block& b, const std::vector<std::uint8_t>& candidate,
                                      const std::vector<std::uint8_t>& surface, const Districts& where, size_t own) {
  if (std::find(candidate.begin(), candidate.end(), 1) == candidate.end()) return std::vector<std::uint8_t>(b.size(), 0);
  const Search search(b, candidate, surface, where);
  return search.with_ends(search.in_line(OwnBox(b, own, reach + thinned + wires_beyond)), OwnBox(b, own, wires_beyond));
}

}  // namespace swath::filters
