// SPDX-License-Identifier: GPL-3.0-or-later
// Edges are noded until none meets another but at vertices: vertices are snapped to one another, then every pair of edges near one another
// gets a vertex where one ends on the other or both cross. Snapping moves an edge by less than `snap`, which can make it meet another; so
// the pass is repeated until it finds nothing.
#include "terrain/water/line_network.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <set>
#include <unordered_map>

#include "core/error.h"

namespace swath::terrain {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr double snap = 1e-3;        // m: a vertex nearer than this to another, or to an edge, is on it
constexpr double index_cell = 20.0;  // m: of the grid in which edges find one another
constexpr int most_passes = 16;
constexpr double rounding = 1e-6;  // m: heights interpolated along two lines that meet

struct Node {
  Vector3d at;
  size_t line;
};

struct Edge {
  std::int32_t a, b;
  size_t line;
};

std::int64_t cell_key(std::int64_t i, std::int64_t j) { return i * 0x100000000LL + (j & 0xffffffffLL); }

Vector2d flat(const Vector3d& p) { return p.head<2>(); }

class Noder {
 public:
  Noder(const std::vector<NetworkLine>& lines, const NetworkOptions& options, const Vector3d& origin)
      : lines_(lines), options_(options), origin_(origin) {
    for (size_t l = 0; l < lines.size(); ++l) {
      std::int32_t before = -1;
      for (const Vector3d& v : lines[l].vertices) {
        const std::int32_t n = node(v, l);
        if (before >= 0 && before != n) edges_.push_back({before, n, l});
        before = n;
      }
    }
    drop_doubles();
    for (int pass = 0; pass < most_passes; ++pass)
      if (!split_where_met()) return;
    const auto number = [](double v) { return core::format_number(std::round(v * 1e3) / 1e3); };
    throw core::Error("breaklines lie so close to one another at x " + number(met_->at.x() + origin_.x()) + ", y " +
                          number(met_->at.y() + origin_.y()) + " that no network can be made of them",
                      lines[met_->line].place + " and " + lines[met_->other].place,
                      "lines that run along one another within a millimetre should share their vertices");
  }

  Constraints divided() const {
    Constraints out;
    for (const Node& n : nodes_) add(out, n.at, lines_[n.line].sigma);
    for (const Edge& e : edges_) {
      const bool forward = flat(nodes_[e.a].at)[0] != flat(nodes_[e.b].at)[0] ? nodes_[e.a].at.x() < nodes_[e.b].at.x()
                                                                              : nodes_[e.a].at.y() < nodes_[e.b].at.y();
      const std::int32_t first = forward ? e.a : e.b, last = forward ? e.b : e.a;
      const Vector3d p = nodes_[first].at, d = nodes_[last].at - p;
      const int pieces = std::max(1, static_cast<int>(std::ceil(flat(d).norm() / options_.spacing.value)));
      std::int32_t before = first;
      for (int k = 1; k < pieces; ++k) {
        add(out, p + d * (static_cast<double>(k) / pieces), lines_[e.line].sigma);
        const auto here = static_cast<std::int32_t>(out.x.size()) - 1;
        out.edges.emplace_back(before, here);
        before = here;
      }
      out.edges.emplace_back(before, last);
    }
    return out;
  }

 private:
  static void add(Constraints& c, const Vector3d& p, double sigma) {
    c.x.push_back(p.x());
    c.y.push_back(p.y());
    c.z.push_back(p.z());
    c.sigma_v.push_back(static_cast<float>(sigma));
  }

  /// Holds two heights at one place to the tolerance and gives the one that stands.
  double agreed(double z, size_t line, double other_z, size_t other, const Vector2d& place, double otherwise) const {
    const NetworkLine &l = lines_[line], &o = lines_[other];
    if (l.yields && o.yields) return std::min(z, other_z);
    if (l.yields) return other_z;
    if (o.yields) return z;
    if (std::abs(z - other_z) > options_.tolerance.value + rounding) {
      const auto number = [](double v) { return core::format_number(std::round(v * 1e3) / 1e3); };
      throw core::Error("breaklines meet at different heights: " + number(z + origin_.z()) + " m and " + number(other_z + origin_.z()) +
                            " m at x " + number(place.x() + origin_.x()) + ", y " + number(place.y() + origin_.y()),
                        l.place + " and " + o.place, "correct one of them, or end one short of the other");
    }
    return otherwise;
  }

