// SPDX-License-Identifier: GPL-3.0-or-later
// A vertex goes where it and all that went before it lie within `thinnest` of the new chord, and where the corridor of the tolerance and
// the other lines of the level leave room. Every step is checked against the level as it then is, so the lines are free of crossings after
// each of them.
#include "terrain/contours/contour_shape.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <unordered_map>

#include "core/floor_div.h"

namespace swath::terrain {
namespace {

using Point = Eigen::Vector2d;

constexpr double clearance = 1e-5;   // of a cell, between a new segment and all else
constexpr double joint = 1e-6;       // of a cell, the same between neighbours beside the vertex they share
constexpr double thinnest = 0.05;    // of a cell, from a removed vertex to the line
constexpr double longest = 32.0;     // cells that a segment may bridge
constexpr double bucket_side = 1.0;  // cells

double cross_of(const Point& a, const Point& b) { return a.x() * b.y() - a.y() * b.x(); }

double distance(const Point& p, const Point& a, const Point& b) {
  const Point d = b - a;
  const double dd = d.squaredNorm();
  const double t = dd > 0.0 ? std::clamp((p - a).dot(d) / dd, 0.0, 1.0) : 0.0;
  return (p - a - t * d).norm();
}

bool cross_each_other(const Point& a, const Point& b, const Point& c, const Point& d) {
  const double c1 = cross_of(b - a, c - a), c2 = cross_of(b - a, d - a), d1 = cross_of(d - c, a - c), d2 = cross_of(d - c, b - c);
  return ((c1 > 0) != (c2 > 0)) && ((d1 > 0) != (d2 > 0));
}

bool apart(const Point& a, const Point& b, const Point& c, const Point& d, double gap) {
  if (std::max(a.x(), b.x()) + gap < std::min(c.x(), d.x()) || std::max(c.x(), d.x()) + gap < std::min(a.x(), b.x()) ||
      std::max(a.y(), b.y()) + gap < std::min(c.y(), d.y()) || std::max(c.y(), d.y()) + gap < std::min(a.y(), b.y()))
    return true;
  return !cross_each_other(a, b, c, d) && distance(c, a, b) > gap && distance(d, a, b) > gap && distance(a, c, d) > gap &&
         distance(b, c, d) > gap;
}

bool inside(const Point& p, const Point& a, const Point& b, const Point& c) {
  const Point low = a.cwiseMin(b).cwiseMin(c), high = a.cwiseMax(b).cwiseMax(c);
  if (p.x() < low.x() || p.y() < low.y() || p.x() > high.x() || p.y() > high.y()) return false;  // where the triangle is flat
  const double s = cross_of(b - a, p - a), t = cross_of(c - b, p - b), u = cross_of(a - c, p - c);
  return (s >= 0 && t >= 0 && u >= 0) || (s <= 0 && t <= 0 && u <= 0);
}

struct Node {
  Point p;
  int before = -1, after = -1;  ///< of the same line
};

/// All lines of a level and where their segments are; a segment is known by its first node.
class Level {
 public:
  Level(const std::vector<ContourLine>& lines, Facets& surface, double tolerance)
      : surface_(surface), height_(lines.empty() ? 0.0 : lines[0].height), tolerance_(tolerance), cell_(surface.cell()) {
    for (const ContourLine& line : lines) {
      const int first = static_cast<int>(nodes_.size());
      const int n = static_cast<int>(line.vertices.size()) - (line.closed ? 1 : 0);
      for (int k = 0; k < n; ++k) {
        Node node{line.vertices[static_cast<size_t>(k)], first + k - 1, first + k + 1};
        if (k == 0) node.before = line.closed ? first + n - 1 : -1;
        if (k == n - 1) node.after = line.closed ? first : -1;
        nodes_.push_back(node);
      }
    }
    for (int k = 0; k < static_cast<int>(nodes_.size()); ++k)
      if (nodes_[k].after >= 0) enter(k);
  }

  const Node& node(int k) const { return nodes_[k]; }

  /// Takes node k out, where that is allowed.
  bool remove(int k) {
    const Node n = nodes_[k];
    const Point &a = nodes_[n.before].p, &b = nodes_[n.after].p;
    if (!surface_.within(a, b, height_, tolerance_) || !sweeps_free(a, n.p, b, k) || !keeps_clear(a, b, n.before, k, n.after)) return false;
    leave(n.before);
    leave(k);
    nodes_[n.before].after = n.after;
    nodes_[n.after].before = n.before;
    enter(n.before);
    return true;
  }

 private:
  using Bucket = std::vector<int>;

  std::uint64_t bucket_key(std::int64_t i, std::int64_t j) const {
    return (static_cast<std::uint64_t>(i) << 32) ^ (static_cast<std::uint64_t>(j) & 0xffffffffu);
  }
  std::int64_t bucket_index(double v) const { return core::floor_of(v / (bucket_side * cell_)); }

