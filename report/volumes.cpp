// SPDX-License-Identifier: GPL-3.0-or-later
// The midpoint rule: each cell is a prism of the difference at its centre, whose error is cell^2 / 24 of the difference's curvature. A cell
// through which the difference changes sign counts whole to one side, so cut and fill (not net) are each too small by some
// cell^2 / 8 times the slope of the difference for every unit of that border's length.
//
// Sigma by the law of propagation: with a_c the area and s_c the sigma of a cell and r the correlation,
// var(V) = (1 - r) sum (a_c s_c)^2 + r (sum a_c s_c)^2 for each model, and the sum of both.
#include "report/volumes.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/error.h"
#include "core/ring.h"

namespace swath::report {
namespace {

constexpr double unknown = std::numeric_limits<double>::quiet_NaN();

bool holds(const Ring& r, const Eigen::Vector2d& p) {
  bool odd = false;
  for (size_t k = 0; k < r.size(); ++k) odd = odd != core::crosses_eastward(r[k], r[(k + 1) % r.size()], p.x(), p.y());
  return odd;
}

/// A place inside the ring, away from its sides: the middle of the widest stretch of a row between two of its vertices.
Eigen::Vector2d place_within(const Ring& r) {
  std::vector<double> rows;
  for (const Eigen::Vector2d& p : r) rows.push_back(p.y());
  std::sort(rows.begin(), rows.end());
  rows.erase(std::unique(rows.begin(), rows.end()), rows.end());
  if (rows.size() < 2) return r[0];
  const size_t middle = (rows.size() - 1) / 2;
  const double y = 0.5 * (rows[middle] + rows[middle + 1]);
  std::vector<double> crossings;
  for (size_t k = 0; k < r.size(); ++k) {
    const Eigen::Vector2d &a = r[k], &b = r[(k + 1) % r.size()];
    if ((a.y() > y) != (b.y() > y)) crossings.push_back(a.x() + (y - a.y()) / (b.y() - a.y()) * (b.x() - a.x()));
  }
  std::sort(crossings.begin(), crossings.end());
  size_t widest = 0;
  for (size_t k = 0; k + 1 < crossings.size(); k += 2)
    if (crossings[k + 1] - crossings[k] > crossings[widest + 1] - crossings[widest]) widest = k;
  return {0.5 * (crossings[widest] + crossings[widest + 1]), y};
}

double distance_to_side(const Eigen::Vector2d& a, const Eigen::Vector2d& b, const Eigen::Vector2d& p) {
  const Eigen::Vector2d side = b - a;
  const double length = side.squaredNorm(), t = length > 0.0 ? std::clamp((p - a).dot(side) / length, 0.0, 1.0) : 0.0;
  return (a + t * side - p).norm();
}

bool is_on_side(const Ring& r, const Eigen::Vector2d& p) {
  constexpr double near = 1e-4;  // m or feet: of rounded coordinates
  for (size_t k = 0; k < r.size(); ++k)
    if (distance_to_side(r[k], r[(k + 1) % r.size()], p) <= near) return true;
  return false;
}

/// Is the ring a hole or an island of the other one? Neighbours that share a side are none, nor are polygons that overlap in part.
bool lies_in(const Ring& ring, const Ring& other) {
  return std::abs(core::signed_area(other)) > std::abs(core::signed_area(ring)) && holds(other, place_within(ring)) &&
         std::all_of(ring.begin(), ring.end(), [&](const Eigen::Vector2d& p) { return holds(other, p) || is_on_side(other, p); });
}

/// What of a ring lies where axis (0 x, 1 y) times `sign` is at most `limit` times sign (Sutherland and Hodgman 1974); areas stay right
/// for any simple ring.
Ring clipped(const Ring& r, int axis, double limit, double sign) {
  Ring out;
  for (size_t k = 0; k < r.size(); ++k) {
    const Eigen::Vector2d &a = r[k], &b = r[(k + 1) % r.size()];
    const double da = sign * (limit - a[axis]), db = sign * (limit - b[axis]);
    if (da >= 0.0) out.push_back(a);
    if ((da >= 0.0) != (db >= 0.0)) out.push_back(a + (da / (da - db)) * (b - a));
  }
  return out;
}

}  // namespace

std::vector<double> shares_inside(const core::Lattice& l, const std::vector<Ring>& polygon) {
  std::vector<double> share(l.size(), polygon.empty() ? 1.0 : 0.0);
  for (size_t n = 0; n < polygon.size(); ++n) {
    Ring ring = polygon[n];
    if (ring.size() > 1 && ring.front() == ring.back()) ring.pop_back();
    if (ring.size() < 3) continue;
    int around = 0;
    for (size_t m = 0; m < polygon.size(); ++m) around += m != n && lies_in(ring, polygon[m]);
    const double sign = (around % 2 == 0 ? 1.0 : -1.0) * (core::signed_area(ring) >= 0.0 ? 1.0 : -1.0);
    // Row by row, then cell by cell of what is left of the ring.
    for (int j = 0; j < l.ny; ++j) {
      const double south = static_cast<double>(l.j0 + j) * l.cell, north = static_cast<double>(l.j0 + j + 1) * l.cell;
      Ring row = clipped(clipped(ring, 1, south, -1.0), 1, north, 1.0);
      if (row.size() < 3) continue;
      double low = row[0].x(), high = low;
      for (const Eigen::Vector2d& p : row) low = std::min(low, p.x()), high = std::max(high, p.x());
      const auto first = std::max<std::int64_t>(core::cell_index(low, l.cell) - l.i0, 0);
      const auto last = std::min<std::int64_t>(core::cell_index(high, l.cell) - l.i0, l.nx - 1);
      // What lies west of the first column counts for no cell; the rest is cut off column by column from the west.
      Ring rest = clipped(row, 0, static_cast<double>(l.i0 + first) * l.cell, -1.0);
      for (std::int64_t i = first; i <= last && rest.size() >= 3; ++i) {
        const double east = static_cast<double>(l.i0 + i + 1) * l.cell;
        share[l.at(static_cast<int>(i), j)] += sign * core::signed_area(clipped(rest, 0, east, 1.0)) / (l.cell * l.cell);
        rest = clipped(rest, 0, east, -1.0);
      }
    }
  }
  for (double& s : share) s = std::clamp(s, 0.0, 1.0);
  return share;
}

GridSample sample(const core::Grid& grid, double x, double y) {
  const core::Lattice& l = grid.lattice;
  const double u = x / l.cell - 0.5 - static_cast<double>(l.i0), v = y / l.cell - 0.5 - static_cast<double>(l.j0);
  const double fu = std::floor(u), fv = std::floor(v);
  GridSample out{0.0, grid.sigma.empty() ? unknown : 0.0};
  for (int dj = 0; dj <= 1; ++dj)
    for (int di = 0; di <= 1; ++di) {
      const double w = (di ? u - fu : 1.0 - u + fu) * (dj ? v - fv : 1.0 - v + fv);
      if (w == 0.0) continue;
      const double gi = fu + di, gj = fv + dj;
      const bool known = gi >= 0 && gj >= 0 && gi < l.nx && gj < l.ny;
      const size_t at = known ? l.at(static_cast<int>(gi), static_cast<int>(gj)) : 0;
      out.height += w * (known ? static_cast<double>(grid.height[at]) : unknown);
      if (!grid.sigma.empty()) out.sigma += w * (known ? static_cast<double>(grid.sigma[at]) : unknown);
    }
  return out;
}

core::Grid resampled(const core::Grid& grid, const core::Lattice& lattice) {
  core::Grid out(lattice);
  const bool sigma = !grid.sigma.empty();
  if (sigma) out.sigma.assign(lattice.size(), std::numeric_limits<float>::quiet_NaN());
  for (int j = 0; j < lattice.ny; ++j)
    for (int i = 0; i < lattice.nx; ++i) {
      const GridSample s = sample(grid, lattice.centre_x(i), lattice.centre_y(j));
      const size_t at = lattice.at(i, j);
      out.height[at] = static_cast<float>(s.height);
      if (!std::isnan(s.height)) out.reason[at] = core::Void::none;
      if (sigma) out.sigma[at] = static_cast<float>(s.sigma);
    }
  return out;
}

void VolumeSum::Sum::add(double volume, double area, double s0, double s1) {
  value += volume;
  const std::array<double, 2> s{s0 * area, s1 * area};
  for (size_t m = 0; m < 2; ++m) {
    linear[m] += s[m];
    square[m] += s[m] * s[m];
  }
}

double VolumeSum::Sum::sigma(double correlation) const {
  double variance = 0.0;
  for (size_t m = 0; m < 2; ++m) variance += (1.0 - correlation) * square[m] + correlation * linear[m] * linear[m];
  return std::sqrt(variance);
}

void VolumeSum::add(const core::Grid& before, const core::Grid& after) {
  if (!(before.lattice == after.lattice)) throw core::Error("the two surfaces are not on one lattice", "report.volumes");
  const core::Lattice& l = before.lattice;
  const std::vector<double> share = shares_inside(l, polygon_);
  const auto sigma_of = [](const core::Grid& g, size_t at) { return g.sigma.empty() ? unknown : static_cast<double>(g.sigma[at]); };
  for (size_t k = 0; k < l.size(); ++k) {
    if (share[k] <= 0.0) continue;
    const double area = share[k] * l.cell * l.cell;
    const double rise = (static_cast<double>(after.height[k]) - static_cast<double>(before.height[k])) * height_unit_;
    if (std::isnan(rise)) {
      if (polygon_.empty() && std::isnan(before.height[k]) && std::isnan(after.height[k])) continue;
      ++out_.left_out;
      out_.area_left_out += area;
      continue;
    }
    ++out_.cells;
    out_.area += area;
    const double s0 = sigma_of(before, k) * height_unit_, s1 = sigma_of(after, k) * height_unit_;
    net_.add(rise * area, area, s0, s1);
    if (rise < 0.0) {
      cut_.add(-rise * area, area, s0, s1);
      out_.cut_area += area;
    } else if (rise > 0.0) {
      fill_.add(rise * area, area, s0, s1);
      out_.fill_area += area;
    }
  }
}

Volumes VolumeSum::result() const {
  Volumes out = out_;
  out.cut = cut_.value;
  out.fill = fill_.value;
  out.net = net_.value;
  out.sigma_cut = cut_.sigma(correlation_);
  out.sigma_fill = fill_.sigma(correlation_);
  out.sigma_net = net_.sigma(correlation_);
  return out;
}

Volumes volumes(const core::Grid& before, const core::Grid& after, double height_unit, double correlation,
                const std::vector<Ring>& polygon) {
  VolumeSum sum(height_unit, correlation, polygon);
  sum.add(before, after);
  return sum.result();
}

}  // namespace swath::report
