// SPDX-License-Identifier: GPL-3.0-or-later
// Zhang, Qi, Wan, Wang, Xie, Wang & Yan 2016, "An easy-to-use airborne LiDAR data filtering method based on cloth simulation",
// Remote Sensing 8(6), 501. Heights below are those of the inverted cloud: the cloth falls on it from above.
//
// Deviations. In brackets what each does to the mean total error over seven ISPRS samples, in points, where it was measured:
// - The cloth is cut into squares of the survey's own lattice with a margin (patches.h), so that no result depends on a tile's extent
//   (squares 4.5 times as wide, which hold a sample nearly whole: +0.9, and 0.2 to 6.6 % of a sample's labels differ).
// - Springs act pair by pair in a fixed colouring by the parity of the particles' lattice indices: pairs of one colour share no
//   particle, so that no order of particles is preferred. The authors' program goes particle by particle in the order of its rows. Not
//   measured.
// - Both particles of a spring go to their mean, as the paper says; the authors' program moves them by 0.3 to 0.5 of their distance.
//   Springs are the paper's: to neighbours, across the diagonals, and to the neighbours' neighbours in rows and columns. Not measured.
// - Particles without a point in their cell get their height by interpolation (inpaint.h), not from the nearest point. Not measured.
// - In each step the inner forces act `rigidness` times over the whole cloth and gravity moves it by 0.2 step^2. The authors' program
//   lets them act once, by shares of 1 - 0.7^n (one particle free) and 0.5 - 0.5 * 0.4^n (both), with 0.2 step^4 (so: -0.4; these
//   shares with the gravity here: -0.1; the paper's shares of 1 - 0.5^n with either gravity: -0.1).
// - The authors' program lays particles down on slopes only where the cloth is within 0.3 m of its point; the paper does not say so
//   (+5.0).
// - Velocities lose 1 % in each step, as in the authors' program and not in the paper: an undamped cloth over a pit swings for ever.
#include "filters/ground/csf.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

#include "filters/bins.h"
#include "filters/ground/inpaint.h"
#include "filters/ground/patches.h"

namespace swath::filters {
namespace {

constexpr double gravity = 0.2;     // authors' value
constexpr double damping = 0.01;    // of the velocity, per step; authors' value
constexpr double at_rest = 0.005;   // m: largest movement in a step of a cloth that has come to rest; authors' value
constexpr float slope_step = 0.3F;  // m: h_cp, between neighbours that the cloth is laid down on; authors' value
constexpr float no_height = std::numeric_limits<float>::quiet_NaN();

/// The cloth over one patch, n x n particles at the centres of lattice cells.
class Cloth {
 public:
  /// `stop`: height of the inverted cloud, where a falling particle stops; NaN where there is no particle.
  explicit Cloth(const Raster& stop) : stop_(stop) {
    float top = -std::numeric_limits<float>::infinity();
    for (const float h : stop.value)
      if (h > top) top = h;
    const size_t n = stop.value.size();
    height_.assign(n, static_cast<double>(top));
    there_.assign(n, 1.0);
    for (size_t c = 0; c < n; ++c)
      if (std::isnan(stop.value[c])) there_[c] = height_[c] = 0.0;
    free_ = there_;
    before_ = height_;
  }

  void fall(const CsfOptions& o) {
    std::vector<double> last;
    for (int k = 0; k < o.iterations; ++k) {
      last = height_;
      pull_down(gravity * o.step * o.step);
      stop_at_points();
      for (int r = 0; r < o.rigidness; ++r) pull_together();
      double movement = 0;
      for (size_t c = 0; c < height_.size(); ++c) movement = std::max(movement, std::abs(height_[c] - last[c]));
      if (movement < at_rest) break;
    }
    stop_at_points();
  }

  /// Lays free particles on the points under them, outwards from those that lie, over steps of at most `slope_step`.
  void lay_down_on_slopes() {
    std::vector<size_t> front;
    for (size_t c = 0; c < free_.size(); ++c)
      if (there_[c] > 0 && free_[c] == 0) front.push_back(c);
    while (!front.empty()) {
      const size_t c = front.back();
      front.pop_back();
      const int i = static_cast<int>(c % static_cast<size_t>(stop_.nx)), j = static_cast<int>(c / static_cast<size_t>(stop_.nx));
      for (const auto& [di, dj] : {std::pair{-1, 0}, {1, 0}, {0, -1}, {0, 1}}) {
        if (!stop_.holds(i + di, j + dj)) continue;
        const size_t d = stop_.at(i + di, j + dj);
        if (free_[d] == 0 || std::abs(stop_.value[d] - stop_.value[c]) > slope_step) continue;
        free_[d] = 0;
        height_[d] = static_cast<double>(stop_.value[d]);
        front.push_back(d);
      }
    }
  }

  /// Bilinear between particles; NaN where one of the four is missing. (u, v) in cells from the south-west particle.
  double height(double u, double v) const {
    const int i = std::clamp(static_cast<int>(std::floor(u)), 0, stop_.nx - 2),
              j = std::clamp(static_cast<int>(std::floor(v)), 0, stop_.ny - 2);
    const double fu = u - i, fv = v - j;
    const auto h = [&](int a, int b) { return there_[stop_.at(a, b)] > 0 ? height_[stop_.at(a, b)] : static_cast<double>(no_height); };
    return (h(i, j) * (1 - fu) + h(i + 1, j) * fu) * (1 - fv) + (h(i, j + 1) * (1 - fu) + h(i + 1, j + 1) * fu) * fv;
  }

