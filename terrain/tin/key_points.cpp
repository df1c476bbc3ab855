// SPDX-License-Identifier: GPL-3.0-or-later
// Greedy insertion: Heller 1990, "Triangulation algorithms for adaptive terrain modeling"; Garland & Heckbert 1995, "Fast polygonal
// approximation of terrains and height fields". Deviation: in each round the worst point of every triangle enters, not the worst of all.
//
// Cells that do not know of one another. Let P be all points, K the key points, R half of max_edge, t a triangle of P's triangulation with
// a radius of at most R. Kept, as fixed, are the vertices of every t that reaches over the border of a cell, and of every t that has no
// neighbour across one of its edges (the rim of what is covered). The disc of a fixed t holds no point of P, so none of K: t is a triangle
// of K's triangulation whatever else is in K. A triangle of K within a cell is shut in by fixed ones: the part of its disc beyond an edge
// that it shares with a fixed triangle lies in the disc of that one, which is empty. So what the interior of a cell needs is known from the
// points in it and the fixed vertices around it alone, and t is known from the points within 2 R. Coverage: a triangle of K wider than R
// whose disc holds a point of P is broken up by it; the others are triangles of P too.
#include "terrain/tin/key_points.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <tuple>
#include <utility>

#include "core/grid.h"
#include "terrain/tin/delaunay.h"
#include "terrain/tin/tin.h"

namespace swath::terrain {
namespace {

using CellKey = std::pair<std::int64_t, std::int64_t>;

/// A cell's vertices of the whole triangulation: fixed ones, also around it, and those of its own that may be left out.
struct Cell {
  std::vector<std::int32_t> fixed, open;
};

/// Thins one cell.
class Thinning {
 public:
  Thinning(const Tin& tin, const Cell& cell, const KeyPointOptions& o)
      : tin_(tin), tolerance_(o.tolerance.value), widest_(0.5 * o.max_edge.value), vertices_(cell.fixed), dt_(places_) {
    fixed_ = vertices_.size();
    vertices_.insert(vertices_.end(), cell.open.begin(), cell.open.end());
    for (const std::int32_t v : vertices_) places_.push_back(tin.place(v));
    is_key_.assign(vertices_.size(), false);
    seat_.resize(vertices_.size());
  }

  /// Calls `key` with each vertex of the whole triangulation that is needed; returns the largest error left.
  template <class Key>
  double run(Key&& key) {
    std::vector<std::int32_t> more(fixed_);
    for (size_t i = 0; i < fixed_; ++i) more[i] = static_cast<std::int32_t>(i);
    while (!more.empty()) {
      for (const std::int32_t p : more) is_key_[p] = true;
      dt_.insert(more);
      dt_.settle(dt_.cocircular());
      more = violators();
      if (more.empty()) more = in_wide_discs();
    }
    double farthest = 0.0;
    for (size_t p = 0; p < vertices_.size(); ++p) {
      if (is_key_[p]) key(vertices_[p]);
      if (!is_key_[p]) farthest = std::max(farthest, seat_[p].error);
    }
    return farthest;
  }

 private:
  /// Where a point lies: the face, its vertices when that was stated, and what it lacks.
  struct Seat {
    std::int32_t face = -1;
    std::array<std::int32_t, 3> of{-1, -1, -1};
    double error = 0.0, need = 0.0;
  };

  /// A face's vertices, ascending in (x, y).
  std::array<std::int32_t, 3> ascending(std::array<std::int32_t, 3> v) const {
    std::sort(v.begin(), v.end(), [&](std::int32_t a, std::int32_t b) { return is_before(places_[a], places_[b]); });
    return v;
  }
  Circumcircle circle(const std::array<std::int32_t, 3>& v) const {
    const auto [a, b, c] = ascending(v);
    return circumcircle(places_[a], places_[b], places_[c]);
  }

  /// Of every face the point in it that lies farthest off, if over the tolerance; of faces that are too wide the one nearest the centre.
  std::vector<std::int32_t> violators() {
    const auto& faces = dt_.faces();
    std::vector<std::int32_t> worst(faces.size(), -1), out;
    std::int32_t near = 0;
    for (auto p = static_cast<std::int32_t>(fixed_); p < static_cast<std::int32_t>(vertices_.size()); ++p) {
      if (is_key_[p] || faces.empty()) continue;
      Seat& seat = seat_[p];
      if (seat.face < 0 || faces[seat.face].v != seat.of) {
        seat.face = dt_.locate(places_[p], seat.face < 0 ? near : seat.face);
        const bool on_edge = move_to_first(seat.face, places_[p]);
        seat.of = faces[seat.face].v;
        judge(seat, places_[p], tin_.z[vertices_[p]]);
        if (on_edge) seat.of.fill(-1);  // the face across may change and come first
      }
      near = seat.face;
      if (!(seat.need > tolerance_)) continue;
      std::int32_t& held = worst[seat.face];
      if (held < 0 || seat.need > seat_[held].need || (seat.need == seat_[held].need && is_before(places_[p], places_[held]))) held = p;
    }
    std::copy_if(worst.begin(), worst.end(), std::back_inserter(out), [](std::int32_t p) { return p >= 0; });
    return out;
  }

