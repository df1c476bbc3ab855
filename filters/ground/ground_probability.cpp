// SPDX-License-Identifier: GPL-3.0-or-later
// Logistic regression (Platt 1999) on the chance as counted (ground_chance.h), the distance from the surface beside what is tolerable at
// the place, and the nearest returns: a crest or kerb that the surface missed has its like on its own level, a plant has ground below it.
// Where no pulse around is split the record has single echoes alone, and what stands knee-high is less often a plant.
// The weights: bench/accuracy/ground_calibration.py, on simulated surveys of several densities and echo models and on labelled real
// clouds, 2026-11-23. How true they are on clouds held out of the fit: docs/accuracy/ground.md.
#include "filters/ground/ground_probability.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <span>

#include "filters/bins.h"
#include "filters/ground/moving_planes.h"

namespace swath::filters {
namespace {

constexpr double dense = 34.0;          // ground's returns in the kernel of the last planes from which the surface follows the ground
constexpr double per_spread = 2.0;      // standard deviations that are tolerable, one more where returns are sparse
constexpr double widest_spread = 0.15;  // m: what is more is not the ground's
constexpr double per_slope = 1.0;       // m per rise / run
constexpr double leniency = 0.2;        // m
constexpr double fading = 0.25;         // of leniency to 1 / e, share of returns standing knee-high
constexpr double below = 0.45, below_per_slope = 0.5;  // m, m per rise / run: tolerable under the surface at most
constexpr double sunken_few = 0.06;                    // share of returns deep below the surface from which it is the surface that is off
constexpr double sunken_room = 1.5;                    // m more under the surface where twice that share is
constexpr double most_certain = 6.0;                   // log odds
constexpr size_t below_tolerable = 13;                 // of the terms: at -1 no ground lies deeper
constexpr double far = 3.0;                            // m from the surface: what lies farther is not ground

constexpr size_t nearest_count = 8;
constexpr int nearest_rings = 6;                       // cells of 1 m
constexpr double certain = 0.999, close = 0.1;         // chance, m: what is surer and closer is not in doubt
constexpr double level = 0.08, level_slope = 0.1;      // m, m per rise / run
constexpr double split_cell = 4.0, split_sigma = 1.5;  // m, cells
constexpr double split_few = 0.01;                     // share of split pulses under which a record has single echoes alone

// In the order of terms_of().
constexpr std::array<double, ground_terms> mown_weights{
    3.070,  0.161, -0.037, -0.318, -0.334,  0.131,  0.596,  -0.432, 3.424,  -2.447, -0.223, -0.230,  -0.508, -0.982, 2.820,  -0.713,
    -4.170, 6.299, -2.210, 14.065, -17.867, -0.421, -0.336, 3.549,  -5.551, 1.561,  5.418,  -32.302, 12.435, -6.009, -0.903, -8.771,
    3.259,  9.616, -0.385, 1.649,  1.656,   0.169,  -5.113, 2.587,  0.325,  -0.042, 0.148,  3.089,   0.475,  5.248};
constexpr std::array<double, ground_terms> bare_earth_weights{
    4.563,  0.514,  -0.257, -0.005,  -0.968, -0.365, 1.171,  1.511,  2.771,   -1.570, -2.456, -0.517,  -1.491, -5.573,  22.706, -10.318,
    -7.912, 3.703,  1.387,  -18.914, 17.422, -6.569, 5.629,  5.881,  -32.491, 16.498, 95.676, -14.377, 16.979, -41.236, -2.282, -8.529,
    5.719,  11.217, -0.296, 0.315,   -2.417, 0.315,  -2.006, -1.008, -0.565,  0.732,  -0.556, 8.261,   1.621,  8.460};

double beyond(double v, double knot) { return std::max(v - knot, 0.0); }

/// m from the ground that are tolerable. `above`: m over it; `spread`: m, standard deviation about it.
double tolerable(const GroundEvidence& e, double above, double spread, double sparse, double noise) {
  const double most =
      (per_spread + sparse) * std::hypot(noise, std::min(spread, widest_spread)) + sparse_error(e.slope, e.standing, sparse);
  // A low outlier lies alone; where many lie below, the surface has been drawn over a break.
  if (above < 0) return std::min(most, deepest_ground(e.slope)) + sunken_room * std::clamp(e.sunken / sunken_few - 1.0, 0.0, 1.0);
  return most;
}

/// Returns over the surface by cells of 1 m, those in the lattice `within` alone.
class SurfaceReturns {
 public:
  struct Return {
    double x, y;  ///< as in the block
    float above;
    std::uint32_t row;
  };

