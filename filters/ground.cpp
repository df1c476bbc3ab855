// SPDX-License-Identifier: GPL-3.0-or-later
// A return is judged by its distance from the robust surface (ground_surface.h) against the distance that is bearable at its place: the
// noise and roughness of the ground there and, where returns are sparse, what the surface errs by between them: more on slopes, and a
// leniency for what it smooths away (kerbs, furrows, boulders) that fades where many returns stand knee-high, as in crops and shrubs: there
// the lowest ones alone are ground.
// Where the returns are two populations, soil and a low crop that drew the surface up, the ground is the lower one (ground_populations.h).
// The chance is counted from the heights of all returns around (ground_chance.h), and what is bearable must have some: a half where returns
// are dense, any where they are sparse and the surface itself is in doubt. The probability that is stated is the chance, calibrated.
#include "filters/ground.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <vector>

#include "filters/bins.h"
#include "filters/ground_chance.h"
#include "filters/ground_populations.h"
#include "filters/ground_surface.h"

namespace swath::filters {
namespace {

constexpr float not_judged = std::numeric_limits<float>::quiet_NaN();
constexpr double per_spread = 2.0, per_spread_sparse = 3.0;  // of one standard deviation
constexpr double dense = 34.0;          // ground's returns in the kernel of the last planes from which the surface follows the ground
constexpr double widest_spread = 0.15;  // m: what is more is not the ground's
constexpr double per_slope = 1.0;       // m per rise / run
constexpr double leniency = 0.2;        // m
constexpr double fading = 0.25;         // of leniency to 1 / e, share of returns standing knee-high
constexpr double below = 0.45, below_per_slope = 0.5;  // m, m per rise / run: most that is bearable under the surface
constexpr double sunken_few = 0.06;                    // share of returns deep below the surface from which it is the surface that errs
constexpr double sunken_room = 1.5;                    // m more under the surface where twice that share is
constexpr double least_spread = 0.01;                  // m: below what ranges are recorded to
constexpr double inflated = 1.5;                       // of the lower population's spread: the surface's where it lies between two

// Constant, per log odds of the chance, per logarithm of the share standing knee-high: bench/accuracy/ground_calibration.py, 2026-11-22.
constexpr std::array<double, 3> calibration{-2.497, 0.860, -0.830};

GroundSurfaceOptions surface_options(const GroundOptions& o) {
  return {o.widest.value, o.longest.value, std::tan(o.steepest.value), o.noise.value};
}

/// The error between returns grows with the square of their distance, and that is the inverse of their number; between dense and sparse
/// the square of this share came out best on both simulated and scanned ground. `support`: ground's returns behind the surface.
double sparse_of(double support) { return support > dense ? std::pow(dense / support, 2) : 1.0; }

/// m below the surface.
double deepest(double slope) { return below + below_per_slope * slope; }

/// m from the ground. `above`: m over it, `spread`: m, standard deviation about it.
double bearable(const GroundEvidence& e, double above, double spread, double sparse, double noise) {
  const double most = (per_spread + (per_spread_sparse - per_spread) * sparse) * std::hypot(noise, std::min(spread, widest_spread)) +
                      sparse * (per_slope * e.slope + leniency * std::exp(-e.standing / fading));
  // A low outlier lies alone; where many lie below, the surface has been drawn over a break.
  if (above < 0) return std::min(most, deepest(e.slope)) + sunken_room * std::clamp(e.sunken / sunken_few - 1.0, 0.0, 1.0);
  return most;
}

/// A point beside the surface; above NaN where no surface is.
GroundEvidence beside(const GroundSurface& g, const core::Block& b, size_t p) {
  const RasterSample s = sample(g.height, g.lattice, b.origin.x() + b.x[p], b.origin.y() + b.y[p]);
  const CellIndex c = cell_of(g.lattice, b, p);
  const size_t at = g.lattice.at(c.i, c.j);
  return {.above = static_cast<float>(b.z[p] - s.height),
          .spread = g.spread.value[at],
          .slope = static_cast<float>(std::sqrt(s.east * s.east + s.north * s.north)),
          .standing = g.standing.value[at],
          .sunken = g.sunken.value[at],
          .support = g.support.value[at]};
}

ReturnOverGround judged(const GroundEvidence& e) {
  const double sparse = sparse_of(e.support), spread = std::max<double>(least_spread, e.spread);
  const double doubt = std::hypot(2.0 * spread, sparse * (per_slope * e.slope + leniency));
  return {e.above, static_cast<float>(spread), static_cast<float>(doubt), e.above < -deepest(e.slope)};
}

/// Where returns are two populations the ground is the lower one.
void move_to_lower(ReturnOverGround& r, const LowerPopulations& lower, const core::Block& b, size_t p) {
  const CellIndex c = cell_of(lower.lattice, b, p);
  if (!lower.spread.holds(c.i, c.j)) return;
  const size_t at = lower.lattice.at(c.i, c.j);
  const float spread = lower.spread.value[at];
  if (std::isnan(spread) || r.spread <= static_cast<float>(inflated) * spread) return;
  r.above -= lower.middle.value[at];
  r.spread = spread;
}

/// The chance as counted, brought to the true share of ground among returns of that chance and of such places (Platt 1999): just above the
/// ground a crop nothing tells stands where returns stand knee-high, and on bare ground what the surface missed.
float stated_chance(const GroundEvidence& e) {
  if (std::isnan(e.above)) return 0.0F;
  const double p = std::clamp<double>(e.chance, 1e-4, 1.0 - 1e-4);
  const double log_odds = calibration[0] + calibration[1] * std::log(p / (1.0 - p)) + calibration[2] * std::log(e.standing + 0.01);
  return static_cast<float>(1.0 / (1.0 + std::exp(-log_odds)));
}

/// Ground lies near enough and is probable enough. Two populations are the less certain the fewer returns there are.
bool is_ground(const GroundEvidence& e, double noise) {
  const double sparse = sparse_of(e.support), above = e.above + (1.0 - sparse) * e.lowered;
  const double spread = e.spread + (1.0 - sparse) * (e.narrowed - e.spread);
  return std::abs(above) <= bearable(e, above, spread, sparse, noise) && e.chance >= static_cast<float>(0.5 * std::pow(1.0 - sparse, 2));
}

/// Halo points beyond the surface have no influence.
bool within_reach(const core::Lattice& l, const core::Block& b, size_t p) {
  const CellIndex c = cell_of(l, b, p);
  return c.i > 0 && c.j > 0 && c.i < l.nx - 1 && c.j < l.ny - 1;
}

}  // namespace

double halo(const GroundOptions& o) {
  return std::ceil((surface_reach(surface_options(o)) + 2) * ground_cell + ground_chance_reach + ground_populations_reach);
}

std::vector<GroundEvidence> ground_evidence(const core::Block& b, size_t own, const GroundOptions& o) {
  std::vector<GroundEvidence> evidence(own, GroundEvidence{.above = not_judged});
  bool any = false;
  for (size_t p = 0; p < b.size() && !any; ++p) any = may_be_ground(b, p);
  if (own == 0 || !any) return evidence;
  const GroundSurface g = ground_surface(b, own, ground_chance_reach + ground_populations_reach, surface_options(o));
  std::vector<ReturnOverGround> returns(b.size(), {not_judged, 0, 0, false});
  for (size_t p = 0; p < b.size(); ++p) {
    if (!may_be_ground(b, p) || !within_reach(g.lattice, b, p)) continue;
    const GroundEvidence e = beside(g, b, p);
    if (!std::isnan(e.above)) returns[p] = judged(e);
    if (p < own) evidence[p] = e;
  }
  const LowerPopulations lower = lower_populations(b, own, ground_chance_reach, returns, o.noise.value);
  for (size_t p = 0; p < b.size(); ++p) {
    if (std::isnan(returns[p].above)) continue;
    move_to_lower(returns[p], lower, b, p);
    if (p >= own) continue;
    GroundEvidence& e = evidence[p];
    e.lowered = returns[p].above - e.above;
    e.narrowed = e.lowered > 0 ? returns[p].spread : e.spread;
  }
  const std::vector<float> chances = ground_chances(b, own, returns);
  for (size_t p = 0; p < own; ++p) evidence[p].chance = chances[p];
  return evidence;
}

GroundChances classify_ground(core::Block& b, size_t own, const GroundOptions& o) {
  GroundChances n;
  core::add_columns(b, {core::Column::classification, core::Column::ground_probability});
  if (own == 0) return n;
  const std::vector<GroundEvidence> evidence = ground_evidence(b, own, o);
  std::vector<Verdict> verdicts(b.size(), Verdict::object);
  for (size_t p = 0; p < own; ++p) {
    const GroundEvidence& e = evidence[p];
    b.ground_probability[p] = core::is_usable(b, p) ? stated_chance(e) : not_judged;
    n.doubtful += b.ground_probability[p] > 0.25F && b.ground_probability[p] < 0.75F;
    if (!may_be_ground(b, p)) continue;
    if (std::isnan(e.above))
      verdicts[p] = Verdict::no_surface;
    else if (is_ground(e, o.noise.value))
      verdicts[p] = Verdict::ground;
  }
  static_cast<GroundCounts&>(n) = set_ground_classes(b, own, verdicts);
  return n;
}

}  // namespace swath::filters
