// SPDX-License-Identifier: GPL-3.0-or-later
// A support is known by the wires that it carries: beside them nothing else may reach up to them, and a tree that does has a crown.
// Deviation from what towers look like: the feet of lattice towers wider than 3 m are not taken.
#include "filters/classes/towers.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <tuple>

#include "core/config/units.h"
#include "filters/bins.h"
#include "filters/classes/wires.h"

namespace swath::filters {
namespace {

constexpr double tower_cell = 1.0;     // m
constexpr int body_ring = 1;           // cells around the middle one
constexpr int arms_ring = 4;           // cells
constexpr size_t fewest_of_body = 3;   // returns
constexpr double least_body = 3.0;     // m, from the lowest of them to the highest
constexpr double wires_near = 6.0;     // m in plan
constexpr double below_wires = 3.0;    // m below the lowest wire: its top may have been taken for wire
constexpr double crown_depth = 5.0;    // m below its top a crown is wide
constexpr double arms_below = 3.0;     // m
constexpr double most_of_ring = 0.2;   // of its cells: arms
constexpr double most_off_row = 0.05;  // of its cells: beside arms of lattice, which are several cells wide
constexpr double row_half = 1.0;       // m: half the width of arms
constexpr int row_directions = 16;
constexpr double least_on_tower = 0.01;  // m of rounding
constexpr double gap_of_body = 5.0;      // m between returns of a body one above the other: a crown below it is looked at
constexpr double gap_of_pole = 10.0;     // m between those of a pole, which few pulses hit
constexpr double pole_radius = 0.7;      // m: half a footprint and half the pole
constexpr double least_pole = 5.0;       // m, as least_body
constexpr double above_wires = 8.0;      // m above the highest wire: arms of earth wires
constexpr double upper_part = 8.0;       // m below the top: above bushes at its foot
constexpr double beside_body = 0.5;      // m: returns belong to it

class TowerSearch {
 public:
  TowerSearch(const core::Block& b, const std::vector<std::uint8_t>& wire, const std::vector<std::uint8_t>& tall)
      : block_(b),
        tall_(b, tower_cell, arms_ring, [&](size_t p) { return tall[p] != 0; }),
        wires_(b, wires_near, 1, [&](size_t p) { return wire[p] == 1 || wire[p] == wire_carried_on; }),
        wire_(wire) {}

