// SPDX-License-Identifier: GPL-3.0-or-later
// Distances to a catenary: the foot of an obstacle is found by Newton's method on (s - s_p) + (z - z_p) dz/ds = 0. A conductor swung by phi
// about the chord of its ends lies, at sag d below the chord, on a circle of radius d: an obstacle at distance r from the chord is | r - d
// | from it within the swing, and as far as from the arc's end outside. Deviation: the circle is taken upright across the chord's direction
// in plan, which makes clearances on a slope of 20 % up to 2 % too large.
#include "terrain/corridor/clearance.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

#include "core/grid.h"

namespace swath::terrain {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr double step = 1.0;        // m between the places where the ground is looked at
constexpr double sample = 0.5;      // m, of other wires
constexpr double top_cell = 1.0;    // m: whose highest returns may be tops
constexpr double top_radius = 2.0;  // m
constexpr double least_tree = 3.0;  // m
constexpr double part = 20.0;       // m of a conductor whose surroundings are looked at at once

/// A conductor as a curve that obstacles are compared with.
class Wire {
 public:
  Wire(const Conductor& c, double swing) : c_(c), first_(c.first.s), last_(c.last.s), swing_(swing) {}

  double first() const { return first_; }
  double last() const { return last_; }
  Vector3d at(double s) const { return c_.strand.at(s); }

  double foot(const Vector3d& p) const {
    const Catenary& z = c_.strand.fit.curve;
    const double sp = c_.strand.line.s(p.head<2>());
    double s = std::clamp(sp, first_, last_);
    for (int round = 0; round < 4; ++round) {
      const double slope = z.dz(s), off = z.z(s) - p.z();
      const double rate = 1.0 + slope * slope + off * z.kappa * std::sqrt(1.0 + slope * slope);
      s = std::clamp(s - ((s - sp) + off * slope) / std::max(0.5, rate), first_, last_);
    }
    return s;
  }

  /// The smallest distance while the wire swings.
  double swung(const Vector3d& p, double s) const {
    const double chord = c_.chord(s), d = std::max(0.0, chord - c_.strand.fit.curve.z(s));
    const double beyond = std::abs(c_.strand.line.s(p.head<2>()) - s), v = c_.strand.line.v(p.head<2>()), down = chord - p.z();
    const double r = std::hypot(v, down), angle = std::abs(std::atan2(v, down));
    if (beyond > 1.0) return (p - at(s)).norm();  // past the end
    if (angle <= swing_) return std::abs(r - d);
    return std::sqrt(r * r + d * d - 2.0 * r * d * std::cos(angle - swing_));
  }

  /// Standard deviation of the wire in a direction, m.
  double sigma(double s, const Vector3d& direction) const {
    const double z = direction.z() * c_.strand.fit.sigma_z(s);
    return std::sqrt(z * z + direction.head<2>().squaredNorm() * c_.strand.variance_across(s));
  }
  /// Of one return beside it.
  double sigma_of_return(const Vector3d& direction) const {
    return std::hypot(direction.z() * c_.strand.fit.sigma, direction.head<2>().norm() * c_.strand.sigma_v);
  }

  /// Calls f with what is in plan within `reach` of the wire.
  template <class F>
  void around(const Obstacles& obstacles, double reach, F&& f) const {
    for (double s = first_; s < last_; s += part) {
      const double to = std::min(last_, s + part);
      const Vector2d a = c_.strand.line.at(s), b = c_.strand.line.at(to);
      obstacles.in_box(std::min(a.x(), b.x()) - reach, std::min(a.y(), b.y()) - reach, std::max(a.x(), b.x()) + reach,
                       std::max(a.y(), b.y()) + reach, [&](const Obstacle& o) {
                         const double at = c_.strand.line.s({o.x, o.y});
                         const bool mine = (at >= s || s == first_) && (at < to || to == last_);  // each once
                         if (mine && std::abs(c_.strand.line.v({o.x, o.y})) <= reach) f(o);
                       });
    }
  }

  double largest_sag() const {
    double d = 0.0;
    for (double s = first_; s <= last_; s += step) d = std::max(d, c_.chord(s) - c_.strand.fit.curve.z(s));
    return d;
  }
  /// Where it is at s when it is swung by an angle.
  Vector3d swung_to(double s, double angle) const {
    const double chord = c_.chord(s), d = std::max(0.0, chord - c_.strand.fit.curve.z(s));
    const Vector2d p = c_.strand.line.at(s, d * std::sin(angle));
    return {p.x(), p.y(), chord - d * std::cos(angle)};
  }

