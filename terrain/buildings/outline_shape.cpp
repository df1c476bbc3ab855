// SPDX-License-Identifier: GPL-3.0-or-later
// Sides of an outline as lines, each through a stretch of the rim; corners where neighbours meet.
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <complex>

#include "core/ring.h"
#include "terrain/buildings/outline.h"

namespace swath::terrain {
namespace {

using Eigen::Matrix2d;
using Eigen::Vector2d;

constexpr double rectangular = 0.8;           // share of the sides' length that lies along two directions
constexpr double rectangular_known = 0.5;     // the same where the directions are known
constexpr double corner_share = 1.25;         // of the movement, that a corner may lie off the rim
constexpr double turned = 15.0 / 180 * M_PI;  // rad from such a direction
constexpr double roughness_share = 1.5;       // of the rim's rms off a side, that the side moves outwards: 1 where depths of the outermost
                                              // returns are exponential, 1.73 where they are uniform
constexpr double least_sine = 0.34;           // of the angle of two sides that meet: 20 deg
constexpr double least_area = 0.5;            // of the rim's area that is left

Vector2d direction(double angle) { return {std::cos(angle), std::sin(angle)}; }
double angle_of(const Vector2d& d) { return std::atan2(d.y(), d.x()); }
double cross(const Vector2d& a, const Vector2d& b) { return a.x() * b.y() - a.y() * b.x(); }

/// A stretch of the rim from vertex `first` to `last` (beyond the ring's end it goes on at its begin), and the line through it.
struct Side {
  size_t first = 0, last = 0;
  int quarter = -1;  ///< of a turn, from the first direction; -1: oblique
  Vector2d along = Vector2d::Zero();
  double offset = 0.0;  ///< of the line to the right of the origin

  Vector2d right() const { return {along.y(), -along.x()}; }
  Vector2d nearest(const Vector2d& p) const { return p + (offset - right().dot(p)) * right(); }
};

/// The places of a stretch, weighted by length.
struct Scatter {
  double length = 0.0;
  Vector2d mean = Vector2d::Zero();
  Matrix2d moments = Matrix2d::Zero();
};

class Shaper {
 public:
  Shaper(const Ring& ring, const ShapeOptions& o, bool square) : ring_(ring), o_(o) {
    const std::vector<size_t> corners = corners_of(ring, 0.5 * o.movement);
    for (size_t k = 0; k < corners.size(); ++k) {
      Side s;
      s.first = corners[k], s.last = k + 1 < corners.size() ? corners[k + 1] : corners[0] + ring.size();
      s.along = (at(s.last) - at(s.first)).normalized();
      sides_.push_back(s);
    }
    if (square) find_directions();
    for (Side& s : sides_) fit(s);
    if (squared_)
      while (sides_.size() > 3 && join_one()) {
      }
  }

  bool is_squared() const { return squared_; }
  double direction_of_sides() const { return first_; }

  Ring ring() const {
    Ring out;
    for (size_t k = 0; k < sides_.size(); ++k) {
      const Side &a = sides_[k], &b = sides_[(k + 1) % sides_.size()];
      const double sine = cross(a.along, b.along);
      if (std::abs(sine) > least_sine) {
        out.push_back(meeting(a, b));
        continue;
      }
      const Vector2d from = a.nearest(at(a.last)), to = b.nearest(at(a.last));
      if (a.quarter >= 0 && b.quarter >= 0) {
        out.push_back(from);
        out.push_back(to);
      } else {
        out.push_back(0.5 * (from + to));
      }
    }
    return without_straight(out);
  }

 private:
  const Vector2d& at(size_t v) const { return ring_[v % ring_.size()]; }

  static Vector2d meeting(const Side& a, const Side& b) {
    const Vector2d p = a.offset * a.right();
    return p + cross(b.offset * b.right() - p, b.along) / cross(a.along, b.along) * a.along;
  }

  /// Vertices from one to another, onwards.
  size_t stretch_length(size_t from, size_t to) const { return (to % ring_.size() + ring_.size() - from % ring_.size()) % ring_.size(); }

  Ring stretch(const Side& s) const {
    Ring out;
    for (size_t v = s.first; v <= s.last; ++v) out.push_back(at(v));
    return out;
  }

  Scatter scatter_of(const Side& s) const {
    Scatter out;
    for (size_t v = s.first; v < s.last; ++v) {
      const double length = (at(v + 1) - at(v)).norm();
      out.length += length;
      out.mean += 0.5 * length * (at(v) + at(v + 1));
    }
    out.mean /= out.length;
    for (size_t v = s.first; v < s.last; ++v) {
      const Vector2d a = at(v) - out.mean, b = at(v + 1) - out.mean;
      out.moments += (b - a).norm() / 6.0 * (2.0 * a * a.transpose() + 2.0 * b * b.transpose() + a * b.transpose() + b * a.transpose());
    }
    return out;
  }

