// SPDX-License-Identifier: GPL-3.0-or-later
// A return is judged by its distance from the robust surface (ground_surface.h) against the distance that is bearable at its place: the
// noise and roughness of the ground there and, where returns are sparse, what the surface errs by between them: more on slopes, and a
// leniency for what it smooths away (kerbs, furrows, boulders) that fades where many returns stand knee-high, as in crops and shrubs: there
// the lowest ones alone are ground.
// The probability is counted from the heights of all returns around (ground_chance.h), and what is bearable must have some: a half where
// returns are dense, any where they are sparse and the surface itself is in doubt.
#include "filters/ground.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <vector>

#include "filters/bins.h"
#include "filters/ground_chance.h"
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

GroundSurfaceOptions surface_options(const GroundOptions& o) { return {o.widest.value, std::tan(o.steepest.value), o.noise.value}; }

/// What is known of a return and its place.
struct Evidence {
  double above;     ///< m over the surface
  double slope;     ///< rise / run of the surface
  double spread;    ///< m, standard deviation of the ground's returns around
  double standing;  ///< share of the returns around that stand knee-high
  double sunken;    ///< share of them that lie deep below the surface
  double sparse;    ///< 0 to 1: how little the returns tell of the ground between them
};

/// The error between returns grows with the square of their distance, and that is the inverse of their number; between dense and sparse
/// the square of this share came out best on both simulated and scanned ground. `support`: ground's returns behind the surface.
double sparse_of(double support) { return support > dense ? std::pow(dense / support, 2) : 1.0; }

/// m below the surface.
double deepest(double slope) { return below + below_per_slope * slope; }

/// m from the surface.
double bearable(const Evidence& e, double noise) {
  const double most = (per_spread + (per_spread_sparse - per_spread) * e.sparse) * std::hypot(noise, std::min(e.spread, widest_spread)) +
                      e.sparse * (per_slope * e.slope + leniency * std::exp(-e.standing / fading));
  // A low outlier lies alone; where many lie below, the surface has been drawn over a break.
  if (e.above < 0) return std::min(most, deepest(e.slope)) + sunken_room * std::clamp(e.sunken / sunken_few - 1.0, 0.0, 1.0);
  return most;
}

/// A return beside the surface, and its place there. Nothing where no surface is.
struct Judged {
  ReturnOverGround over;
  Evidence evidence;
};
std::optional<Judged> judge(const core::Block& b, const GroundSurface& g, size_t p) {
  const RasterSample s = sample(g.height, g.lattice, b.origin.x() + b.x[p], b.origin.y() + b.y[p]);
  if (std::isnan(s.height)) return std::nullopt;
  const CellIndex c = cell_of(g.lattice, b, p);
  const size_t at = g.lattice.at(c.i, c.j);
  const double above = b.z[p] - s.height, slope = std::sqrt(s.east * s.east + s.north * s.north), sparse = sparse_of(g.support.value[at]);
  const double spread = std::max<double>(least_spread, g.spread.value[at]);
  const double doubt = std::hypot(2.0 * spread, sparse * (per_slope * slope + leniency));
  return Judged{{static_cast<float>(above), static_cast<float>(spread), static_cast<float>(doubt), above < -deepest(slope)},
                {above, slope, g.spread.value[at], g.standing.value[at], g.sunken.value[at], sparse}};
}

/// Halo points beyond the surface have no influence.
bool within_reach(const core::Lattice& l, const core::Block& b, size_t p) {
  const CellIndex c = cell_of(l, b, p);
  return c.i > 0 && c.j > 0 && c.i < l.nx - 1 && c.j < l.ny - 1;
}

}  // namespace

double halo(const GroundOptions& o) { return std::ceil((surface_reach(surface_options(o)) + 2) * ground_cell + ground_chance_reach); }

GroundChances classify_ground(core::Block& b, size_t own, const GroundOptions& o) {
  GroundChances n;
  core::add_columns(b, {core::Column::classification, core::Column::ground_probability});
  if (own == 0) return n;
  const GroundSurface g = ground_surface(b, own, ground_chance_reach, surface_options(o));
  std::vector<ReturnOverGround> returns(b.size(), {not_judged, 0, 0, false});
  std::vector<Verdict> verdicts(b.size(), Verdict::object);
  std::vector<float> least(own, 2.0F);
  for (size_t p = 0; p < b.size(); ++p) {
    if (!may_be_ground(b, p) || !within_reach(g.lattice, b, p)) continue;
    const std::optional<Judged> j = judge(b, g, p);
    if (j) returns[p] = j->over;
    if (p >= own) continue;
    if (!j)
      verdicts[p] = Verdict::no_surface;
    else if (std::abs(j->evidence.above) <= bearable(j->evidence, o.noise.value))
      least[p] = static_cast<float>(0.5 * std::pow(1.0 - j->evidence.sparse, 2));
  }
  const std::vector<float> chances = ground_chances(b, own, returns);
  for (size_t p = 0; p < own; ++p) {
    b.ground_probability[p] = core::is_usable(b, p) ? chances[p] : not_judged;
    if (chances[p] >= least[p] && !std::isnan(returns[p].above)) verdicts[p] = Verdict::ground;
    n.doubtful += chances[p] > 0.25F && chances[p] < 0.75F;
  }
  static_cast<GroundCounts&>(n) = set_ground_classes(b, own, verdicts);
  return n;
}

}  // namespace swath::filters
