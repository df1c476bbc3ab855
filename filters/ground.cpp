// SPDX-License-Identifier: GPL-3.0-or-later
// A return is judged by its distance from the robust surface (ground_surface.h) against the distance that is bearable at its place: the
// noise and roughness of the ground there and, where returns are sparse, what the surface errs by between them: more on slopes, and a
// leniency for what it smooths away (kerbs, furrows, boulders) that fades where many returns stand knee-high, as in crops and shrubs: there
// the lowest ones alone are ground.
// The probability is Kraus & Pfeifer's weight function 1 / (1 + (distance / bearable)^k) (ISPRS J. 53, 1998) read as a chance: a half
// where the distance is just bearable.
#include "filters/ground.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "filters/bins.h"
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
constexpr double steepness = 6.0;                      // of the probability about the bearable distance

GroundSurfaceOptions surface_options(const GroundOptions& o) { return {o.widest.value, std::tan(o.steepest.value), o.noise.value}; }

/// What is known of a return and its place.
struct Evidence {
  double above;     ///< m over the surface
  double slope;     ///< rise / run of the surface
  double spread;    ///< m, standard deviation of the ground's returns around
  double standing;  ///< share of the returns around that stand knee-high
  double sunken;    ///< share of them that lie deep below the surface
  double support;   ///< ground's returns behind the surface
};

double probability(const Evidence& e, double noise) {
  // The error between returns grows with the square of their distance, and that is the inverse of their number; between dense and sparse
  // the square of this share came out best on both simulated and scanned ground.
  const double sparse = e.support > dense ? std::pow(dense / e.support, 2) : 1.0;
  double bearable = (per_spread + (per_spread_sparse - per_spread) * sparse) * std::hypot(noise, std::min(e.spread, widest_spread)) +
                    sparse * (per_slope * e.slope + leniency * std::exp(-e.standing / fading));
  // A low outlier lies alone; where many lie below, the surface has been drawn over a break.
  if (e.above < 0)
    bearable = std::min(bearable, below + below_per_slope * e.slope) + sunken_room * std::clamp(e.sunken / sunken_few - 1.0, 0.0, 1.0);
  const double u = std::abs(e.above) / bearable;
  return 1.0 / (1.0 + std::pow(u, steepness));
}

}  // namespace

double halo(const GroundOptions& o) { return (surface_reach(surface_options(o)) + 2) * ground_cell; }

GroundChances classify_ground(core::Block& b, size_t own, const GroundOptions& o) {
  GroundChances n;
  core::add_columns(b, {core::Column::classification, core::Column::ground_probability});
  if (own == 0) return n;
  const GroundSurface g = ground_surface(b, surface_options(o));
  std::vector<Verdict> verdicts(b.size(), Verdict::object);
  for (size_t p = 0; p < own; ++p) {
    if (!may_be_ground(b, p)) {
      b.ground_probability[p] = core::is_usable(b, p) ? 0.0F : not_judged;
      continue;
    }
    const RasterSample s = sample(g.height, g.lattice, b.origin.x() + b.x[p], b.origin.y() + b.y[p]);
    if (std::isnan(s.height)) {
      b.ground_probability[p] = 0.0F;
      verdicts[p] = Verdict::no_surface;
      continue;
    }
    const CellIndex c = cell_of(g.lattice, b, p);
    const size_t at = g.lattice.at(c.i, c.j);
    const auto stated = static_cast<float>(probability(
        {b.z[p] - s.height, std::hypot(s.east, s.north), g.spread.value[at], g.standing.value[at], g.sunken.value[at], g.support.value[at]},
        o.noise.value));
    b.ground_probability[p] = stated;
    if (stated >= 0.5F) verdicts[p] = Verdict::ground;
    n.doubtful += stated > 0.25F && stated < 0.75F;
  }
  static_cast<GroundCounts&>(n) = set_ground_classes(b, own, verdicts);
  return n;
}

}  // namespace swath::filters
