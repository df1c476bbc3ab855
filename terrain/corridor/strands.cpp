// SPDX-License-Identifier: GPL-3.0-or-later
// After Melzer & Briese 2004: lines of wires grown from seeds in the upright plane; and McLaughlin 2006: one catenary per span. Deviations:
// while a strand grows, parabolas across and in height take the place of the catenary (0.3 m off in a span of 800 m of which the fit takes
// the larger part; the tube holds the rest), and a strand that ran on across a support is cut where two curves fit far better than one
// (an F test), which needs no knowledge of the supports.
#include "terrain/corridor/strands.h"

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numeric>
#include <optional>
#include <tuple>

#include "core/grid.h"

namespace swath::terrain {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr double strand_cell = 6.0;                             // m, of the index of points
constexpr double seed_reach = 15.0;                             // m around a seed
constexpr double seed_near = 0.35;                              // m from the straight line through two returns; sag over the reach included
constexpr double seed_baseline = 4.0;                           // m between these two
constexpr int seed_fewest = 4;                                  // returns in line with a seed
constexpr double strand_steepest = 0.6;                         // rise / run
constexpr double least_extension = 6.0, most_extension = 20.0;  // m that a strand grows at once
constexpr double support_reach = 3.0;                           // m along a strand around a support
constexpr double part_length = 8.0;                             // m: shortest part that a strand is cut into
constexpr double least_kink = 0.02;                             // change of slope at a support
constexpr double least_f = 25.0;          // of the F test, 3 and n - 6 degrees of freedom: by chance in far less than one of a million
constexpr double hanging = 1e-4;          // 1 / m: curves that open downwards by more (and 4 sigmas) are no wires
constexpr double other_direction = 0.03;  // rad: strands to be joined are nearly in one line
constexpr double scrap_near = 0.7;        // m
constexpr double scrap_density = 0.4;     // of the returns per metre of the strand beside it
constexpr double joint_least = 0.10;      // m: scatter that is good enough in any case

/// v = c0 + c1 u + c2 u^2 / 2, least squares; straight where there are few.
std::optional<Vector3d> parabola(const std::vector<Vector2d>& uv, bool straight) {
  Eigen::Matrix3d normal = Eigen::Matrix3d::Zero();
  Vector3d right = Vector3d::Zero();
  for (const Vector2d& p : uv) {
    const Vector3d row(1.0, p.x(), straight ? 0.0 : 0.5 * p.x() * p.x());
    normal += row * row.transpose();
    right += row * p.y();
  }
  if (straight) normal(2, 2) = 1.0;
  const Vector3d c = normal.ldlt().solve(right);
  if (!c.allFinite()) return std::nullopt;
  return c;
}
double value(const Vector3d& c, double u) { return c(0) + u * (c(1) + 0.5 * u * c(2)); }

/// Sums for parabolas over a run of places, of which differences are the sums of any part.
struct Moments {
  std::array<double, 5> u{};
  double w2 = 0.0;
  Vector3d uw = Vector3d::Zero();
  void add(double x, double w) {
    double power = 1.0;
    for (double& m : u) m += power, power *= x;
    uw += w * Vector3d(1.0, x, x * x);
    w2 += w * w;
  }
  Moments operator-(const Moments& o) const {
    Moments m = *this;
    for (size_t k = 0; k < u.size(); ++k) m.u[k] -= o.u[k];
    m.uw -= o.uw;
    m.w2 -= o.w2;
    return m;
  }
  /// Sum of squares about the parabola, and its coefficients of 1, x, x^2.
  double rest(Vector3d& c) const {
    Eigen::Matrix3d normal;
    for (int r = 0; r < 3; ++r)
      for (int k = 0; k < 3; ++k) normal(r, k) = u[static_cast<size_t>(r + k)];
    c = normal.ldlt().solve(uw);
    return std::max(0.0, w2 - c.dot(uw));
  }
};

class Finder {
 public:
  Finder(const std::vector<WirePoint>& points, const std::vector<Vector2d>& supports, const StrandOptions& o)
      : points_(points), supports_(supports), options_(o), free_(points.size(), 1) {
    order_.resize(points.size());
    std::iota(order_.begin(), order_.end(), 0u);
    std::sort(order_.begin(), order_.end(), [&](std::uint32_t a, std::uint32_t b) {
      const WirePoint &p = points[a], &q = points[b];
      return std::tie(p.x, p.y, p.z, p.line) < std::tie(q.x, q.y, q.z, q.line);
    });
    for (const std::uint32_t p : order_) cells_[key(points[p].x, points[p].y)].push_back(p);
  }

