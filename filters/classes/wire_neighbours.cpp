// SPDX-License-Identifier: GPL-3.0-or-later
// Which neighbours lie on a line is asked for millions of lines: the loop over them is written for vector instructions.
#include "filters/classes/wire_neighbours.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <tuple>

#include "core/wide.h"

namespace swath::filters {
namespace {

constexpr double fit_off = 0.3;       // m from the straight line through two returns to the line through all,
constexpr double fit_length = 7.0;    // m: so near to the point
constexpr double cells_of_fit = 2.0;  // that one return may take in place of one
constexpr auto near2 = static_cast<float>(wire::near_line * wire::near_line);

/// How many of the first `n` places are within near_line of the line from the origin; m along it of these, 0 of others.
SWATH_WIDE int on_line_of(const float* x, const float* y, const float* z, size_t n, float east, float north, float rise, float* along) {
  std::int32_t count = 0;
  for (size_t q = 0; q < n; ++q) {
    const float u = east * x[q] + north * y[q], v = east * y[q] - north * x[q], w = z[q] - rise * u;
    const float off2 = v * v + w * w;
    count += off2 <= near2 ? 1 : 0;
    along[q] = off2 <= near2 ? u : 0.0f;
  }
  return count;
}

}  // namespace

void WireNeighbours::find(const Bins& bins, const core::Block& b, size_t p, double radius) {
  const CellIndex c = cell_of(bins.lattice(), b, p);
  near_.clear();
  for (int ring = 0; ring <= wire::bins_of_reach; ++ring) {
    add_ring(bins, b, p, c, ring, static_cast<float>(radius * radius));
    // All up to `ring` bins away are known now.
    const auto known = static_cast<float>(ring * bins.lattice().cell);
    if (near_.size() < most) continue;
    const auto surely = std::count_if(near_.begin(), near_.end(), [&](const Neighbour& n) { return n.distance2 <= known * known; });
    if (static_cast<size_t>(surely) >= most) break;
  }
  const auto before = [&b](const Neighbour& a, const Neighbour& o) {
    if (a.distance2 != o.distance2) return a.distance2 < o.distance2;
    return std::tie(b.x[a.row], b.y[a.row], b.z[a.row]) < std::tie(b.x[o.row], b.y[o.row], b.z[o.row]);
  };
  if (near_.size() > most) {
    std::nth_element(near_.begin(), near_.begin() + static_cast<std::ptrdiff_t>(most), near_.end(), before);
    near_.resize(most);
  }
  n_ = near_.size();
  for (size_t k = 0; k < n_; ++k) x_[k] = near_[k].x, y_[k] = near_[k].y, z_[k] = near_[k].z;
}

bool WireNeighbours::any_within(double distance) const {
  const auto limit = static_cast<float>(distance * distance);
  return std::any_of(near_.begin(), near_.end(), [limit](const Neighbour& n) { return n.distance2 <= limit; });
}

void WireNeighbours::vote(WireDirections& directions) {
  directions.clear();
  directions.add(x_.data(), y_.data(), z_.data(), n_, bin_.data());
}

bool WireNeighbours::may_be_wire(size_t k) const {
  const float run = std::sqrt(x_[k] * x_[k] + y_[k] * y_[k]);
  const float east = x_[k] / run, north = y_[k] / run, rise = z_[k] / run;
  std::array<float, most> along;
  const int n = on_line_of(x_.data(), y_.data(), z_.data(), n_, east, north, rise, along.data());
  if (n + 1 < wire::fewest) return false;
  const auto [first, last] = std::minmax_element(along.begin(), along.begin() + static_cast<std::ptrdiff_t>(n_));
  return std::max(*last, 0.0f) - std::min(*first, 0.0f) >= static_cast<float>(wire::shortest - wire::near_line) &&
         is_bare(east, north, rise, n + 1);
}

bool WireNeighbours::may_carry_on(size_t k) const {
  const float run = std::sqrt(x_[k] * x_[k] + y_[k] * y_[k]);
  std::array<float, most> along;
  return on_line_of(x_.data(), y_.data(), z_.data(), n_, x_[k] / run, y_[k] / run, z_[k] / run, along.data()) + 1 >= wire::fewest;
}

void WireNeighbours::add_ring(const Bins& bins, const core::Block& b, size_t p, CellIndex c, int ring, float limit) {
  const double px = b.x[p], py = b.y[p], pz = b.z[p];
  for (int dj = -ring; dj <= ring; ++dj)
    for (int di = -ring; di <= ring; di += std::abs(dj) == ring || di == ring ? 1 : 2 * ring) {
      if (!bins.lattice().holds(c.i + di, c.j + dj)) continue;
      const auto points = bins.in(c.i + di, c.j + dj);
      const auto rows = bins.rows(c.i + di, c.j + dj);
      for (size_t k = 0; k < points.size(); ++k) {
        const auto x = static_cast<float>(points[k].x - px), y = static_cast<float>(points[k].y - py),
                   z = static_cast<float>(points[k].z - pz);
        const float d2 = x * x + y * y + z * z;
        if (d2 > 0.0f && d2 <= limit) near_.push_back({d2, x, y, z, rows[k]});
      }
    }
}

/// Do those beside the straight line, so far from its `n` that no fit brings them onto it, take few enough of its cross-section?
bool WireNeighbours::is_bare(float east, float north, float rise, int n) const {
  constexpr auto least = static_cast<float>(wire::on_line + fit_off), farthest = static_cast<float>(clear_tube - fit_off);
  CrossSection cells;
  for (size_t q = 0; q < n_; ++q) {
    const float u = east * x_[q] + north * y_[q], v = east * y_[q] - north * x_[q], w = z_[q] - rise * u;
    const float off2 = v * v + w * w;
    if (std::abs(u) <= static_cast<float>(fit_length) && off2 >= least * least && off2 <= farthest * farthest)
      cells.add(static_cast<double>(v), static_cast<double>(w));
  }
  return static_cast<double>(cells.taken()) <= wire::most_beside * static_cast<double>(n) + cells_of_fit;
}

}  // namespace swath::filters