  /// The node within `snap` of p, made where there is none.
  std::int32_t node(const Vector3d& p, size_t line) {
    const auto i = static_cast<std::int64_t>(std::floor(p.x() / snap)), j = static_cast<std::int64_t>(std::floor(p.y() / snap));
    for (std::int64_t dj = -1; dj <= 1; ++dj)
      for (std::int64_t di = -1; di <= 1; ++di) {
        const auto at = places_.find(cell_key(i + di, j + dj));
        if (at == places_.end()) continue;
        for (const std::int32_t n : at->second) {
          Node& held = nodes_[n];
          if ((flat(held.at) - flat(p)).norm() > snap) continue;
          held.at.z() = agreed(held.at.z(), held.line, p.z(), line, flat(p), held.at.z());
          if (lines_[held.line].yields && !lines_[line].yields) held.line = line;
          return n;
        }
      }
    nodes_.push_back({p, line});
    places_[cell_key(i, j)].push_back(static_cast<std::int32_t>(nodes_.size()) - 1);
    return static_cast<std::int32_t>(nodes_.size()) - 1;
  }

  /// Of edges between the same nodes one stands: the one of a line that does not yield, else the first.
  void drop_doubles() {
    std::stable_sort(edges_.begin(), edges_.end(), [this](const Edge& p, const Edge& q) {
      const auto key = [this](const Edge& e) {
        return std::make_tuple(std::min(e.a, e.b), std::max(e.a, e.b), lines_[e.line].yields, e.line);
      };
      return key(p) < key(q);
    });
    edges_.erase(std::unique(edges_.begin(), edges_.end(),
                             [](const Edge& p, const Edge& q) { return std::minmax(p.a, p.b) == std::minmax(q.a, q.b); }),
                 edges_.end());
  }

  double height_on(const Edge& e, double t) const { return nodes_[e.a].at.z() + t * (nodes_[e.b].at.z() - nodes_[e.a].at.z()); }

  /// Where along the edge a node lies on it, between its ends.
  std::optional<double> on_edge(std::int32_t n, const Edge& e) const {
    if (n == e.a || n == e.b) return std::nullopt;
    const Vector2d a = flat(nodes_[e.a].at), d = flat(nodes_[e.b].at) - a, q = flat(nodes_[n].at) - a;
    const double t = q.dot(d) / d.squaredNorm();
    if (t <= 0.0 || t >= 1.0 || (q - t * d).norm() > snap) return std::nullopt;
    return t;
  }

  using Splits = std::map<size_t, std::set<std::pair<double, std::int32_t>>>;  // by edge: place along it, node

  void meet(size_t i, size_t j, Splits& splits) {
    const Edge e = edges_[i], f = edges_[j];
    bool touched = false;
    const auto try_ends = [&](size_t edge, const Edge& on, const Edge& ends) {
      for (const std::int32_t n : {ends.a, ends.b})
        if (const auto t = on_edge(n, on)) {
          Node& held = nodes_[n];
          held.at.z() = agreed(held.at.z(), held.line, height_on(on, *t), on.line, flat(held.at), held.at.z());
          if (lines_[held.line].yields && !lines_[on.line].yields) held.line = on.line;
          splits[edge].insert({*t, n});
          touched = true;
        }
    };
    try_ends(i, e, f);
    try_ends(j, f, e);
    if (touched || e.a == f.a || e.a == f.b || e.b == f.a || e.b == f.b) return;
    const Vector2d p = flat(nodes_[e.a].at), d = flat(nodes_[e.b].at) - p, q = flat(nodes_[f.a].at), g = flat(nodes_[f.b].at) - q;
    const double cross = d.x() * g.y() - d.y() * g.x();
    if (cross == 0.0) return;
    const Vector2d w = q - p;
    const double t = (w.x() * g.y() - w.y() * g.x()) / cross, u = (w.x() * d.y() - w.y() * d.x()) / cross;
    if (t <= 0.0 || t >= 1.0 || u <= 0.0 || u >= 1.0) return;
    const Vector2d at = p + t * d;
    const double z = height_on(e, t), z_other = height_on(f, u);
    const double agreed_z = agreed(z, e.line, z_other, f.line, at, 0.5 * (z + z_other));
    const size_t owner = lines_[e.line].yields ? f.line : e.line;
    const auto before = nodes_.size();
    const std::int32_t n = node({at.x(), at.y(), agreed_z}, owner);
    if (nodes_.size() > before) nodes_[n].at.z() = agreed_z;
    if (n != e.a && n != e.b) splits[i].insert({t, n});
    if (n != f.a && n != f.b) splits[j].insert({u, n});
  }

