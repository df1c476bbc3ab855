// SPDX-License-Identifier: GPL-3.0-or-later
// Strands beside one another are a span; where strands of two spans meet there is a support. The sag is the largest distance of chord and
// wire; its variance follows from both catenaries at each support, as the station of their meeting depends on both, and on how flight lines
// differ where the two spans are seen by different ones.
#include "terrain/corridor/spans.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <tuple>

#include "core/statistics.h"
#include "terrain/corridor/passing.h"

namespace swath::terrain {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr double parallel = 0.07;      // rad: conductors of one span
constexpr double level_with = 30.0;    // m: and in height
constexpr double overlap = 0.6;        // of the shorter strand
constexpr double arms = 15.0;          // m: wires of one support lie within, across
constexpr double line_share = 0.1;     // of a wire's returns: flight lines with less say little of heights
constexpr double carries_near = 10.0;  // m in plan: wires that returns of a support must reach up to,
constexpr double carries_below = 4.0;  // m below the lowest of them at most;
constexpr double pole_below = 10.0;    // m, of poles that few returns show: over
constexpr double pole_height = 5.0;    // m or more
constexpr double at_support = 6.0;     // m along: meetings and returns of one support

class Groups {  // union-find
 public:
  explicit Groups(size_t n) : of_(n) { std::iota(of_.begin(), of_.end(), size_t{0}); }
  size_t root(size_t k) {
    while (of_[k] != k) k = of_[k] = of_[of_[k]];
    return k;
  }
  void join(size_t a, size_t b) { of_[std::max(root(a), root(b))] = std::min(root(a), root(b)); }

 private:
  std::vector<size_t> of_;
};

/// The part of b's range that lies beside a, on a's line.
double beside(const Strand& a, const Strand& b) {
  const auto [low, high] = range_along(a, b);
  return std::min(high, a.last) - std::max(low, a.first);
}

bool are_of_one_span(const Strand& a, const Strand& b, double widest) {
  if (std::abs(a.line.along.dot(b.line.along)) < std::cos(parallel)) return false;
  if (beside(a, b) < overlap * std::min(a.length(), b.length())) return false;
  const Vector2d middle = b.line.at(0.5 * (b.first + b.last));
  return std::abs(a.line.v(middle)) <= widest &&
         std::abs(a.fit.curve.z(a.line.s(middle)) - b.fit.curve.z(0.5 * (b.first + b.last))) <= level_with;
}

/// Returns that end far below the wires above them are of something else, a bush or a tree.
bool may_carry(const TowerGroup& t, const std::vector<WirePoint>& wires) {
  double lowest = 1e300;
  for (const WirePoint& w : wires)
    if ((Vector2d(w.x, w.y) - t.at).norm() <= carries_near) lowest = std::min(lowest, w.z);
  return lowest > 1e299 || t.top >= lowest - (t.top - t.bottom >= pole_height ? pole_below : carries_below);
}

class Builder {
 public:
  Builder(std::vector<Strand> strands, const std::vector<TowerGroup>& towers, const SpanOptions& o) : towers_(towers), options_(o) {
    std::sort(strands.begin(), strands.end(), [](const Strand& a, const Strand& b) {
      const Vector2d p = a.line.at(a.first), q = b.line.at(b.first);
      return std::make_tuple(p.x(), p.y(), a.fit.curve.level) < std::make_tuple(q.x(), q.y(), b.fit.curve.level);
    });
    group(std::move(strands));
  }

  PowerLines run() {
    sigma_line_ = sigma_of_lines();
    for (size_t c = 0; c < out_.conductors.size(); ++c)
      for (const bool last : {false, true}) meet(c, last);
    find_pylons();
    for (Conductor& c : out_.conductors) finish(c);
    for (Span& s : out_.spans) finish(s);
    return std::move(out_);
  }

 private:
  ConductorEnd& end(size_t c, bool last) { return last ? out_.conductors[c].last : out_.conductors[c].first; }