 private:
  const Conductor& c_;
  double first_, last_, swing_;
};

std::optional<Clearance> to_ground(const Wire& wire, const Obstacles& obstacles, const ClearanceOptions& o) {
  Clearance best;
  best.at_rest = best.swung = std::numeric_limits<double>::infinity();
  bool found = false;
  for (double s = wire.first(); s <= wire.last(); s += step) {
    const Vector3d at = wire.at(s);
    if (const auto g = obstacles.ground(at.head<2>()); g && at.z() - g->z < best.at_rest) {
      found = true;
      best.at_rest = at.z() - g->z;
      best.sigma = std::hypot(wire.sigma(s, Vector3d::UnitZ()), g->sigma);
      best.wire = best.other = at;
      best.other.z() = g->z;
      best.s = s;
    }
    for (const double share : {-1.0, -0.5, 0.5, 1.0}) {
      const Vector3d p = wire.swung_to(s, share * o.swing);
      if (const auto g = obstacles.ground(p.head<2>())) best.swung = std::min(best.swung, p.z() - g->z);
    }
  }
  if (!found) return std::nullopt;
  best.swung = std::min(best.swung, best.at_rest);
  best.limit = o.limit[static_cast<size_t>(Hazard::ground)];
  return best;
}

/// Vegetation or buildings.
std::optional<Clearance> to_returns(const Wire& wire, Hazard kind, const Obstacles& obstacles, const ClearanceOptions& o,
                                    std::vector<Infringement>& infringements) {
  Clearance best;
  best.kind = kind;
  best.at_rest = best.swung = std::numeric_limits<double>::infinity();
  best.limit = o.limit[static_cast<size_t>(kind)];
  std::map<std::pair<std::int64_t, std::int64_t>, Infringement> worst;
  wire.around(obstacles, o.reach + wire.largest_sag() * std::sin(o.swing), [&](const Obstacle& obstacle) {
    if (obstacle.kind != kind) return;
    const double s = wire.foot(obstacle.at()), rest = (obstacle.at() - wire.at(s)).norm(), swung = wire.swung(obstacle.at(), s);
    if (rest < best.at_rest) best.at_rest = rest, best.s = s, best.wire = wire.at(s), best.other = obstacle.at();
    best.swung = std::min(best.swung, swung);
    if (swung >= best.limit) return;
    Infringement& i = worst
                          .try_emplace({core::cell_index(obstacle.x, infringement_cell), core::cell_index(obstacle.y, infringement_cell)},
                                       Infringement{obstacle.at(), kind, swung})
                          .first->second;
    if (swung < i.distance) i = {obstacle.at(), kind, swung};
  });
  if (!(best.at_rest <= o.reach) && !(best.swung <= o.reach)) return std::nullopt;
  for (const auto& [place, i] : worst) infringements.push_back(i);
  best.swung = std::min(best.swung, best.at_rest);
  const Vector3d direction = (best.other - best.wire).normalized();
  best.sigma = std::hypot(wire.sigma(best.s, direction), wire.sigma_of_return(direction));
  return best;
}

/// Two wires of one support in two spans meet there.
bool share_a_support(const PowerLines& lines, const Conductor& a, const Conductor& b) {
  for (const ConductorEnd* p : {&a.first, &a.last})
    for (const ConductorEnd* q : {&b.first, &b.last})
      if ((p->pylon && p->pylon == q->pylon) || (p->partner && *p->partner == static_cast<size_t>(&b - lines.conductors.data())) ||
          (q->partner && *q->partner == static_cast<size_t>(&a - lines.conductors.data())))
        return true;
  return false;
}

std::optional<Clearance> to_wires(const PowerLines& lines, size_t conductor, const ClearanceOptions& o) {
  const Conductor& own = lines.conductors[conductor];
  const Wire wire(own, o.swing);
  Clearance best;
  best.kind = Hazard::wire;
  best.at_rest = best.swung = std::numeric_limits<double>::infinity();
  best.limit = o.limit[static_cast<size_t>(Hazard::wire)];
  const Vector3d middle = wire.at(0.5 * (wire.first() + wire.last()));
  for (size_t k = 0; k < lines.conductors.size(); ++k) {
    const Conductor& c = lines.conductors[k];
    if (k == conductor || (c.span != own.span && share_a_support(lines, own, c))) continue;
    const Wire other(c, o.swing);
    const double far = 0.5 * (other.last() - other.first() + wire.last() - wire.first()) + o.reach;
    if ((other.at(0.5 * (other.first() + other.last())) - middle).norm() > far) continue;
    for (double s = other.first(); s <= other.last(); s += sample) {
      const Vector3d p = other.at(s);
      const double foot = wire.foot(p);
      best.swung = std::min(best.swung, wire.swung(p, foot));
      if ((p - wire.at(foot)).norm() >= best.at_rest) continue;
      best.conductor = k, best.s = s;  // of the other, for now
      best.at_rest = (p - wire.at(foot)).norm();
    }
  }
  if (!best.conductor || best.at_rest > o.reach) return std::nullopt;
  const Conductor& c = lines.conductors[*best.conductor];
  const Wire other(c, o.swing);
  double so = best.s;
  for (int round = 0; round < 100; ++round) so = other.foot(wire.at(wire.foot(other.at(so))));  // from curve to curve
  best.other = other.at(so);
  best.s = wire.foot(best.other);
  best.wire = wire.at(best.s);
  best.at_rest = std::min(best.at_rest, (best.other - best.wire).norm());
  best.swung = std::min(best.swung, best.at_rest);
  const Vector3d direction = (best.other - best.wire).normalized();
  best.sigma = std::hypot(wire.sigma(best.s, direction), other.sigma(so, direction));
  return best;
}

}  // namespace