  std::vector<Strand> run() {
    std::vector<Strand> out;
    for (const std::uint32_t seed : order_) {
      if (!free_[seed]) continue;
      std::vector<std::uint32_t> rows = start(seed);
      if (rows.empty()) continue;
      rows = grow(seed, std::move(rows));
      for (std::vector<std::uint32_t>& part : cut(std::move(rows))) {
        Strand s = fit_strand(points_, std::move(part));
        if (!is_wire(s)) continue;
        for (const std::uint32_t p : s.points) free_[p] = 0;
        out.push_back(std::move(s));
      }
    }
    return out;
  }

 private:
  using Key = std::pair<std::int64_t, std::int64_t>;
  static Key key(double x, double y) { return {core::cell_index(x, strand_cell), core::cell_index(y, strand_cell)}; }

  template <class F>
  void around(double x, double y, int ring, F&& f) const {
    const auto [i, j] = key(x, y);
    for (std::int64_t v = j - ring; v <= j + ring; ++v)
      for (std::int64_t u = i - ring; u <= i + ring; ++u)
        if (const auto at = cells_.find({u, v}); at != cells_.end())
          for (const std::uint32_t p : at->second)
            if (free_[p]) f(p);
  }

  /// The returns in the straight line through the seed that has most.
  std::vector<std::uint32_t> start(std::uint32_t seed) const {
    const WirePoint& o = points_[seed];
    std::vector<std::pair<std::uint32_t, Vector3d>> near;
    around(o.x, o.y, 3, [&](std::uint32_t p) {
      const Vector3d d(points_[p].x - o.x, points_[p].y - o.y, points_[p].z - o.z);
      if (p != seed && d.norm() <= seed_reach) near.emplace_back(p, d);
    });
    std::vector<std::uint32_t> best;
    for (const auto& [to, d] : near) {
      const double run = d.head<2>().norm();
      if (run < seed_baseline || std::abs(d.z()) > strand_steepest * run) continue;
      const Vector3d along = d.normalized();
      std::vector<std::uint32_t> on{seed};
      for (const auto& [p, e] : near)
        if ((e - along.dot(e) * along).norm() <= seed_near) on.push_back(p);
      if (on.size() > best.size()) best = std::move(on);
    }
    drop_beyond_supports(seed, best);
    if (best.size() < static_cast<size_t>(seed_fewest)) best.clear();
    return best;
  }

  /// Keeps those on the seed's side of the supports between.
  void drop_beyond_supports(std::uint32_t seed, std::vector<std::uint32_t>& rows) const {
    const Vector2d from(points_[seed].x, points_[seed].y);
    const auto place = [&](std::uint32_t p) -> Vector2d { return Vector2d(points_[p].x, points_[p].y) - from; };
    Vector2d far = Vector2d::Zero();
    for (const std::uint32_t p : rows)
      if (place(p).norm() > far.norm()) far = place(p);
    if (far.norm() == 0.0) return;
    const PlanLine line{from, far.normalized()};
    double low = -1e300, high = 1e300;
    for (const Vector2d& support : supports_) {
      if (std::abs(line.v(support)) > support_beside) continue;
      (line.s(support) > 0.0 ? high : low) = line.s(support) > 0.0 ? std::min(high, line.s(support)) : std::max(low, line.s(support));
    }
    std::erase_if(rows, [&](std::uint32_t p) { return line.along.dot(place(p)) < low || line.along.dot(place(p)) > high; });
  }

  struct Curve {
    PlanLine line;
    Vector3d across, height;
    double first, last;
    bool holds(const WirePoint& p, double tube, double& s) const {
      const Vector2d at(p.x, p.y);
      s = line.s(at);
      return std::abs(line.v(at) - value(across, s)) <= tube && std::abs(p.z - value(height, s)) <= tube;
    }
  };

  std::optional<Curve> curve_of(const std::vector<std::uint32_t>& rows) const {
    Curve c;
    Vector2d mean = Vector2d::Zero(), far = Vector2d::Zero();
    for (const std::uint32_t p : rows) mean += Vector2d(points_[p].x, points_[p].y) / static_cast<double>(rows.size());
    Eigen::Matrix2d spread = Eigen::Matrix2d::Zero();
    for (const std::uint32_t p : rows) {
      far = Vector2d(points_[p].x, points_[p].y) - mean;
      spread += far * far.transpose();
    }
    const Vector2d along = Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d>(spread).eigenvectors().col(1);
    c.line = {mean, along.x() < 0.0 || (along.x() == 0.0 && along.y() < 0.0) ? Vector2d(-along) : along};
    std::vector<Vector2d> sv, sz;
    c.first = 1e300, c.last = -1e300;
    for (const std::uint32_t p : rows) {
      const Vector2d at(points_[p].x, points_[p].y);
      const double s = c.line.s(at);
      sv.emplace_back(s, c.line.v(at));
      sz.emplace_back(s, points_[p].z);
      c.first = std::min(c.first, s);
      c.last = std::max(c.last, s);
    }
    const bool is_short = c.last - c.first < options_.shortest || rows.size() < 8;
    const auto across = parabola(sv, is_short || c.last - c.first < 3 * options_.shortest), height = parabola(sz, is_short);
    if (!across || !height) return std::nullopt;
    c.across = *across, c.height = *height;
    return c;
  }