  /// Of one flight line's heights at the ends of wires, from how lines that see the same wire differ there, m.
  double sigma_of_lines() const {
    double squares = 0.0, redundancy = 0.0;
    for (const Conductor& c : out_.conductors)
      for (const double s : {c.strand.first, c.strand.last}) {
        std::vector<double> height;
        for (const LineOfFlight& l : c.strand.fit.lines)
          if (l.share >= line_share) height.push_back(l.level + l.tilt * (s - c.strand.fit.curve.at));
        if (height.size() < 2) continue;
        const double mean = std::accumulate(height.begin(), height.end(), 0.0) / static_cast<double>(height.size());
        for (const double h : height) squares += (h - mean) * (h - mean);
        redundancy += static_cast<double>(height.size()) - 1.0;
      }
    return redundancy > 0.0 ? std::sqrt(squares / redundancy) : 0.0;
  }

  /// Spans of the strands, without those that are too short to be believed.
  void group(std::vector<Strand> strands) {
    Groups groups(strands.size());
    for (size_t i = 0; i < strands.size(); ++i)
      for (size_t j = i + 1; j < strands.size(); ++j)
        if (are_of_one_span(strands[i], strands[j], options_.beside)) groups.join(i, j);
    for (size_t root = 0; root < strands.size(); ++root) {
      Span span;
      double longest = 0.0;
      std::vector<size_t> members;
      for (size_t k = root; k < strands.size(); ++k)
        if (groups.root(k) == root) members.push_back(k), longest = std::max(longest, strands[k].length());
      if (members.empty() || longest < options_.least_span) continue;
      for (const size_t k : members) {
        Conductor c;
        c.strand = std::move(strands[k]);
        c.span = out_.spans.size();
        c.first.s = c.strand.first, c.last.s = c.strand.last;
        span.conductors.push_back(out_.conductors.size());
        out_.conductors.push_back(std::move(c));
      }
      set_axis(span);
      out_.spans.push_back(std::move(span));
    }
  }

  void set_axis(Span& span) {
    Vector2d along = Vector2d::Zero(), from = Vector2d::Zero();
    const Vector2d like = out_.conductors[span.conductors[0]].strand.line.along;
    for (const size_t c : span.conductors) {
      const Strand& s = out_.conductors[c].strand;
      along += s.line.along.dot(like) < 0.0 ? Vector2d(-s.line.along) : s.line.along;
      from += s.line.at(0.5 * (s.first + s.last)) / static_cast<double>(span.conductors.size());
    }
    span.axis = {from, along.normalized()};
    std::sort(span.conductors.begin(), span.conductors.end(), [&](size_t a, size_t b) {
      const auto key = [&](size_t c) {
        const Strand& s = out_.conductors[c].strand;
        const Vector2d middle = s.line.at(s.line.s(span.axis.from));
        return std::make_pair(-std::round(span.axis.v(middle)), s.fit.curve.z(s.line.s(span.axis.from)));
      };
      return key(a) < key(b);
    });
  }

  Vector2d end_place(size_t c, bool last) const {
    const Strand& s = out_.conductors[c].strand;
    return s.line.at(last ? s.last : s.first);
  }

  /// The conductor of another span that carries on best at this end.
  void meet(size_t c, bool last) {
    const Strand& a = out_.conductors[c].strand;
    const Vector2d here = end_place(c, last);
    Meeting best;
    for (size_t k = 0; k < out_.conductors.size(); ++k) {
      if (out_.conductors[k].span == out_.conductors[c].span) continue;
      const Strand& b = out_.conductors[k].strand;
      for (const bool other : {false, true}) {
        if ((end_place(k, other) - here).norm() > 2 * options_.end_reach) continue;
        const Meeting m = meeting_of(a, last, b, other, options_.end_reach, sigma_line_);
        if (!m.found || (best.found && m.miss >= best.miss)) continue;
        best = m;
        end(c, last).partner = k;
      }
    }
    if (!best.found) return;
    end(c, last).s = best.s;
    end(c, last).sigma = best.sigma;
    end(c, last).known = true;
    in_plan_.resize(2 * out_.conductors.size(), 0);
    in_plan_[2 * c + (last ? 1 : 0)] = best.in_plan;
  }