  /// Whether the place lies on an edge of the face; of the two beside it the one whose vertices come first becomes the face.
  bool move_to_first(std::int32_t& face, const Place& p) const {
    const Face& f = dt_.faces()[face];
    if (!f.is_finite()) return false;
    for (size_t k = 0; k < 3; ++k) {
      const std::int32_t a = f.v[(k + 1) % 3], b = f.v[(k + 2) % 3];
      if (orientation(places_[a], places_[b], p) != 0) continue;
      const Face& across = dt_.faces()[f.n[k]];
      if (!across.is_finite()) return true;
      const std::int32_t far = across.v[0] ^ across.v[1] ^ across.v[2] ^ a ^ b;
      if (is_before(places_[far], places_[f.v[k]])) face = f.n[k];
      return true;
    }
    return false;
  }
  void judge(Seat& seat, const Place& p, double z) const;

  /// Where all points are within the tolerance: of every disc that is too wide the point nearest its centre.
  std::vector<std::int32_t> in_wide_discs() const {
    std::vector<std::int32_t> open, out;
    for (auto p = static_cast<std::int32_t>(fixed_); p < static_cast<std::int32_t>(vertices_.size()); ++p)
      if (!is_key_[p]) open.push_back(p);
    for (const Face& face : dt_.faces()) {
      if (!face.is_finite()) continue;
      const Circumcircle c = circle(face.v);
      if (c.radius <= widest_) continue;
      const double around = c.radius + rounding_of(face, c.radius);
      std::int32_t nearest = -1;
      const auto distance = [&](std::int32_t p) { return std::hypot(places_[p].x - c.x, places_[p].y - c.y); };
      for (const std::int32_t p : open) {
        const double dx = places_[p].x - c.x, dy = places_[p].y - c.y;
        if (dx * dx + dy * dy > around * around) continue;
        if (in_circle(places_[face.v[0]], places_[face.v[1]], places_[face.v[2]], places_[p]) >= 0 &&
            (nearest < 0 || std::make_tuple(distance(p), places_[p].x, places_[p].y) <
                                std::make_tuple(distance(nearest), places_[nearest].x, places_[nearest].y)))
          nearest = p;
      }
      if (nearest >= 0) out.push_back(nearest);
    }
    std::sort(out.begin(), out.end());
    out.erase(std::unique(out.begin(), out.end()), out.end());
    return out;
  }

  /// Bound of the rounding errors of a face's circle, m: doubled area, radius and centre lose up to 4e-15 radii per radius over the
  /// shortest side, coordinates less than 1e-9 m.
  double rounding_of(const Face& face, double radius) const {
    double shortest = std::numeric_limits<double>::infinity();
    for (size_t k = 0; k < 3; ++k) {
      const Place &a = places_[face.v[k]], &b = places_[face.v[(k + 1) % 3]];
      shortest = std::min(shortest, std::hypot(a.x - b.x, a.y - b.y));
    }
    return 1e-13 * radius * radius / shortest + 1e-9;
  }