 private:
  /// Zhang2016 eq 5, with damping.
  void pull_down(double by) {
    for (size_t c = 0; c < height_.size(); ++c) {
      const double velocity = (1.0 - damping) * (height_[c] - before_[c]);
      before_[c] = height_[c];
      height_[c] += free_[c] * (velocity - by);
    }
  }

  void stop_at_points() {
    for (size_t c = 0; c < height_.size(); ++c) {
      const auto stop = static_cast<double>(stop_.value[c]);
      if (free_[c] == 0 || height_[c] > stop) continue;
      height_[c] = stop;
      free_[c] = 0;
    }
  }

  /// Zhang2016 eq 6 for the spring between a and b.
  void pull(size_t a, size_t b) {
    const double half = 0.5 * there_[a] * there_[b] * (height_[b] - height_[a]);
    height_[a] += free_[a] * half;
    height_[b] -= free_[b] * half;
  }

  void pull_together() {
    const int nx = stop_.nx, ny = stop_.ny;
    const auto at = [this](int i, int j) { return stop_.at(i, j); };
    // To neighbours and across the diagonals; the first particle of a pair has the colour.
    for (int colour = 0; colour < 2; ++colour) {
      for (int j = 0; j < ny; ++j)
        for (int i = colour; i + 1 < nx; i += 2) pull(at(i, j), at(i + 1, j));
      for (int j = colour; j + 1 < ny; j += 2)
        for (int i = 0; i < nx; ++i) pull(at(i, j), at(i, j + 1));
      for (int j = colour; j + 1 < ny; j += 2)
        for (int i = 0; i + 1 < nx; ++i) pull(at(i, j), at(i + 1, j + 1));
      for (int j = colour; j + 1 < ny; j += 2)
        for (int i = 1; i < nx; ++i) pull(at(i, j), at(i - 1, j + 1));
    }
    // Over one particle; two rows or columns in turn have the colour.
    for (int colour = 0; colour < 2; ++colour) {
      for (int j = 0; j < ny; ++j)
        for (int i = 2 * colour; i + 2 < nx; i += i % 2 == 0 ? 1 : 3) pull(at(i, j), at(i + 2, j));
      for (int j = 2 * colour; j + 2 < ny; j += j % 2 == 0 ? 1 : 3)
        for (int i = 0; i < nx; ++i) pull(at(i, j), at(i, j + 2));
    }
  }

  const Raster& stop_;
  std::vector<double> height_, before_;
  std::vector<double> there_, free_;  // 1 or 0: is a particle; can still move
};

/// Squares of whole particles.
struct ClothSquares {
  int side, margin;  // particles
  explicit ClothSquares(const CsfOptions& o)
      : side(static_cast<int>(std::ceil(2.0 * o.span.value / o.resolution.value - 1e-9))),
        margin(static_cast<int>(std::ceil(o.span.value / o.resolution.value - 1e-9))) {}
  Patching patching(const CsfOptions& o) const { return {side * o.resolution.value, margin * o.resolution.value}; }
};

/// Height of the inverted cloud under each particle: that of the point nearest to it in its cell, or between those around.
Raster inverted_surface(const core::Block& b, const Patch& patch, const core::Lattice& l, int reach) {
  Raster surface(l.nx, l.ny, no_height);
  std::vector<double> nearest(l.size(), std::numeric_limits<double>::infinity());
  for (const std::uint32_t p : patch.rows) {
    const CellIndex c = cell_of(l, b, p);
    if (!l.holds(c.i, c.j)) continue;  // on the margin's edge, by rounding
    const double d = std::hypot(b.origin.x() + b.x[p] - l.centre_x(c.i), b.origin.y() + b.y[p] - l.centre_y(c.j));
    const size_t k = l.at(c.i, c.j);
    if (d >= nearest[k]) continue;
    nearest[k] = d;
    surface.value[k] = static_cast<float>(-b.z[p]);
  }
  return inpaint(surface, {.reach = reach, .relax = 0, .extrapolate = true});
}

}  // namespace

double halo(const CsfOptions& o) { return ClothSquares(o).patching(o).halo(); }

GroundCounts classify_ground_csf(core::Block& b, size_t own, const CsfOptions& o) {
  std::vector<Verdict> verdicts(b.size(), Verdict::object);
  const auto takes_part = [&b](size_t p) { return may_be_ground(b, p); };
  const ClothSquares squares(o);
  for_each_patch(b, own, squares.patching(o), takes_part, [&](const Patch& patch) {
    const double cell = o.resolution.value;
    const int particles = squares.side + 2 * squares.margin;
    const core::Lattice l{cell, std::llround(patch.x0 / cell) - squares.margin, std::llround(patch.y0 / cell) - squares.margin, particles,
                          particles};
    const Raster stop = inverted_surface(b, patch, l, squares.margin);
    Cloth cloth(stop);
    cloth.fall(o);
    if (o.smooth) cloth.lay_down_on_slopes();
    for (const std::uint32_t p : patch.rows) {
      const double x = b.origin.x() + b.x[p], y = b.origin.y() + b.y[p];
      if (!patch.owns(x, y)) continue;
      const double height = -cloth.height((x - l.centre_x(0)) / cell, (y - l.centre_y(0)) / cell);
      if (std::isnan(height))
        verdicts[p] = Verdict::no_surface;
      else if (std::abs(b.z[p] - height) <= o.threshold.value)
        verdicts[p] = Verdict::ground;
    }
  });
  return set_ground_classes(b, own, verdicts);
}

}  // namespace swath::filters