  /// Supports: groups of returns, then meetings that have none near them.
  void find_pylons() {
    in_plan_.resize(2 * out_.conductors.size(), 0);
    for (const TowerGroup& t : towers_) {
      Pylon p;
      p.at = t.at, p.top = t.top, p.returns = t.returns;
      p.covariance = t.covariance;
      out_.pylons.push_back(p);
    }
    const size_t with_returns = out_.pylons.size();
    for (size_t c = 0; c < out_.conductors.size(); ++c)
      for (const bool last : {false, true})
        if (end(c, last).known) assign(c, last);
    for (size_t p = 0; p < out_.pylons.size(); ++p) place(p, p < with_returns);
    for (size_t c = 0; c < out_.conductors.size(); ++c)
      for (const bool last : {false, true})
        if (!end(c, last).known) hang_up(c, last);
    drop_unused();
  }

  /// The support at a known end.
  void assign(size_t c, bool last) {
    const Conductor& conductor = out_.conductors[c];
    const Vector2d at = conductor.strand.line.at(end(c, last).s);
    std::optional<size_t> nearest;
    for (size_t p = 0; p < out_.pylons.size(); ++p) {
      const Vector2d d = out_.pylons[p].at - at;
      if (std::abs(conductor.strand.line.along.dot(d)) > at_support || d.norm() > arms) continue;
      if (!nearest || d.norm() < (out_.pylons[*nearest].at - at).norm()) nearest = p;
    }
    if (!nearest) {
      nearest = out_.pylons.size();
      Pylon made;
      made.at = at;
      made.top = -1e300;
      out_.pylons.push_back(made);
    }
    end(c, last).pylon = nearest;
  }

  /// Of a support known by its wires alone, the middle of their meetings; one with returns takes its station along the line from them, as
  /// far as they know it better. Arms lie across the line that halves the turn: in that direction the wires' meetings lie beside the axis.
  void place(size_t p, bool has_returns) {
    Pylon& pylon = out_.pylons[p];
    std::vector<double> x, y;
    double weight = 0.0, top = -1e300;
    Vector2d along = Vector2d::Zero();
    for (const Conductor& c : out_.conductors)
      for (const ConductorEnd* e : {&c.first, &c.last}) {
        if (e->pylon != p || !e->known) continue;
        const Vector3d at = c.strand.at(e->s);
        x.push_back(at.x()), y.push_back(at.y());
        top = std::max(top, at.z());
        along += along.dot(c.strand.line.along) < 0.0 ? Vector2d(-c.strand.line.along) : c.strand.line.along;
        weight += 1.0 / std::max(1e-6, e->sigma * e->sigma);
      }
    if (x.empty()) return;
    const auto middle = [](const std::vector<double>& v) {
      const auto [low, high] = std::minmax_element(v.begin(), v.end());
      return 0.5 * (*low + *high);
    };
    const Vector2d meetings(middle(x), middle(y));
    const double variance = 2.0 / weight;  // each meeting is seen from both sides
    if (!has_returns) {
      pylon.at = meetings;
      pylon.top = top;
      pylon.covariance = variance * Eigen::Matrix2d::Identity();
      return;
    }
    along.normalize();
    const Vector2d moved = pylon.covariance * along, gain = moved / (along.dot(moved) + variance);
    pylon.at += gain * along.dot(meetings - pylon.at);
    pylon.covariance -= gain * moved.transpose();
  }

  /// An end without a meeting of its own takes the station of the support beyond it.
  void hang_up(size_t c, bool last) {
    const Strand& s = out_.conductors[c].strand;
    const double from = last ? s.last : s.first;
    std::optional<size_t> nearest;
    double best = options_.end_reach;
    for (size_t p = 0; p < out_.pylons.size(); ++p) {
      const double past = last ? s.line.s(out_.pylons[p].at) - from : from - s.line.s(out_.pylons[p].at);
      if (past < -at_support || past > best || std::abs(s.line.v(out_.pylons[p].at)) > arms) continue;
      best = past;
      nearest = p;
    }
    if (!nearest) return;
    ConductorEnd& e = end(c, last);
    e.pylon = nearest, e.known = true;
    e.s = s.line.s(out_.pylons[*nearest].at);
    e.sigma = std::sqrt(s.line.along.dot(out_.pylons[*nearest].covariance * s.line.along));
  }