  SurfaceReturns(const core::Block& b, const std::vector<float>& above, const core::Lattice& within)
      : lattice_(lattice_around(b, 1.0, 0)), start_(lattice_.size() + 1, 0) {
    each(b, above, within, [&](size_t, size_t c) { ++start_[c + 1]; });
    for (size_t c = 1; c < start_.size(); ++c) start_[c] += start_[c - 1];
    returns_.resize(start_.back());
    each(b, above, within, [&](size_t p, size_t c) { returns_[start_[c]++] = {b.x[p], b.y[p], above[p], static_cast<std::uint32_t>(p)}; });
    std::rotate(start_.begin(), start_.end() - 1, start_.end());  // each has become the next one's
    start_[0] = 0;
  }

  const core::Lattice& lattice() const { return lattice_; }
  std::span<const Return> in(int i, int j) const {
    const size_t c = lattice_.at(i, j);
    return {returns_.data() + start_[c], start_[c + 1] - start_[c]};
  }

 private:
  template <class Take>
  void each(const core::Block& b, const std::vector<float>& above, const core::Lattice& within, const Take& take) const {
    constexpr size_t together = 1024;
    std::array<std::int32_t, together> column{}, row{}, i{}, j{};
    for (size_t first = 0; first < b.size(); first += together) {
      const size_t n = std::min(together, b.size() - first);
      cells_of(within, b, first, n, column.data(), row.data());
      cells_of(lattice_, b, first, n, i.data(), j.data());
      for (size_t k = 0; k < n; ++k)
        if (!std::isnan(above[first + k]) && within.holds(column[k], row[k])) take(first + k, lattice_.at(i[k], j[k]));
    }
  }