  /// A support that the curve passes beyond its end at s, on the way to s + step; the growth ends there.
  double limit(const Curve& c, double from, double to) const {
    for (const Vector2d& support : supports_) {
      const double s = c.line.s(support);
      if (std::abs(c.line.v(support)) > support_beside) continue;
      if (to > from ? s > from - support_reach && s < to : s < from + support_reach && s > to) to = s;
    }
    return to;
  }

  std::vector<std::uint32_t> grow(std::uint32_t seed, std::vector<std::uint32_t> rows) const {
    for (int round = 0; round < 400; ++round) {
      const std::optional<Curve> c = curve_of(rows);
      if (!c) break;
      const double step = std::clamp(0.5 * (c->last - c->first), least_extension, most_extension);
      const double low = limit(*c, c->first, c->first - step), high = limit(*c, c->last, c->last + step);
      std::vector<std::pair<double, std::uint32_t>> on;
      std::map<Key, bool> visited;
      for (double s = low; s <= high + strand_cell; s += 0.5 * strand_cell) {
        const Vector2d at = c->line.at(s, value(c->across, s));
        const auto [i, j] = key(at.x(), at.y());
        for (std::int64_t v = j - 1; v <= j + 1; ++v)
          for (std::int64_t u = i - 1; u <= i + 1; ++u) {
            if (visited[{u, v}]) continue;
            visited[{u, v}] = true;
            const auto found = cells_.find({u, v});
            if (found == cells_.end()) continue;
            for (const std::uint32_t p : found->second) {
              double place = 0.0;
              if (free_[p] && c->holds(points_[p], options_.tube, place) && place >= low && place <= high) on.emplace_back(place, p);
            }
          }
      }
      if (on.size() < static_cast<size_t>(seed_fewest)) break;
      std::sort(on.begin(), on.end());
      std::vector<std::uint32_t> next;
      for (const auto& [s, p] : on) next.push_back(p);
      std::sort(next.begin(), next.end());
      std::vector<std::uint32_t> before = rows;
      std::sort(before.begin(), before.end());
      const bool same = next == before;
      rows = std::move(next);
      if (same) break;
    }
    if (std::find(rows.begin(), rows.end(), seed) == rows.end()) rows.push_back(seed);
    return rows;
  }

  /// Parts between supports.
  std::vector<std::vector<std::uint32_t>> cut(std::vector<std::uint32_t> rows) const {
    const Strand whole = fit_strand(points_, rows);
    if (!whole.fit.found) return {std::move(rows)};
    std::vector<std::pair<double, std::uint32_t>> on;
    for (const std::uint32_t p : rows) on.emplace_back(whole.line.s({points_[p].x, points_[p].y}), p);
    std::sort(on.begin(), on.end());
    const std::optional<size_t> at = kink(whole, on);
    if (!at) return {std::move(rows)};
    std::vector<std::uint32_t> left, right;
    for (size_t k = 0; k < on.size(); ++k) (k < *at ? left : right).push_back(on[k].second);
    std::vector<std::vector<std::uint32_t>> out = cut(std::move(left));
    for (auto& part : cut(std::move(right))) out.push_back(std::move(part));
    return out;
  }

  /// The first return behind the place where two curves fit far better than the whole one.
  std::optional<size_t> kink(const Strand& whole, const std::vector<std::pair<double, std::uint32_t>>& on) const {
    const size_t n = on.size();
    if (n < 12 || on.back().first - on.front().first < 2 * part_length) return std::nullopt;
    std::vector<Moments> sums(n + 1);
    for (size_t k = 0; k < n; ++k) {
      sums[k + 1] = sums[k];
      sums[k + 1].add(on[k].first - whole.fit.curve.at, points_[on[k].second].z - whole.fit.curve.z(on[k].first));
    }
    Vector3d c;
    const double one = sums[n].rest(c);
    double best = 1e300, bend = 0.0;
    size_t at = 0;
    for (size_t k = 6; k + 6 <= n; ++k) {
      if (on[k - 1].first - on.front().first < part_length || on.back().first - on[k].first < part_length) continue;
      Vector3d left, right;
      const double two = sums[k].rest(left) + (sums[n] - sums[k]).rest(right);
      if (two >= best) continue;
      best = two, at = k;
      const double s = 0.5 * (on[k - 1].first + on[k].first) - whole.fit.curve.at;
      bend = std::abs(right(1) - left(1) + 2 * s * (right(2) - left(2)));
    }
    if (at == 0 || bend < least_kink) return std::nullopt;
    const double f = (one - best) / 3.0 / std::max(1e-12, best / (static_cast<double>(n) - 6.0));
    return f > least_f ? std::optional(at) : std::nullopt;
  }

