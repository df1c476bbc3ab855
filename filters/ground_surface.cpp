// SPDX-License-Identifier: GPL-3.0-or-later
// Two passes.
// The coarse one is Pingel, Clarke & McBride 2013 (ISPRS J. 77): lowest last return per cell, holes filled, objects where an opening by a
// growing disk drops. Deviations: no drop is allowed beyond what the steepest ground can fall within a cell and half a metre more, so that
// low halls are taken off by large disks too; low outliers are looked for in the surface of what is left and not in the lowest returns,
// where ground seen through a gap of the canopy looks the same.
// The fine one is hierarchic robust interpolation (Kraus & Pfeifer 1998, ISPRS J. 53; Pfeifer, Stadler & Briese 2001): a surface through
// all last returns with weights by their distance from the surface before, small for what lies above. Deviations: moving planes stand for
// linear prediction (moving_planes.h), breaks are kept by taking the smoother side, and the pyramid is one of kernels, not of points.
#include "filters/ground_surface.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <utility>

#include "filters/bins.h"
#include "filters/inpaint.h"
#include "filters/moving_planes.h"

namespace swath::filters {
namespace {

constexpr float void_value = std::numeric_limits<float>::quiet_NaN();
constexpr Inpainting gap_filling{.reach = 10, .relax = 2, .extrapolate = true};
constexpr Inpainting pit_filling{.reach = 6, .relax = 0, .extrapolate = true};
constexpr double growth = 0.15;       // rise / run: drop of an opening allowed per radius (Pingel's slope)
constexpr double step_left = 0.5;     // m, beyond the steepest ground within one cell
constexpr int pit_radius = 2;         // cells
constexpr double pit_depth = 0.4;     // m
constexpr double prior_weight = 0.3;  // returns that the surface before stands for

/// One round of the fine pass.
struct Round {
  double sigma;  ///< of the kernel, cells
  double above;  ///< m: a return this far above the surface weighs half
};
constexpr std::array<Round, 4> rounds{{{3.0, 0.5}, {2.0, 0.3}, {2.0, 0.25}, {2.0, 0.2}}};
int break_step(double sigma) { return static_cast<int>(std::lround(1.5 * sigma)); }

constexpr double knee_low = 0.12, knee_low_per_slope = 0.5, knee_high = 2.0;  // m above the surface
constexpr double standing_sigma = 3.0;                                        // cells

int window_of(const GroundSurfaceOptions& o) { return static_cast<int>(std::ceil(0.5 * o.widest / ground_cell - 1e-9)) + 1; }
Inpainting terrain_filling(int window) { return {.reach = 2 * window, .relax = 4, .extrapolate = true}; }

/// Calls f(point, its cell) for all that make the surface.
template <class F>
void for_each_maker(const core::Block& b, const core::Lattice& l, F&& f) {
  for (size_t p = 0; p < b.size(); ++p) {
    if (!makes_ground(b, p)) continue;
    const CellIndex c = cell_of(l, b, p);
    f(p, l.at(c.i, c.j));
  }
}

Raster lowest_returns(const core::Block& b, const core::Lattice& l) {
  Raster r(l.nx, l.ny, void_value);
  for_each_maker(b, l, [&](size_t p, size_t c) {
    const auto z = static_cast<float>(b.z[p]);
    if (std::isnan(r.value[c]) || z < r.value[c]) r.value[c] = z;
  });
  return r;
}

/// Voids in `terrain` the cells that drop by more than ground can when the disk grows by a cell.
void remove_objects(Raster& terrain, const Raster& filled, const GroundSurfaceOptions& o, int window) {
  Raster last = filled;
  for (int radius = 1; radius <= window; ++radius) {
    const Raster opened = open_disk(filled, radius);
    const double tolerance = std::min(growth * ground_cell * radius, o.steepest * ground_cell + step_left);
    for (size_t c = 0; c < terrain.value.size(); ++c) {
      if (last.value[c] - opened.value[c] > tolerance) terrain.value[c] = void_value;
      last.value[c] = std::min(last.value[c], opened.value[c]);
    }
  }
}

/// Closing along a line of 2 half + 1 cells in the direction (di, dj). Cells without value take no part.
Raster close_line(const Raster& r, int di, int dj, int half) {
  const auto pass = [&](const Raster& in, bool highest) {
    Raster out = in;
    for (int j = 0; j < r.ny; ++j)
      for (int i = 0; i < r.nx; ++i) {
        float& v = out.value[r.at(i, j)];
        for (int k = -half; k <= half; ++k) {
          if (!r.holds(i + k * di, j + k * dj)) continue;
          const float other = in.value[r.at(i + k * di, j + k * dj)];
          v = highest ? (other > v ? other : v) : (other < v ? other : v);
        }
      }
    return out;
  };
  return pass(pass(r, true), false);
}

/// Voids the cells of `ground` where the surface through them has a pit: deeper than pit_depth along all four lines and at most
/// 2 pit_radius wide.
void remove_pits(Raster& ground, const Raster& surface) {
  Raster closed = close_line(surface, 1, 0, pit_radius);
  for (const auto& [di, dj] : {std::pair{0, 1}, std::pair{1, 1}, std::pair{-1, 1}}) {
    const Raster other = close_line(surface, di, dj, pit_radius);
    for (size_t c = 0; c < closed.value.size(); ++c) closed.value[c] = std::min(closed.value[c], other.value[c]);
  }
  for (size_t c = 0; c < ground.value.size(); ++c)
    if (closed.value[c] - surface.value[c] > pit_depth) ground.value[c] = void_value;
}

Raster coarse_surface(const core::Block& b, const core::Lattice& l, const GroundSurfaceOptions& o, int window) {
  Raster lowest = lowest_returns(b, l);
  const Raster filled = inpaint(lowest, gap_filling);
  remove_objects(lowest, filled, o, window);
  remove_pits(lowest, inpaint(lowest, pit_filling));
  return inpaint(lowest, terrain_filling(window));
}

/// Sums in whole units, so that they do not depend on the order of the points.
class Sums {
 public:
  explicit Sums(const core::Lattice& l) : nx_(l.nx), ny_(l.ny), weight_(l.size(), 0), value_(l.size(), 0), square_(l.size(), 0) {}
  void add(size_t c, double w, double r) {
    weight_[c] += whole(w);
    value_[c] += whole(w * r);
    square_[c] += whole(w * r * r);
  }
  CellSums by_cell() const { return {raster(weight_), raster(value_), raster(square_)}; }