  core::Lattice lattice_;
  std::vector<std::uint32_t> start_;
  std::vector<Return> returns_;
};

NearestReturns nearest_of(const SurfaceReturns& returns, const core::Block& b, const std::vector<float>& above, size_t p, double slope) {
  struct Found {
    double square;
    float above;
    bool operator<(const Found& o) const { return square != o.square ? square < o.square : above < o.above; }
  };
  std::array<Found, nearest_count> best{};
  size_t n = 0;
  const CellIndex at = cell_of(returns.lattice(), b, p);
  const auto visit = [&](int i, int j) {
    if (!returns.lattice().holds(i, j)) return;
    for (const SurfaceReturns::Return& near : returns.in(i, j)) {
      if (near.row == p) continue;
      const double dx = near.x - b.x[p], dy = near.y - b.y[p];
      const Found f{dx * dx + dy * dy, near.above};
      if (n == nearest_count && !(f < best[n - 1])) continue;
      size_t to = n < nearest_count ? n++ : n - 1;
      for (; to > 0 && f < best[to - 1]; --to) best[to] = best[to - 1];
      best[to] = f;
    }
  };
  for (int ring = 0; ring <= nearest_rings; ++ring) {
    if (n == nearest_count && best[n - 1].square <= (ring - 1.0) * (ring - 1.0) && ring > 1) break;
    for (int d = -ring; d <= ring; ++d) {
      visit(at.i + d, at.j - ring);
      if (ring > 0) visit(at.i + d, at.j + ring);
      if (std::abs(d) < ring) visit(at.i - ring, at.j + d), visit(at.i + ring, at.j + d);
    }
  }
  if (n == 0) return {};
  std::array<float, nearest_count> z{};
  for (size_t k = 0; k < n; ++k) z[k] = std::clamp(best[k].above, -static_cast<float>(far), static_cast<float>(far));
  std::sort(z.begin(), z.begin() + static_cast<std::ptrdiff_t>(n));
  const float own = above[p];
  const auto tolerance = static_cast<float>(level + level_slope * std::min(slope, 1.0));
  NearestReturns r{own - z[0], own - z[n / nearest_count], own - z[3 * n / nearest_count], 0.0F, 0.0F};
  for (size_t k = 0; k < n; ++k) r.level += std::abs(z[k] - own) < tolerance, r.lower += z[k] < own - tolerance;
  r.level /= static_cast<float>(n), r.lower /= static_cast<float>(n);
  return r;
}

}  // namespace

const double ground_probability_reach = std::max((reach(split_sigma) + 1) * split_cell, nearest_rings + 1.0);

double deepest_ground(double slope) { return below + below_per_slope * slope; }

double sparseness(double support) { return support > dense ? std::pow(dense / support, 2) : 1.0; }

double sparse_error(double slope, double standing, double sparse) {
  return sparse * (per_slope * slope + leniency * std::exp(-standing / fading));
}

std::array<double, ground_terms> terms_of(const GroundEvidence& e, double noise) {
  const double sparse = sparseness(e.support), d = 1.0 - sparse, above = e.above + d * e.lowered;
  const double room = tolerable(e, above, e.spread + d * (e.narrowed - e.spread), sparse, noise);
  const double p = std::clamp<double>(e.chance, 1e-4, 1.0 - 1e-4), odds = std::log(p / (1.0 - p));
  const double standing = std::log(e.standing + 0.01) + 3.0, slope = std::min<double>(e.slope, 1.5);
  const double returns = std::clamp(std::log(std::max<double>(e.support, 0.1) / dense), -5.0, 3.0);
  const double reached = std::min(std::abs(above) / room, 5.0), z = above > 0 ? -reached : 0.0, y = above < 0 ? -reached : 0.0;
  const double up = std::clamp(above, 0.0, far), down = std::clamp(-above, 0.0, far), low = std::min<double>(e.lowered, 0.2);
  const auto bounded = [](double v) { return std::clamp(v, -0.5, 1.0); };
  const double lowest = bounded(e.nearest.over_lowest), second = bounded(e.nearest.over_second), fourth = bounded(e.nearest.over_fourth);
  const double level_share = e.nearest.level, lower = e.nearest.lower, single = std::exp(-e.splitting / split_few);
  const double metre = std::min(up, 1.0), over_grass = beyond(metre, 0.15);
  return {1.0,
          odds,
          beyond(odds, 2.0),
          standing,
          standing * d,
          returns,
          d,
          slope,
          z,
          std::min(z + 1.0, 0.0),
          z * d,
          z * standing,
          z * slope,
          y,
          std::min(y + 1.0, 0.0),
          y * slope,
          beyond(up, 0.05),
          beyond(up, 0.15),
          beyond(up, 0.3),
          metre * d,
          over_grass * d,
          metre * standing,
          over_grass * standing,
          beyond(down, 0.05),
          beyond(down, 0.2),
          beyond(down, 0.5),
          std::min<double>(e.sunken, 0.3),
          low,
          low * standing,
          std::min<double>(e.spread, 0.3),
          lowest,
          second,
          beyond(second, 0.12),
          std::min(second, 0.0),
          fourth,
          level_share,
          lower,
          level_share * d,
          lower * d,
          second * d,
          second * standing,
          single,
          single * standing,
          single * metre,
          single * z,
          single * std::max(second, 0.0)};
}

constexpr size_t sunken_term = 26;  // of terms_of()

float ground_probability(const GroundEvidence& e, double noise, Grass grass) {
  if (std::isnan(e.above) || std::abs(e.above) > far) return 0.0F;
  const std::array<double, ground_terms> terms = terms_of(e, noise);
  if (terms[below_tolerable] <= -1.0 && e.above < -deepest_ground(e.slope)) return 0.0F;
  const std::array<double, ground_terms>& weights = grass == Grass::mown ? mown_weights : bare_earth_weights;
  double sum = 0.0;
  for (size_t k = 0; k < ground_terms; ++k) sum += weights[k] * terms[k];
  // Returns deep below say that the surface lies too high: no reason to take what is above it. The weights of mown grass have it small.
  if (grass == Grass::bare_earth && e.above > 0.0F) sum -= std::max(0.0, weights[sunken_term]) * terms[sunken_term];
  return static_cast<float>(1.0 / (1.0 + std::exp(-std::clamp(sum, -most_certain, most_certain))));
}

void look_around(const core::Block& b, const std::vector<float>& above, std::vector<GroundEvidence>& evidence) {
  const size_t own = evidence.size();
  const core::Lattice l = lattice_around(b, own, split_cell, 0.0, reach(split_sigma));
  Raster all(l.nx, l.ny, 0.0F), split = all;
  for (size_t p = 0; p < b.size(); ++p) {
    const CellIndex at = cell_of(l, b, p);
    if (std::isnan(above[p]) || !all.holds(at.i, at.j)) continue;
    all.value[l.at(at.i, at.j)] += 1.0F;
    split.value[l.at(at.i, at.j)] += !b.return_count.empty() && b.return_count[p] > 1;
  }
  all = blur(all, split_sigma);
  split = blur(split, split_sigma);
  const SurfaceReturns returns(b, above, l);
  for (size_t p = 0; p < own; ++p) {
    GroundEvidence& e = evidence[p];
    if (std::isnan(e.above)) continue;
    const CellIndex at = cell_of(l, b, p);
    const size_t c = l.at(at.i, at.j);
    e.splitting = all.value[c] > 0 ? split.value[c] / all.value[c] : 0.0F;
    const bool doubtful = (e.chance < certain || std::abs(e.above) > close) && std::abs(e.above) <= far;
    if (doubtful) e.nearest = nearest_of(returns, b, above, p, e.slope);
  }
}

}  // namespace swath::filters