  template <class F>
  void each_bucket(const Point& low, const Point& high, const F& f) const {
    for (std::int64_t j = bucket_index(low.y()); j <= bucket_index(high.y()); ++j)
      for (std::int64_t i = bucket_index(low.x()); i <= bucket_index(high.x()); ++i) f(bucket_key(i, j));
  }
  // The buckets of a segment, in pieces no longer than a bucket.
  template <class F>
  void along(const Point& a, const Point& b, double margin, const F& f) const {
    const int pieces = std::max(1, static_cast<int>(std::ceil((b - a).norm() / (bucket_side * cell_))));
    const Point edge(margin, margin);
    for (int k = 0; k < pieces; ++k) {
      const Point p = a + (b - a) * (static_cast<double>(k) / pieces), q = a + (b - a) * (static_cast<double>(k + 1) / pieces);
      each_bucket(p.cwiseMin(q) - edge, p.cwiseMax(q) + edge, f);
    }
  }
  void enter(int segment) {
    const Point &a = nodes_[segment].p, &b = nodes_[nodes_[segment].after].p;
    along(a, b, 0.0, [&](std::uint64_t key) {
      Bucket& bucket = buckets_[key];
      if (std::find(bucket.begin(), bucket.end(), segment) == bucket.end()) bucket.push_back(segment);
    });
  }
  void leave(int segment) {
    const Point &a = nodes_[segment].p, &b = nodes_[nodes_[segment].after].p;
    along(a, b, 0.0, [&](std::uint64_t key) {
      Bucket& bucket = buckets_[key];
      const auto at = std::find(bucket.begin(), bucket.end(), segment);
      if (at == bucket.end()) return;
      *at = bucket.back();
      bucket.pop_back();
    });
  }

  /// Whether a segment a to b keeps off every other one; `first` and `second` are the segments it stands for, from node `first` to
  /// node `last`.
  bool keeps_clear(const Point& a, const Point& b, int first, int second, int last) const {
    const double gap = clearance * cell_;
    bool clear = true;
    along(a, b, gap, [&](std::uint64_t key) {
      if (!clear) return;
      const auto at = buckets_.find(key);
      if (at == buckets_.end()) return;
      for (const int s : at->second) {
        if (s == first || s == second) continue;
        const int e = nodes_[s].after;
        const Point &p = nodes_[s].p, &q = nodes_[e].p;
        const bool touches_a = p == a || q == a, touches_b = p == b || q == b;
        const bool neighbour = (e == first || s == last) && (touches_a || touches_b);
        if (neighbour) {
          // They share a vertex; nothing else may be shared.
          if (touches_a && touches_b) return void(clear = false);
          const Point &shared = touches_a ? a : b, &mine = touches_a ? b : a, &other = p == shared ? q : p;
          clear = distance(other, a, b) > joint * cell_ && distance(mine, p, q) > joint * cell_ && unfolded(other, shared, mine);
        } else {
          clear = apart(a, b, p, q, gap);
        }
        if (!clear) return;
      }
    });
    return clear;
  }
  /// No turn back onto itself at b.
  static bool unfolded(const Point& a, const Point& b, const Point& c) {
    const Point d = b - a, e = c - b;
    return d.dot(e) > -0.999 * d.norm() * e.norm();
  }
  /// Whether a triangle over which the line goes holds no node of the surface outside the tolerance and no other line's vertex.
  bool sweeps_free(const Point& a, const Point& b, const Point& c, int moved) {
    if (!surface_.within_inside(a, b, c, height_, tolerance_)) return false;
    const Point low = a.cwiseMin(b).cwiseMin(c), high = a.cwiseMax(b).cwiseMax(c);
    bool free = true;
    each_bucket(low, high, [&](std::uint64_t key) {
      if (!free) return;
      const auto at = buckets_.find(key);
      if (at == buckets_.end()) return;
      for (const int s : at->second)
        for (const int n : {s, nodes_[s].after}) {
          if (n == moved || n == nodes_[moved].before || n == nodes_[moved].after) continue;
          if (inside(nodes_[n].p, a, b, c)) free = false;
        }
    });
    return free;
  }

  Facets& surface_;
  double height_, tolerance_, cell_;
  std::vector<Node> nodes_;
  std::unordered_map<std::uint64_t, Bucket> buckets_;
};

/// Walks along a line from `first`: from every vertex that stays as far as the next may be.
void thin_line(Level& level, int first, bool closed, double cell) {
  int left = 1;
  for (int k = level.node(first).after; k >= 0 && k != first; k = level.node(k).after) ++left;
  std::vector<Point> gone;
  int from = first;
  for (;;) {
    const int k = level.node(from).after;
    if (k < 0 || k == first) break;
    const int to = level.node(k).after;
    if (to < 0 || (closed && (to == first || left <= 4))) break;
    const Point &a = level.node(from).p, &b = level.node(to).p;
    gone.push_back(level.node(k).p);
    const bool near = (b - a).norm() <= longest * cell &&
                      std::all_of(gone.begin(), gone.end(), [&](const Point& p) { return distance(p, a, b) <= thinnest * cell; });
    if (near && level.remove(k)) {
      --left;
    } else {
      gone.clear();
      from = k;
    }
  }
}

}  // namespace

void thin(std::vector<ContourLine>& lines, Facets& surface, double tolerance) {
  if (tolerance <= 0.0 || lines.empty()) return;
  Level level(lines, surface, tolerance);
  int first = 0;
  for (ContourLine& line : lines) {
    const int next = first + static_cast<int>(line.vertices.size()) - (line.closed ? 1 : 0);
    thin_line(level, first, line.closed, surface.cell());
    std::vector<Point>& v = line.vertices;
    v.clear();
    int k = first;
    do {
      v.push_back(level.node(k).p);
      k = level.node(k).after;
    } while (k >= 0 && k != first);
    if (line.closed) v.push_back(v.front());
    first = next;
  }
}

}  // namespace swath::terrain