 private:
  static constexpr double unit = 1 << 24;
  static std::int64_t whole(double v) { return std::llround(v * unit); }
  Raster raster(const std::vector<std::int64_t>& sums) const {
    Raster r(nx_, ny_, 0.0F);
    for (size_t c = 0; c < sums.size(); ++c) r.value[c] = static_cast<float>(static_cast<double>(sums[c]) / unit);
    return r;
  }
  int nx_, ny_;
  std::vector<std::int64_t> weight_, value_, square_;
};

/// 1 on the surface, a half at `above` over it and at twice that under it, 0 beyond five times as much (Kraus & Pfeifer's with exponent 4).
double weight_of(double r, double above) {
  const double u = r >= 0 ? r / above : -r / (2.0 * above);
  return u > 5.0 ? 0.0 : 1.0 / (1.0 + u * u * u * u);
}

void refine(GroundSurface& g, const core::Block& b, const Round& round, double noise) {
  const core::Lattice& l = g.lattice;
  Sums sums(l);
  for_each_maker(b, l, [&](size_t p, size_t c) {
    const RasterSample s = sample(g.height, l, b.origin.x() + b.x[p], b.origin.y() + b.y[p]);
    if (std::isnan(s.height)) return;
    const double r = b.z[p] - s.height;
    sums.add(c, weight_of(r, round.above * (1.0 + std::hypot(s.east, s.north))), r);
  });
  PlaneField planes = fit_planes(sums.by_cell(), round.sigma, prior_weight);
  const Raster shift = across_breaks(planes, break_step(round.sigma), noise);
  for (size_t c = 0; c < l.size(); ++c) g.height.value[c] += shift.value[c];
  g.support = std::move(planes.support);
  g.spread = std::move(planes.variance);
  for (float& v : g.spread.value) v = std::sqrt(v);
}

Raster standing_share(const GroundSurface& g, const core::Block& b) {
  const core::Lattice& l = g.lattice;
  Raster all(l.nx, l.ny, 0.0F), standing = all;
  for_each_maker(b, l, [&](size_t p, size_t c) {
    const RasterSample s = sample(g.height, l, b.origin.x() + b.x[p], b.origin.y() + b.y[p]);
    const double r = b.z[p] - s.height;
    all.value[c] += 1.0F;
    if (r > knee_low + knee_low_per_slope * std::hypot(s.east, s.north) && r < knee_high) standing.value[c] += 1.0F;
  });
  all = blur(all, standing_sigma);
  standing = blur(standing, standing_sigma);
  for (size_t c = 0; c < all.value.size(); ++c) standing.value[c] /= all.value[c] + 1.0F;
  return standing;
}

}  // namespace

bool makes_ground(const core::Block& b, size_t p) { return core::is_usable(b, p) && core::is_last_return(b, p); }

RasterSample sample(const Raster& r, const core::Lattice& l, double x, double y) {
  const double u = x / l.cell - 0.5 - static_cast<double>(l.i0);
  const double v = y / l.cell - 0.5 - static_cast<double>(l.j0);
  const int i = static_cast<int>(std::floor(u));
  const int j = static_cast<int>(std::floor(v));
  const double fu = u - i, fv = v - j;
  const size_t at = r.at(i, j), up = at + static_cast<size_t>(r.nx);
  const double sw = r.value[at], se = r.value[at + 1], nw = r.value[up], ne = r.value[up + 1];
  const double south = sw + fu * (se - sw), north = nw + fu * (ne - nw);
  return {south + fv * (north - south), ((se - sw) * (1 - fv) + (ne - nw) * fv) / l.cell, (north - south) / l.cell};
}

int surface_reach(const GroundSurfaceOptions& o) {
  const int window = window_of(o);
  int cells = gap_filling.support() + 2 * window + pit_filling.support() + 4 * pit_radius + terrain_filling(window).support();
  for (const Round& round : rounds) cells += 1 + reach(round.sigma) + break_step(round.sigma);
  return cells + 1 + reach(standing_sigma);
}

GroundSurface ground_surface(const core::Block& b, const GroundSurfaceOptions& o) {
  const int window = window_of(o);
  // The rim holds the centres of all disks that touch a filled cell.
  const core::Lattice l = lattice_around(b, ground_cell, gap_filling.support() + window + 1);
  GroundSurface g{l, coarse_surface(b, l, o, window), {}, {}, {}};
  for (const Round& round : rounds) refine(g, b, round, o.noise);
  g.standing = standing_share(g, b);
  return g;
}

}  // namespace swath::filters