  const Tin& tin_;
  double tolerance_, widest_;
  std::vector<std::int32_t> vertices_;  // of tin_: fixed ones first
  size_t fixed_ = 0;
  std::vector<Place> places_;
  std::vector<char> is_key_;
  std::vector<Seat> seat_;
  Delaunay dt_;
};

void Thinning::judge(Seat& seat, const Place& p, double z) const {
  constexpr double beyond_all = 1e12;
  if (!dt_.faces()[seat.face].is_finite()) {
    seat.error = seat.need = beyond_all;
    return;
  }
  // As height_in(), so that what is promised here holds for the terrain model to the last bit.
  const auto [a, b, c] = ascending(seat.of);
  const auto height = [&](std::int32_t k) { return tin_.z[vertices_[k]]; };
  const double bx = places_[b].x - places_[a].x, by = places_[b].y - places_[a].y;
  const double cx = places_[c].x - places_[a].x, cy = places_[c].y - places_[a].y;
  const double qx = p.x - places_[a].x, qy = p.y - places_[a].y, twice_area = bx * cy - by * cx;
  const double wb = (qx * cy - qy * cx) / twice_area, wc = (bx * qy - by * qx) / twice_area;
  seat.error = std::abs(z - (height(a) + wb * (height(b) - height(a)) + wc * (height(c) - height(a))));
  const Circumcircle round = circumcircle(places_[a], places_[b], places_[c]);
  seat.need = round.radius > widest_ ? beyond_all - std::hypot(p.x - round.x, p.y - round.y) : seat.error;
}

/// Terrain points, and no flag of an earlier run.
std::vector<std::uint32_t> rows_to_thin(core::Block& block, const KeyPointOptions& o) {
  std::vector<std::uint32_t> rows;
  for (std::uint32_t i = 0; i < block.size(); ++i) {
    block.flags[i] &= static_cast<std::uint16_t>(~core::flag::key_point);
    const bool is_terrain =
        core::is_usable(block, i) && std::find(o.classes.begin(), o.classes.end(), block.classification[i]) != o.classes.end();
    if (is_terrain) rows.push_back(i);
  }
  return rows;
}

}  // namespace

double halo(const KeyPointOptions& o) { return o.cell.value + o.max_edge.value; }

KeyPointCounts mark_key_points(core::Block& block, std::size_t own, const KeyPointOptions& o) {
  KeyPointCounts counts;
  const std::vector<std::uint32_t> rows = rows_to_thin(block, o);
  const auto cell_of = [&](const Place& p) {
    return CellKey{core::cell_index(p.y + block.origin.y(), o.cell.value), core::cell_index(p.x + block.origin.x(), o.cell.value)};
  };
  // The cells that hold own points, and the rectangle around them.
  std::map<CellKey, Cell> cells;
  Rectangle where{1e300, 1e300, -1e300, -1e300};
  for (const std::uint32_t r : rows) {
    if (r >= own) break;
    ++counts.terrain;
    const CellKey key = cell_of({block.x[r], block.y[r]});
    if (!cells.try_emplace(key).second) continue;
    const double west = static_cast<double>(key.second) * o.cell.value - block.origin.x(),
                 south = static_cast<double>(key.first) * o.cell.value - block.origin.y();
    where = {std::min(where.west, west), std::min(where.south, south), std::max(where.east, west + o.cell.value),
             std::max(where.north, south + o.cell.value)};
  }
  if (cells.empty()) return counts;
  const Tin tin = triangulate(block, rows, 0.5 * o.max_edge.value, where);

  std::vector<char> fixed(tin.x.size(), false), covered(tin.x.size(), false);
  for (std::int32_t t = 0; t < static_cast<std::int32_t>(tin.size()); ++t) {
    const auto& v = tin.triangles[t];
    const std::array<CellKey, 3> in{cell_of(tin.place(v[0])), cell_of(tin.place(v[1])), cell_of(tin.place(v[2]))};
    for (const std::int32_t k : v) covered[k] = true;
    const bool crosses = in[0] != in[1] || in[1] != in[2];
    const auto& across = tin.across[t];
    if (!crosses && across[0] >= 0 && across[1] >= 0 && across[2] >= 0) continue;
    for (const std::int32_t k : v) fixed[k] = true;
    for (size_t k = 0; k < 3; ++k) {
      const auto cell = cells.find(in[k]);
      if (cell != cells.end()) cell->second.fixed.insert(cell->second.fixed.end(), v.begin(), v.end());
    }
  }
  std::vector<char> key(tin.x.size(), false);
  for (std::int32_t v = 0; v < static_cast<std::int32_t>(tin.x.size()); ++v) {
    const auto cell = cells.find(cell_of(tin.place(v)));
    if (cell == cells.end()) continue;
    if (!covered[v]) key[v] = true;  // alone: of no triangle
    if (covered[v] && !fixed[v]) cell->second.open.push_back(v);
  }
  for (auto& [where_it_is, cell] : cells) {
    std::sort(cell.fixed.begin(), cell.fixed.end());
    cell.fixed.erase(std::unique(cell.fixed.begin(), cell.fixed.end()), cell.fixed.end());
    counts.farthest = std::max(counts.farthest, Thinning(tin, cell, o).run([&](std::int32_t v) { key[v] = true; }));
  }
  for (size_t v = 0; v < key.size(); ++v)
    if (key[v] && tin.row[v] < own) {
      block.flags[tin.row[v]] |= core::flag::key_point;
      ++counts.key;
    }
  return counts;
}

}  // namespace swath::terrain