  int quarter_of(const Side& s, double first) const {
    const double turns = (angle_of(s.along) - first) / (0.5 * M_PI);
    if (std::abs(turns - std::round(turns)) * 0.5 * M_PI > turned) return -1;
    return static_cast<int>(((std::lround(turns) % 4) + 4) % 4);
  }

  /// Two directions at right angles: by the sides' length, then by least squares through the stretches along them.
  void find_directions() {
    std::complex<double> sum = 0.0;
    double all = 0.0, along = 0.0;
    for (const Side& s : sides_) {
      const double length = (at(s.last) - at(s.first)).norm();
      sum += std::polar(length, 4.0 * angle_of(s.along));
      all += length;
    }
    first_ = o_.direction.value_or(std::arg(sum) / 4.0);
    Matrix2d moments = Matrix2d::Zero();
    for (const Side& s : sides_) {
      const int q = quarter_of(s, first_);
      if (q < 0) continue;
      along += (at(s.last) - at(s.first)).norm();
      Matrix2d back;
      back.col(0) = direction(-q * 0.5 * M_PI), back.col(1) = direction(-q * 0.5 * M_PI + 0.5 * M_PI);
      moments += back * scatter_of(s).moments * back.transpose();
    }
    squared_ = along >= (o_.direction ? rectangular_known : rectangular) * all;
    if (!squared_) return;
    for (Side& s : sides_) s.quarter = quarter_of(s, first_);
    if (o_.direction) return;
    const Vector2d d = Eigen::SelfAdjointEigenSolver<Matrix2d>(moments).eigenvectors().col(1);
    first_ = angle_of(d.dot(direction(first_)) < 0.0 ? Vector2d(-d) : d);
    for (Side& s : sides_) s.quarter = quarter_of(s, first_);
  }

  void fit(Side& s) const {
    const Scatter scatter = scatter_of(s);
    if (s.quarter >= 0) {
      s.along = direction(first_ + s.quarter * 0.5 * M_PI);
    } else if (s.last - s.first > 2) {
      const Vector2d d = Eigen::SelfAdjointEigenSolver<Matrix2d>(scatter.moments).eigenvectors().col(1);
      s.along = d.dot(at(s.last) - at(s.first)) < 0.0 ? Vector2d(-d) : d;
    }
    const double roughness = std::sqrt(std::max(0.0, s.right().dot(scatter.moments * s.right())) / scatter.length);
    s.offset = s.right().dot(scatter.mean) + std::min(roughness_share * roughness, o_.outwards);
  }

  /// Makes one side of sides k to k + n - 1.
  void join(size_t k, size_t n) {
    Side& s = sides_[k];
    for (size_t i = 1; i < n; ++i) {
      const Side& next = sides_[(k + i) % sides_.size()];
      s.last += stretch_length(s.last, next.last);  // also over what was taken away
    }
    fit(s);
    std::vector<Side> left;
    for (size_t i = 0; i + n <= sides_.size(); ++i) left.push_back(sides_[(k + (i == 0 ? 0 : i + n - 1)) % sides_.size()]);
    sides_ = std::move(left);
  }

  const Side& side(size_t k) const { return sides_[k % sides_.size()]; }

  /// How far the corner of sides k and k + between + 1 lies off what is between them, of what is allowed; none where that does not round it
  /// off.
  std::optional<double> rounded_off(size_t k, size_t between) const {
    const Side &a = side(k), &c = side(k + between + 1);
    if (sides_.size() < 4 + between || a.quarter < 0 || c.quarter < 0 || (a.quarter + c.quarter) % 2 == 0) return {};
    Side all = side(k + 1);
    for (size_t i = 1; i <= between; ++i) {
      const Side& piece = side(k + i);
      if (piece.quarter >= 0 && (at(piece.last) - at(piece.first)).norm() > o_.movement) return {};
      if (i > 1) all.last += stretch_length(all.last, piece.last);
    }
    return distance_to(stretch(all), meeting(a, c)) / (corner_share * o_.movement);
  }