  bool split_where_met() {
    std::unordered_map<std::int64_t, std::vector<size_t>> cells;
    const auto index = [](double v) { return static_cast<std::int64_t>(std::floor(v / index_cell)); };
    for (size_t i = 0; i < edges_.size(); ++i) {
      const Vector2d a = flat(nodes_[edges_[i].a].at), d = flat(nodes_[edges_[i].b].at) - a;
      // A long edge enters by pieces, so that it stands only in cells near it.
      const int pieces = std::max(1, static_cast<int>(std::ceil(d.norm() / index_cell)));
      std::set<std::int64_t> mine;
      for (int k = 0; k < pieces; ++k) {
        const Vector2d p = a + d * (static_cast<double>(k) / pieces), q = a + d * (static_cast<double>(k + 1) / pieces);
        for (std::int64_t cj = index(std::min(p.y(), q.y()) - snap); cj <= index(std::max(p.y(), q.y()) + snap); ++cj)
          for (std::int64_t ci = index(std::min(p.x(), q.x()) - snap); ci <= index(std::max(p.x(), q.x()) + snap); ++ci)
            mine.insert(cell_key(ci, cj));
      }
      for (const std::int64_t c : mine) cells[c].push_back(i);
    }
    std::vector<std::pair<size_t, size_t>> pairs;
    for (const auto& [c, in] : cells)
      for (size_t k = 0; k < in.size(); ++k)
        for (size_t m = k + 1; m < in.size(); ++m)
          if (boxes_meet(edges_[in[k]], edges_[in[m]])) pairs.emplace_back(in[k], in[m]);
    std::sort(pairs.begin(), pairs.end());
    pairs.erase(std::unique(pairs.begin(), pairs.end()), pairs.end());

    Splits splits;
    for (const auto& [i, j] : pairs) {
      const size_t before = splits.size();
      meet(i, j, splits);
      if (splits.size() > before) met_ = Meeting{flat(nodes_[edges_[i].a].at), edges_[i].line, edges_[j].line};
    }
    if (splits.empty()) return false;
    std::vector<Edge> out;
    for (size_t i = 0; i < edges_.size(); ++i) {
      std::int32_t before = edges_[i].a;
      if (const auto s = splits.find(i); s != splits.end())
        for (const auto& [t, n] : s->second) {
          if (n != before) out.push_back({before, n, edges_[i].line});
          before = n;
        }
      if (before != edges_[i].b) out.push_back({before, edges_[i].b, edges_[i].line});
    }
    edges_ = std::move(out);
    drop_doubles();
    return true;
  }

  bool boxes_meet(const Edge& e, const Edge& f) const {
    for (int k = 0; k < 2; ++k) {
      const auto [e0, e1] = std::minmax(nodes_[e.a].at[k], nodes_[e.b].at[k]);
      const auto [f0, f1] = std::minmax(nodes_[f.a].at[k], nodes_[f.b].at[k]);
      if (e1 + snap < f0 || f1 + snap < e0) return false;
    }
    return true;
  }

  struct Meeting {
    Vector2d at;
    size_t line, other;
  };

  const std::vector<NetworkLine>& lines_;
  const NetworkOptions& options_;
  Vector3d origin_;
  std::vector<Node> nodes_;
  std::vector<Edge> edges_;
  std::unordered_map<std::int64_t, std::vector<std::int32_t>> places_;
  std::optional<Meeting> met_;  // two edges that were divided last
};

}  // namespace

Constraints line_network(const std::vector<NetworkLine>& lines, const NetworkOptions& options, const Vector3d& origin) {
  if (lines.empty()) return {};
  return Noder(lines, options, origin).divided();
}

Constraints edges_in(const Constraints& all, double x0, double y0, double x1, double y1) {
  Constraints out;
  std::unordered_map<std::int32_t, std::int32_t> kept;
  const auto keep = [&](std::int32_t v) {
    const auto [at, fresh] = kept.try_emplace(v, static_cast<std::int32_t>(out.x.size()));
    if (fresh) {
      const auto k = static_cast<size_t>(v);
      out.x.push_back(all.x[k]);
      out.y.push_back(all.y[k]);
      out.z.push_back(all.z[k]);
      out.sigma_v.push_back(all.sigma_v[k]);
    }
    return at->second;
  };
  for (const auto& [a, b] : all.edges) {
    const auto i = static_cast<size_t>(a), j = static_cast<size_t>(b);
    if (std::max(all.x[i], all.x[j]) < x0 || std::min(all.x[i], all.x[j]) > x1) continue;
    if (std::max(all.y[i], all.y[j]) < y0 || std::min(all.y[i], all.y[j]) > y1) continue;
    const std::int32_t first = keep(a);
    out.edges.emplace_back(first, keep(b));
  }
  return out;
}

}  // namespace swath::terrain
