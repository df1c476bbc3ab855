// SPDX-License-Identifier: GPL-3.0-or-later
// Two groups share a place, ground and what stands on it (the local false discovery rate of Efron 2004, J. Am. Stat. Assoc. 99): the
// chance of ground is n g(t) / (n g(t) + o(t)), t the height over the surface in spreads.
// n, the number of the ground's returns: those under the surface, doubled, because nothing stands below the ground.
// g: a normal distribution, and for the share of the ground that the surface misses (kerbs, furrows, edges) one as wide as its doubt.
// o, the density of the objects: what is counted in a class of heights beyond what the ground explains. Nothing is assumed of its shape;
// it is the crop or the undergrowth of this very place. Where the ground's own returns would drown it, it is taken as in the classes above.
#include "filters/ground/ground_chance.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "core/floor_div.h"
#include "filters/bins.h"
#include "filters/ground/moving_planes.h"

namespace swath::filters {

namespace {

constexpr double cell = 4.0;   // m: a few dozen returns within the kernel at one return per square metre
constexpr double sigma = 1.5;  // cells: parcels and groups of shrubs are wider
// Classes of height, in spreads.
constexpr std::array<double, 19> edges{0, 0.5, 1, 1.5, 2, 2.5, 3, 3.5, 4, 5, 6, 8, 10, 14, 20, 30, 50, 100, 200};
constexpr int classes = static_cast<int>(edges.size()) - 1;
constexpr int drowned = 4, next_to_drowned = 7;         // classes under 2 spreads; those that stand for them end at 3.5
constexpr double core_of_ground = 2.0;                  // spreads
constexpr double missed = 0.07;                         // share of the ground that the surface misses
constexpr double chance_excess = 0.25;                  // standard deviations of a count that are not taken for objects
constexpr double stray = 0.02, stray_height = 2.0;      // objects per return of the ground that no neighbour shows, over so many m
constexpr double deep_stray = 0.001, deep_range = 3.0;  // the same of low outliers
constexpr double widest_doubt = 200.0;                  // spreads
constexpr double doubt_unit = 16.0;                     // sums are whole numbers, so that their order does not matter

double within(double t) { return std::erf(t * 0.70710678118654752); }
double density(double t) { return 0.79788456080286536 * std::exp(-0.5 * t * t); }  // of |t|

double width(int k) { return edges[static_cast<size_t>(k) + 1] - edges[static_cast<size_t>(k)]; }
double middle(int k) { return 0.5 * (edges[static_cast<size_t>(k) + 1] + edges[static_cast<size_t>(k)]); }

/// Of t > 0.
int class_of(double t) {
  int k = -1;
  for (int e = 0; e < classes; ++e) k += t >= edges[static_cast<size_t>(e)];
  return k;
}

double spread_of(const ReturnOverGround& r) { return r.spread; }
double doubt_of(const ReturnOverGround& r) { return std::min(widest_doubt, std::max(2.0, static_cast<double>(r.doubt) / r.spread)); }

/// Numbers of returns under the kernel around each cell.
struct Counts {
  core::Lattice lattice;
  std::vector<Raster> above;  ///< by class of height
  Raster below, core, deep;
  Raster doubt;  ///< mean, spreads
};

Counts count(const core::Block& b, const core::Lattice& l, const std::vector<ReturnOverGround>& returns) {
  const Raster none(l.nx, l.ny, 0.0F);
  Counts n{l, std::vector<Raster>(classes, none), none, none, none, none};
  Raster all = none;
  for (size_t p = 0; p < b.size(); ++p) {
    const ReturnOverGround& r = returns[p];
    if (std::isnan(r.above)) continue;
    const CellIndex at = cell_of(l, b, p);
    if (!none.holds(at.i, at.j)) continue;
    const size_t c = l.at(at.i, at.j);
    const double t = static_cast<double>(r.above) / spread_of(r);
    if (t > 0) {
      n.above[static_cast<size_t>(class_of(t))].value[c] += 1.0F;
      if (t < core_of_ground) n.core.value[c] += 1.0F;
    } else {
      if (t > -2.0 * core_of_ground) n.below.value[c] += 1.0F;
      if (r.deep) n.deep.value[c] += 1.0F;
    }
    if (std::abs(t) < edges[15]) {
      all.value[c] += 1.0F;
      n.doubt.value[c] += static_cast<float>(core::floor_of(doubt_unit * doubt_of(r) + 0.5));
    }
  }
  for (Raster& r : n.above) r = blur(r, sigma);
  for (Raster* r : {&n.below, &n.core, &n.deep, &n.doubt, &all}) *r = blur(*r, sigma);
  for (size_t c = 0; c < all.value.size(); ++c)
    n.doubt.value[c] = all.value[c] > 0 ? n.doubt.value[c] / (static_cast<float>(doubt_unit) * all.value[c]) : 2.0F;
  return n;
}

/// Ground's returns on one side of the surface.
double ground_of(const Counts& n, size_t c) { return std::max(n.below.value[c], n.core.value[c]); }

std::array<double, classes + 1> within_edges(double spread) {
  std::array<double, classes + 1> shares{};
  for (size_t k = 0; k < shares.size(); ++k) shares[k] = within(edges[k] / spread);
  return shares;
}

/// Objects per spread of height, by class.
using Objects = std::array<float, classes>;

Objects objects_of(const Counts& n, size_t c) {
  static const std::array<double, classes + 1> narrow = within_edges(1.0);  // shares of a normal distribution up to each edge
  const double ground = ground_of(n, c);
  const std::array<double, classes + 1> wide = within_edges(std::max(2.0F, n.doubt.value[c]));
  Objects o{};
  double low = 0.0, low_wide = 0.0;
  for (int k = 0; k < classes; ++k) {
    const auto at = static_cast<size_t>(k);
    const double explained = ground * ((1 - missed) * (narrow[at + 1] - narrow[at]) + missed * (wide[at + 1] - wide[at]));
    const double more = n.above[static_cast<size_t>(k)].value[c] - explained - chance_excess * std::sqrt(explained);
    o[static_cast<size_t>(k)] = static_cast<float>(std::max(0.0, more) / width(k));
    if (k >= drowned && k < next_to_drowned) low += std::max(0.0, more), low_wide += width(k);
  }
  for (int k = 0; k < drowned; ++k) o[static_cast<size_t>(k)] = std::min(o[static_cast<size_t>(k)], static_cast<float>(low / low_wide));
  return o;
}

/// Linear between the classes' middles.
double at_height(const Objects& o, double t) {
  int k = class_of(t);
  if (t < middle(k)) --k;
  if (k < 0) return o[0];
  if (k >= classes - 1) return o[classes - 1];
  const double part = (t - middle(k)) / (middle(k + 1) - middle(k));
  return o[static_cast<size_t>(k)] + part * (o[static_cast<size_t>(k) + 1] - o[static_cast<size_t>(k)]);
}

}  // namespace

const double ground_chance_reach = (reach(sigma) + 1) * cell;

std::vector<float> ground_chances(const core::Block& b, size_t own, const std::vector<ReturnOverGround>& returns) {
  std::vector<float> chance(own, 0.0F);
  if (own == 0) return chance;
  const Counts n = count(b, lattice_around(b, own, cell, 0.0, reach(sigma)), returns);
  std::vector<Objects> objects(n.lattice.size());
  std::vector<char> known(n.lattice.size(), 0);
  for (size_t p = 0; p < own; ++p) {
    const ReturnOverGround& r = returns[p];
    if (std::isnan(r.above)) continue;
    const CellIndex at = cell_of(n.lattice, b, p);
    const size_t c = n.lattice.at(at.i, at.j);
    const double spread = spread_of(r), wide = doubt_of(r), t = std::abs(static_cast<double>(r.above)) / spread, ground = ground_of(n, c);
    double o = 0.0;
    if (r.above > 0) {
      if (!known[c]) objects[c] = objects_of(n, c), known[c] = 1;
      o = at_height(objects[c], t) + stray * ground * spread / stray_height;
    } else {
      o = (n.deep.value[c] + deep_stray * ground) * spread / deep_range;
    }
    const double g = ground * ((1 - missed) * density(t) + missed * density(t / wide) / wide);
    chance[p] = g > 0.0 ? static_cast<float>(g / (g + o)) : 0.0F;
  }
  return chance;
}

}  // namespace swath::filters