  /// Joins sides of one direction and takes away jogs and what rounds off a corner, the smallest first. False where there are none.
  bool join_one() {
    double least = 1.0;  // of what is allowed
    size_t at_side = 0, joined = 0, dropped = 0;
    for (size_t k = 0; k < sides_.size(); ++k) {
      const auto offer = [&](double size, size_t join, size_t drop) {
        if (size < least) least = size, at_side = k, joined = join, dropped = drop;
      };
      const Side &a = side(k), &b = side(k + 1), &c = side(k + 2);
      if (a.quarter < 0) continue;
      if (a.quarter == b.quarter) offer(std::abs(a.offset - b.offset) / (0.5 * o_.movement), 2, 0);
      if (sides_.size() > 4 && a.quarter == c.quarter) offer(std::abs(a.offset - c.offset) / (0.5 * o_.movement), 3, 0);
      for (const size_t between : {1, 2})
        if (const auto off = rounded_off(k, between); off && (between > 1 || b.quarter < 0)) offer(*off, 0, between);
    }
    if (joined + dropped == 0) return false;
    if (joined > 0) join(at_side, joined);
    for (; dropped > 0; --dropped) {
      const size_t gone = (at_side + 1) % sides_.size();
      sides_.erase(sides_.begin() + static_cast<std::ptrdiff_t>(gone));
      if (gone < at_side) --at_side;
    }
    return true;
  }

  static Ring without_straight(const Ring& ring) {
    Ring out;
    for (size_t k = 0; k < ring.size(); ++k) {
      const Vector2d a = ring[k] - (out.empty() ? ring.back() : out.back()), b = ring[(k + 1) % ring.size()] - ring[k];
      if (a.norm() > 1e-3 && (std::abs(cross(a, b)) > 1e-4 * a.norm() * b.norm() || a.dot(b) < 0.0)) out.push_back(ring[k]);
    }
    return out;
  }

  const Ring& ring_;
  const ShapeOptions& o_;
  std::vector<Side> sides_;
  double first_ = 0.0;
  bool squared_ = false;
};

bool is_near(const Ring& shaped, const Ring& ring, const ShapeOptions& o) {
  const auto near = [](const Ring& all, const Ring& to, double farthest) {
    return std::all_of(all.begin(), all.end(), [&](const Vector2d& p) { return distance_to(to, p) <= farthest; });
  };
  if (!is_simple(shaped) || core::signed_area(shaped) / core::signed_area(ring) < least_area) return false;
  return near(shaped, ring, corner_share * o.movement + o.outwards) && near(ring, shaped, o.movement + o.outwards);
}

}  // namespace

std::vector<size_t> corners_of(const Ring& ring, double tolerance) {
  if (ring.size() < 3) return {};
  Vector2d middle = Vector2d::Zero();
  for (const Vector2d& p : ring) middle += p / static_cast<double>(ring.size());
  const auto farthest_from = [&](const Vector2d& q) {
    size_t best = 0;
    for (size_t k = 1; k < ring.size(); ++k)
      if ((ring[k] - q).squaredNorm() > (ring[best] - q).squaredNorm()) best = k;
    return best;
  };
  const size_t n = ring.size(), a = farthest_from(middle), b = farthest_from(ring[a]);
  std::vector<size_t> kept{a, b};
  std::vector<std::pair<size_t, size_t>> open{{std::min(a, b), std::max(a, b)}, {std::max(a, b), std::min(a, b) + n}};
  while (!open.empty()) {
    const auto [from, to] = open.back();
    open.pop_back();
    const Ring chord{ring[from % n], ring[to % n]};
    double farthest = tolerance;
    size_t at = 0;
    for (size_t k = from + 1; k < to; ++k)
      if (const double d = distance_to(chord, ring[k % n]); d > farthest) farthest = d, at = k;
    if (at == 0) continue;
    kept.push_back(at % n);
    open.push_back({from, at});
    open.push_back({at, to});
  }
  std::sort(kept.begin(), kept.end());
  kept.erase(std::unique(kept.begin(), kept.end()), kept.end());
  return kept;
}

ShapedRing shape_ring(const Ring& ring, const ShapeOptions& o) {
  if (ring.size() < 3) return {};
  for (const bool square : {true, false}) {
    if (square && !o.square) continue;
    const Shaper shaper(ring, o, square);
    if (square && !shaper.is_squared()) continue;
    Ring shaped = shaper.ring();
    if (!is_near(shaped, ring, o)) continue;
    return {std::move(shaped), square ? std::optional(shaper.direction_of_sides()) : std::nullopt};
  }
  Ring corners;
  for (const size_t k : corners_of(ring, 0.5 * o.movement)) corners.push_back(ring[k]);
  return {is_near(corners, ring, o) ? corners : ring, {}};
}

}  // namespace swath::terrain
