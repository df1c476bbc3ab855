// SPDX-License-Identifier: GPL-3.0-or-later
// A support is known by the wires that it carries: beside them nothing else may reach up to them, and a tree that does has a crown.
// Deviation from what towers look like: the feet of lattice towers wider than 3 m are not taken.
#include "filters/classes/towers.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "filters/bins.h"

namespace swath::filters {
namespace {

constexpr double tower_cell = 1.0;       // m
constexpr int body_ring = 1;             // cells around the middle one
constexpr int arms_ring = 4;             // cells
constexpr size_t fewest_of_body = 3;     // returns
constexpr double least_body = 3.0;       // m, from the lowest of them to the highest
constexpr double wires_near = 6.0;       // m in plan
constexpr double below_wires = 3.0;      // m below the lowest wire: its top may have been taken for wire
constexpr double crown_depth = 5.0;      // m below its top a crown is wide
constexpr double arms_below = 3.0;       // m
constexpr double most_of_ring = 0.2;     // of its cells: arms
constexpr double least_on_tower = 0.01;  // m of rounding

class TowerSearch {
 public:
  TowerSearch(const core::Block& b, const std::vector<std::uint8_t>& wire, const std::vector<std::uint8_t>& tall)
      : block_(b),
        tall_(b, tower_cell, arms_ring, [&](size_t p) { return tall[p] != 0; }),
        wires_(b, wires_near, 1, [&](size_t p) { return wire[p] != 0; }) {}

  std::vector<std::uint8_t> run(size_t own) const {
    std::vector<std::uint8_t> out(own, 0);
    const core::Lattice& l = tall_.lattice();
    for (int j = arms_ring; j < l.ny - arms_ring; ++j)
      for (int i = arms_ring; i < l.nx - arms_ring; ++i) {
        if (tall_.in(i, j).empty()) continue;
        const std::optional<double> wire = lowest_wire(i, j);
        if (!wire) continue;
        const std::optional<double> top = top_of_body(i, j, *wire);
        if (!top || !is_bare_around(i, j, std::min(*wire, *top))) continue;
        each(i, j, arms_ring, [&](int ring, const Bins::Point& q, std::uint32_t row) {
          if (row < own && (ring <= body_ring || q.z >= *wire - arms_below)) out[row] = 1;
        });
      }
    return out;
  }

 private:
  template <class F>
  void each(int i, int j, int rings, F&& f) const {
    for (int dj = -rings; dj <= rings; ++dj)
      for (int di = -rings; di <= rings; ++di) {
        const auto points = tall_.in(i + di, j + dj);
        const auto rows = tall_.rows(i + di, j + dj);
        for (size_t k = 0; k < points.size(); ++k) f(std::max(std::abs(di), std::abs(dj)), points[k], rows[k]);
      }
  }

  std::optional<double> lowest_wire(int i, int j) const {
    const core::Lattice &l = tall_.lattice(), &w = wires_.lattice();
    const double x = l.centre_x(i), y = l.centre_y(j);
    const int column = static_cast<int>(core::cell_index(x, w.cell) - w.i0), row = static_cast<int>(core::cell_index(y, w.cell) - w.j0);
    double lowest = std::numeric_limits<double>::infinity();
    for (int dj = -1; dj <= 1; ++dj)
      for (int di = -1; di <= 1; ++di) {
        if (!w.holds(column + di, row + dj)) continue;
        for (const Bins::Point& q : wires_.in(column + di, row + dj))
          if (std::hypot(q.x + block_.origin.x() - x, q.y + block_.origin.y() - y) <= wires_near) lowest = std::min(lowest, q.z);
      }
    return std::isfinite(lowest) ? std::optional(lowest) : std::nullopt;
  }

  /// The highest return of what may be a support.
  std::optional<double> top_of_body(int i, int j, double wire) const {
    size_t n = 0;
    double low = std::numeric_limits<double>::infinity(), high = -low;
    each(i, j, body_ring, [&](int, const Bins::Point& q, std::uint32_t) {
      ++n;
      low = std::min(low, q.z), high = std::max(high, q.z);
    });
    if (n < fewest_of_body || high - low < least_body || high < wire - below_wires - least_on_tower) return std::nullopt;
    return high;
  }

  bool is_bare_around(int i, int j, double top) const {
    int taken = 0, cells = 0;
    for (int dj = -arms_ring; dj <= arms_ring; ++dj)
      for (int di = -arms_ring; di <= arms_ring; ++di) {
        if (std::max(std::abs(di), std::abs(dj)) <= body_ring) continue;
        ++cells;
        const auto points = tall_.in(i + di, j + dj);
        taken += std::any_of(points.begin(), points.end(), [&](const Bins::Point& q) { return q.z >= top - crown_depth; });
      }
    return static_cast<double>(taken) <= most_of_ring * static_cast<double>(cells);
  }

  const core::Block& block_;
  Bins tall_, wires_;
};

}  // namespace

double tower_points_halo() { return 2.0 * (arms_ring + 1) * tower_cell + wires_near; }

std::vector<std::uint8_t> tower_points(const core::Block& b, const std::vector<std::uint8_t>& wire, const std::vector<std::uint8_t>& tall,
                                       size_t own) {
  if (std::find(wire.begin(), wire.end(), 1) == wire.end()) return std::vector<std::uint8_t>(own, 0);
  return TowerSearch(b, wire, tall).run(own);
}

}  // namespace swath::filters