ConductorClearances clearances_of(const PowerLines& lines, size_t conductor, const Obstacles& obstacles, const ClearanceOptions& o) {
  const Wire wire(lines.conductors[conductor], o.swing);
  ConductorClearances out;
  if (const auto c = to_ground(wire, obstacles, o)) out.smallest.push_back(*c);
  for (const Hazard kind : {Hazard::vegetation, Hazard::building})
    if (const auto c = to_returns(wire, kind, obstacles, o, out.infringements)) out.smallest.push_back(*c);
  if (const auto c = to_wires(lines, conductor, o)) out.smallest.push_back(*c);
  return out;
}

std::vector<FallingTree> falling_trees(const PowerLines& lines, size_t span, const Obstacles& obstacles, const ClearanceOptions& o) {
  const Span& s = lines.spans[span];
  // The highest return of each square metre of the span's surroundings.
  std::map<std::pair<std::int64_t, std::int64_t>, Vector3d> highest;
  for (const size_t k : s.conductors)
    Wire(lines.conductors[k], o.swing).around(obstacles, o.reach, [&](const Obstacle& obstacle) {
      if (obstacle.kind != Hazard::vegetation) return;
      Vector3d& top = highest.try_emplace({core::cell_index(obstacle.x, top_cell), core::cell_index(obstacle.y, top_cell)}, obstacle.at())
                          .first->second;
      if (obstacle.z > top.z()) top = obstacle.at();
    });
  std::vector<FallingTree> out;
  const auto around = static_cast<std::int64_t>(std::ceil(top_radius / top_cell));
  for (const auto& [cell, top] : highest) {
    bool is_top = true;
    for (std::int64_t j = -around; j <= around && is_top; ++j)
      for (std::int64_t i = -around; i <= around && is_top; ++i) {
        const auto at = highest.find({cell.first + i, cell.second + j});
        is_top = at == highest.end() || at->second.z() <= top.z() || (at->second - top).head<2>().norm() > top_radius;
      }
    if (!is_top) continue;
    const auto ground = obstacles.ground(top.head<2>());
    if (!ground || top.z() - ground->z < least_tree) continue;
    FallingTree tree{top, top.z() - ground->z, std::numeric_limits<double>::infinity(), 0};
    const Vector3d base(top.x(), top.y(), ground->z);
    for (const size_t k : s.conductors) {
      const Wire wire(lines.conductors[k], o.swing);
      const double margin = (wire.at(wire.foot(base)) - base).norm() - tree.height;
      if (margin < tree.margin) tree.margin = margin, tree.conductor = k;
    }
    if (tree.margin < o.limit[static_cast<size_t>(Hazard::vegetation)]) out.push_back(tree);
  }
  return out;
}

}  // namespace swath::terrain