  bool is_wire(const Strand& s) const {
    if (!s.fit.found || s.points.size() < static_cast<size_t>(options_.fewest) || s.length() < options_.shortest) return false;
    return s.fit.curve.kappa > -std::max(hanging, 4 * std::sqrt(s.fit.covariance(2, 2)));
  }

  const std::vector<WirePoint>& points_;
  const std::vector<Vector2d>& supports_;
  const StrandOptions& options_;
  std::vector<char> free_;
  std::vector<std::uint32_t> order_;
  std::map<Key, std::vector<std::uint32_t>> cells_;
};

bool is_support_between(const Strand& a, double from, double to, const std::vector<Vector2d>& supports) {
  return std::any_of(supports.begin(), supports.end(), [&](const Vector2d& p) {
    const double s = a.line.s(p);
    return std::abs(a.line.v(p)) <= support_beside && s > from - support_reach && s < to + support_reach;
  });
}

/// Two strands of one wire as one, where one curve fits both.
std::optional<Strand> joined(const std::vector<WirePoint>& points, const Strand& a, const Strand& b, const std::vector<Vector2d>& supports,
                             const StrandOptions& o) {
  if (std::abs(a.line.along.dot(b.line.along)) < std::cos(other_direction)) return std::nullopt;
  const auto [low, high] = range_along(a, b);
  const double gap = low > a.last ? low - a.last : a.first > high ? a.first - high : 0.0;
  if (gap > o.join || std::min(high, a.last) - std::max(low, a.first) > 0.5 * std::min(high - low, a.length())) return std::nullopt;
  if (gap > 0.0 && is_support_between(a, std::min(high, a.last), std::max(low, a.first), supports)) return std::nullopt;
  const Vector2d middle = b.line.at(0.5 * (b.first + b.last));
  if (std::abs(a.line.v(middle)) > o.tube + 0.02 * gap) return std::nullopt;
  std::optional<Strand> both = fit_as_one(points, a, b);
  const double apart = std::max(a.fit.sigma, b.fit.sigma);
  if (!both || both->fit.sigma > std::max(joint_least, joint_growth * apart) ||
      both->sigma_v > std::max(joint_least, joint_growth * std::max(a.sigma_v, b.sigma_v)) || both->fit.curve.kappa < -hanging)
    return std::nullopt;
  return both;
}

/// Strands of few returns close along another one are what a fit has left of it.
void drop_scraps(std::vector<Strand>& strands) {
  const auto is_scrap_of = [](const Strand& a, const Strand& b) {
    if (std::abs(a.line.along.dot(b.line.along)) < std::cos(2 * other_direction)) return false;
    const Vector2d middle = a.line.at(0.5 * (a.first + a.last));
    const double s = b.line.s(middle);
    if (s < b.first || s > b.last || std::abs(b.line.v(middle)) > scrap_near) return false;
    if (std::abs(b.fit.curve.z(s) - a.fit.curve.z(0.5 * (a.first + a.last))) > scrap_near) return false;
    return static_cast<double>(a.points.size()) / a.length() < scrap_density * static_cast<double>(b.points.size()) / b.length();
  };
  std::vector<char> scrap(strands.size(), 0);
  for (size_t i = 0; i < strands.size(); ++i)
    scrap[i] =
        std::any_of(strands.begin(), strands.end(), [&](const Strand& b) { return &b != &strands[i] && is_scrap_of(strands[i], b); });
  std::vector<Strand> kept;
  for (size_t i = 0; i < strands.size(); ++i)
    if (!scrap[i]) kept.push_back(std::move(strands[i]));
  strands = std::move(kept);
}

}  // namespace

std::vector<Strand> find_strands(const std::vector<WirePoint>& points, const std::vector<Vector2d>& supports, const StrandOptions& o) {
  std::vector<Strand> strands = Finder(points, supports, o).run();
  for (size_t i = 0; i < strands.size(); ++i)
    for (size_t j = i + 1; j < strands.size();) {
      auto both = joined(points, strands[i], strands[j], supports, o);
      if (!both) {
        ++j;
        continue;
      }
      strands[i] = std::move(*both);
      strands.erase(strands.begin() + static_cast<std::ptrdiff_t>(j));
      j = i + 1;  // the longer strand may reach others
    }
  drop_scraps(strands);
  return strands;
}

}  // namespace swath::terrain