  /// Supports without a wire are none.
  void drop_unused() {
    std::vector<std::optional<size_t>> now(out_.pylons.size());
    for (const Conductor& c : out_.conductors)
      for (const ConductorEnd* e : {&c.first, &c.last})
        if (e->pylon) now[*e->pylon] = 0;
    std::vector<Pylon> kept;
    for (size_t p = 0; p < now.size(); ++p)
      if (now[p]) now[p] = kept.size(), kept.push_back(out_.pylons[p]);
    out_.pylons = std::move(kept);
    for (Conductor& c : out_.conductors)
      for (ConductorEnd* e : {&c.first, &c.last})
        if (e->pylon) e->pylon = now[*e->pylon];
  }

  /// Sag with its sigma (see the head of this file).
  void finish(Conductor& c) {
    if (!c.first.known || !c.last.known || c.last.s - c.first.s < options_.strands.shortest || c.strand.fit.curve.kappa <= 0.0) return;
    const Catenary& wire = c.strand.fit.curve;
    const double run = c.last.s - c.first.s, slope = (wire.z(c.last.s) - wire.z(c.first.s)) / run;
    Sag sag;
    sag.s = wire.place_of(slope);
    const double t = (sag.s - c.first.s) / run;
    sag.value = c.chord(sag.s) - wire.z(sag.s);
    Vector3d own = (1.0 - t) * wire.gradient(c.first.s) + t * wire.gradient(c.last.s) - wire.gradient(sag.s);
    double variance = 0.0;
    const auto size = static_cast<size_t>(&c - out_.conductors.data());
    for (const bool last : {false, true}) {
      const ConductorEnd& e = last ? c.last : c.first;
      const double by_station = (last ? t : 1.0 - t) * (wire.dz(e.s) - slope);
      if (!e.partner || in_plan_[2 * size + (last ? 1 : 0)]) {
        variance += std::pow(by_station * e.sigma, 2);
        continue;
      }
      const Strand& other = out_.conductors[*e.partner].strand;
      const double so = other.line.s(c.strand.line.at(e.s));
      const double rate = wire.dz(e.s) - c.strand.line.along.dot(other.line.along) * other.fit.curve.dz(so);
      own -= by_station / rate * wire.gradient(e.s);
      variance += std::pow(by_station / rate, 2) *
                  (std::pow(other.fit.sigma_z(so), 2) + sigma_line_ * sigma_line_ * unlike_lines(c.strand.fit, other.fit));
    }
    sag.sigma = std::sqrt(variance + own.dot(c.strand.fit.covariance * own));
    c.sag = sag;
  }

  void finish(Span& span) {
    const auto number = static_cast<size_t>(&span - out_.spans.data());
    std::vector<double> first, last;
    for (const size_t k : span.conductors) {
      const Conductor& c = out_.conductors[k];
      const bool same = c.strand.line.along.dot(span.axis.along) > 0.0;
      const ConductorEnd &near = same ? c.first : c.last, &far = same ? c.last : c.first;
      first.push_back(span.axis.s(c.strand.line.at(near.s)));
      last.push_back(span.axis.s(c.strand.line.at(far.s)));
      if (near.pylon) span.pylon_first = near.pylon;
      if (far.pylon) span.pylon_last = far.pylon;
    }
    span.first = core::median(first), span.last = core::median(last);
    for (const auto& p : {span.pylon_first, span.pylon_last})
      if (p) out_.pylons[*p].spans.push_back(number);
  }

  const std::vector<TowerGroup>& towers_;
  const SpanOptions& options_;
  PowerLines out_;
  double sigma_line_ = 0.0;
  std::vector<char> in_plan_;  // of both ends of each conductor
};

}  // namespace

PowerLines find_power_lines(const std::vector<WirePoint>& wires, const std::vector<TowerPoint>& towers, const SpanOptions& o) {
  std::vector<TowerGroup> groups = tower_groups(towers);
  std::erase_if(groups, [&](const TowerGroup& t) { return !may_carry(t, wires); });
  const auto strands_between = [&] {
    std::vector<Vector2d> supports;
    for (const TowerGroup& t : groups) supports.push_back(t.at);
    return find_strands(wires, supports, o.strands);
  };
  std::vector<Strand> strands = strands_between();
  const std::vector<char> passed = passed_by_wires(wires, strands, groups, o.strands);
  if (std::erase_if(groups, [&](const TowerGroup& t) { return passed[static_cast<size_t>(&t - groups.data())]; }) > 0)
    strands = strands_between();
  return Builder(std::move(strands), groups, o).run();
}

}  // namespace swath::terrain