  std::vector<std::uint8_t> run(size_t own) const {
    std::vector<std::uint8_t> out(own, 0);
    const core::Lattice& l = tall_.lattice();
    for (int j = arms_ring; j < l.ny - arms_ring; ++j)
      for (int i = arms_ring; i < l.nx - arms_ring; ++i) {
        if (tall_.in(i, j).empty()) continue;
        const std::optional<Range> wires = wires_around(i, j);
        if (!wires) continue;
        const std::optional<Body> body = body_at(i, j, *wires);
        if (!body || !is_bare_around(i, j, std::min(wires->low, body->top) - crown_depth, *body)) continue;
        each(i, j, arms_ring, [&](int ring, const Bins::Point& q, std::uint32_t row) {
          if (row >= own || q.z > wires->high + above_wires) return;
          const bool beside = std::hypot(q.x - body->x, q.y - body->y) <= body->radius;
          if (ring <= body_ring && beside)
            out[row] = 1;
          else if (q.z >= wires->low - arms_below && out[row] == 0)
            out[row] = wire_[row] >= wire_carried_on ? 2 : 1;
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

  struct Range {
    double low = std::numeric_limits<double>::infinity(), high = -std::numeric_limits<double>::infinity();
  };
  /// The upper part of a support: its middle, and how far from it returns belong to it.
  struct Body {
    double x = 0.0, y = 0.0, radius = 0.0, top = 0.0;
  };

  /// Heights of the wires near the cell.
  std::optional<Range> wires_around(int i, int j) const {
    const core::Lattice &l = tall_.lattice(), &w = wires_.lattice();
    const double x = l.centre_x(i), y = l.centre_y(j);
    const int column = static_cast<int>(core::cell_index(x, w.cell) - w.i0), row = static_cast<int>(core::cell_index(y, w.cell) - w.j0);
    Range r;
    for (int dj = -1; dj <= 1; ++dj)
      for (int di = -1; di <= 1; ++di) {
        if (!w.holds(column + di, row + dj)) continue;
        for (const Bins::Point& q : wires_.in(column + di, row + dj))
          if (std::hypot(q.x + block_.origin.x() - x, q.y + block_.origin.y() - y) <= wires_near)
            r.low = std::min(r.low, q.z), r.high = std::max(r.high, q.z);
      }
    return r.low <= r.high ? std::optional(r) : std::nullopt;
  }

  /// Returns from the highest down to the first gap: what may be a support.
  std::optional<Body> body_at(int i, int j, const Range& wires) const {
    std::vector<Bins::Point> column;
    each(i, j, body_ring, [&](int, const Bins::Point& q, std::uint32_t) {
      if (q.z <= wires.high + above_wires) column.push_back(q);
    });
    std::sort(column.begin(), column.end(),
              [](const Bins::Point& a, const Bins::Point& b) { return std::tie(b.z, a.x, a.y) < std::tie(a.z, b.x, b.y); });
    const double below = column.empty() ? gap_of_pole : wires.low - column.front().z - least_on_tower;
    if (below >= gap_of_pole) return std::nullopt;
    if (below <= below_wires)
      if (const auto wide = upper_body(column, gap_of_body, least_body)) return wide;
    const auto pole = upper_body(column, gap_of_pole, least_pole);
    return pole && pole->radius <= pole_radius + beside_body ? pole : std::nullopt;
  }

  static std::optional<Body> upper_body(const std::vector<Bins::Point>& column, double gap, double least) {
    size_t n = 1;
    while (n < column.size() && column[n - 1].z - column[n].z <= gap) ++n;
    if (n < fewest_of_body || column[0].z - column[n - 1].z < least) return std::nullopt;
    const auto in_upper = std::count_if(column.begin(), column.begin() + static_cast<std::ptrdiff_t>(n),
                                        [&](const Bins::Point& q) { return q.z >= column[0].z - upper_part; });
    const size_t upper = std::max<size_t>(2, static_cast<size_t>(in_upper));
    Body b;
    b.top = column[0].z;
    for (size_t k = 0; k < upper; ++k) b.x += column[k].x / static_cast<double>(upper), b.y += column[k].y / static_cast<double>(upper);
    for (size_t k = 0; k < upper; ++k) b.radius = std::max(b.radius, std::hypot(column[k].x - b.x, column[k].y - b.y) + beside_body);
    return b;
  }

  /// Are there nearly no returns from z = `from` on around the body, but those of wires and of arms?
  bool is_bare_around(int i, int j, double from, const Body& body) const {
    std::array<int, row_directions> off_row{};
    int taken = 0, cells = 0;
    for (int dj = -arms_ring; dj <= arms_ring; ++dj)
      for (int di = -arms_ring; di <= arms_ring; ++di) {
        if (std::max(std::abs(di), std::abs(dj)) <= body_ring) continue;
        ++cells;
        const auto points = tall_.in(i + di, j + dj);
        const auto rows = tall_.rows(i + di, j + dj);
        std::array<bool, row_directions> off{};
        bool any = false;
        for (size_t k = 0; k < points.size(); ++k) {
          if (points[k].z < from || wire_[rows[k]] >= wire_carried_on) continue;
          any = true;
          for (size_t d = 0; d < off.size(); ++d) off[d] = off[d] || off_axis(points[k], body, d) > row_half;
        }
        taken += any;
        for (size_t d = 0; d < off.size(); ++d) off_row[d] += off[d];
      }
    return static_cast<double>(taken) <= most_of_ring * static_cast<double>(cells) ||
           static_cast<double>(*std::min_element(off_row.begin(), off_row.end())) <= most_off_row * static_cast<double>(cells);
  }

  /// m in plan from the axis through the body in a direction.
  static double off_axis(const Bins::Point& q, const Body& body, size_t direction) {
    const double bearing = core::pi * static_cast<double>(direction) / row_directions;
    return std::abs((q.y - body.y) * std::cos(bearing) - (q.x - body.x) * std::sin(bearing));
  }

  const core::Block& block_;
  Bins tall_, wires_;
  const std::vector<std::uint8_t>& wire_;
};

}  // namespace

double tower_points_halo() { return 2.0 * (arms_ring + 1) * tower_cell + wires_near; }

std::vector<std::uint8_t> tower_points(const core::Block& b, const std::vector<std::uint8_t>& wire, const std::vector<std::uint8_t>& tall,
                                       size_t own) {
  if (std::all_of(wire.begin(), wire.end(), [](std::uint8_t w) { return w == 0; })) return std::vector<std::uint8_t>(own, 0);
  return TowerSearch(b, wire, tall).run(own);
}

}  // namespace swath::filters
