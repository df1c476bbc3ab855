// SPDX-License-Identifier: GPL-3.0-or-later
// A return is judged by its distance from the robust surface (ground_surface.h), by the heights of all returns around (ground_chance.h) and
// by those nearest to it. One probability is made of them (ground_probability.h), and ground is what has at least a half.
// Where the returns are two populations, soil and a low crop that drew the surface up, the ground is the lower one (ground_populations.h).
#include "filters/ground/ground.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <vector>

#include "filters/bins.h"
#include "filters/ground/ground_chance.h"
#include "filters/ground/ground_populations.h"
#include "filters/ground/ground_surface.h"

namespace swath::filters {
namespace {

constexpr float not_judged = std::numeric_limits<float>::quiet_NaN();
constexpr double least_spread = 0.01;  // m: below what ranges are recorded to
constexpr double inflated = 1.5;       // of the lower population's spread: the surface's where it lies between two

GroundSurfaceOptions surface_options(const GroundOptions& o) {
  return {o.widest.value, o.longest.value, std::tan(o.steepest.value), o.noise.value};
}

/// A point in cell `at` beside the surface; above NaN where no surface is.
GroundEvidence beside(const GroundSurface& g, const core::Block& b, size_t p, size_t at) {
  const RasterSample s = sample(g.height, g.lattice, b.origin.x() + b.x[p], b.origin.y() + b.y[p]);
  return {.above = static_cast<float>(b.z[p] - s.height),
          .spread = g.spread.value[at],
          .slope = static_cast<float>(std::sqrt(s.east * s.east + s.north * s.north)),
          .standing = g.standing.value[at],
          .sunken = g.sunken.value[at],
          .support = g.support.value[at],
          .splitting = 0.0F,
          .nearest = {}};
}

ReturnOverGround judged(const GroundEvidence& e) {
  const double spread = std::max<double>(least_spread, e.spread);
  const double off = sparse_error(e.slope, 0.0, sparseness(e.support));
  const double doubt = std::sqrt(4.0 * spread * spread + off * off);
  return {e.above, static_cast<float>(spread), static_cast<float>(doubt), e.above < -deepest_ground(e.slope)};
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

// m about the own points in which returns are judged.
double judged_around() { return std::max(ground_chance_reach + ground_populations_reach, ground_probability_reach); }

/// The points of `rows`, with the columns that are looked at.
core::Block points_of(const core::Block& b, const std::vector<std::uint32_t>& rows) {
  core::Block out;
  out.origin = b.origin;
  const auto take = [&](const auto& from, auto& to) {
    if (from.empty()) return;
    to.resize(rows.size());
    for (size_t k = 0; k < rows.size(); ++k) to[k] = from[rows[k]];
  };
  take(b.x, out.x), take(b.y, out.y), take(b.z, out.z);
  take(b.return_number, out.return_number), take(b.return_count, out.return_count), take(b.strip, out.strip);
  take(b.flags, out.flags), take(b.classification, out.classification);
  return out;
}

/// Of the own points; `b` holds what lies near them.
std::vector<GroundEvidence> evidence_on(const core::Block& b, size_t own, GroundBase base, const GroundOptions& o) {
  const GroundSurface g = ground_surface(b, std::move(base), surface_options(o));
  GroundEvidence unknown;
  unknown.above = not_judged;
  std::vector<GroundEvidence> evidence(own, unknown);
  // Points farther from the own ones have no influence.
  const core::Lattice l = grown(lattice_around(b, own, ground_cell, judged_around(), 0), 0, grown(g.lattice, -1, g.lattice));
  std::vector<ReturnOverGround> returns(b.size(), {not_judged, 0, 0, false});
  for (size_t p = 0; p < b.size(); ++p) {
    if (!may_be_ground(b, p)) continue;
    const CellIndex c = cell_of(l, b, p);
    if (!l.holds(c.i, c.j)) continue;
    const GroundEvidence e =
        beside(g, b, p, g.lattice.at(c.i + static_cast<int>(l.i0 - g.lattice.i0), c.j + static_cast<int>(l.j0 - g.lattice.j0)));
    if (!std::isnan(e.above)) returns[p] = judged(e);
    if (p < own) evidence[p] = e;
  }
  std::vector<float> above(b.size());
  for (size_t p = 0; p < b.size(); ++p) above[p] = returns[p].above;
  const LowerPopulations lower = lower_populations(b, own, ground_chance_reach, returns, o.noise.value);
  for (size_t p = 0; p < b.size(); ++p) {
    if (std::isnan(returns[p].above)) continue;
    move_to_lower(returns[p], lower, b, p);
    if (p >= own) continue;
    GroundEvidence& e = evidence[p];
    e.lowered = returns[p].above - e.above;
    e.narrowed = e.lowered > 0 ? returns[p].spread : e.spread;
  }
  {
    const std::vector<float> chances = ground_chances(b, own, returns);
    for (size_t p = 0; p < own; ++p) evidence[p].chance = chances[p];
  }
  std::vector<ReturnOverGround>().swap(returns);
  look_around(b, above, evidence);
  return evidence;
}

}  // namespace

double halo(const GroundOptions& o) { return std::ceil((surface_reach(surface_options(o)) + 2) * ground_cell + judged_around()); }

double rim(const GroundOptions& o) { return (coarse_ground_rim(surface_options(o)) + 1) * ground_cell; }

double near_halo(const GroundOptions&) { return std::ceil(judged_around() + (fine_surface_reach() + 1) * ground_cell); }

std::vector<std::uint32_t> needed_around(const core::Block& b, const Bounds& tile, const GroundOptions& o) {
  std::vector<std::uint32_t> rows;
  if (b.size() == 0) return rows;
  const double near = near_halo(o);
  const core::Lattice l = lattice_around(b, ground_cell, 0);
  constexpr std::uint32_t none = std::numeric_limits<std::uint32_t>::max();
  std::vector<std::uint32_t> lowest(l.size(), none);
  std::vector<std::uint8_t> needed(b.size(), 0);
  for_each_cell(b, l, [&](size_t p, std::int32_t i, std::int32_t j, bool may) {
    const double x = b.origin.x() + b.x[p], y = b.origin.y() + b.y[p];
    if (x >= tile.west - near && x < tile.east + near && y >= tile.south - near && y < tile.north + near) {
      needed[p] = 1;
    } else if (may && b.z[p] == b.z[p]) {
      std::uint32_t& row = lowest[l.at(i, j)];
      if (row == none || b.z[p] < b.z[row]) row = static_cast<std::uint32_t>(p);
    }
  });
  for (const std::uint32_t row : lowest)
    if (row != none) needed[row] = 1;
  for (size_t p = 0; p < needed.size(); ++p)
    if (needed[p]) rows.push_back(static_cast<std::uint32_t>(p));
  return rows;
}

namespace {

/// Rows of the first `own` points that may be ground and have another such point within `beside` cells of 10 m. Where a return is alone
/// nothing distinguishes ground from objects.
std::vector<std::uint32_t> in_company(const core::Block& b, size_t own) {
  constexpr double side = 10.0;  // m
  constexpr int beside = 3;
  const core::Lattice l = lattice_around(b, side, beside);
  std::vector<std::uint32_t> count(l.size(), 0), rows;
  for_each_cell(b, l, [&](size_t, std::int32_t i, std::int32_t j, bool may) { count[l.at(i, j)] += may; });
  for (size_t p = 0; p < own; ++p) {
    if (!may_be_ground(b, p)) continue;
    const CellIndex at = cell_of(l, b, p);
    bool others = count[l.at(at.i, at.j)] > 1;
    for (int j = at.j - beside; j <= at.j + beside && !others; ++j)
      for (int i = at.i - beside; i <= at.i + beside && !others; ++i) others = (i != at.i || j != at.j) && count[l.at(i, j)] > 0;
    if (others) rows.push_back(static_cast<std::uint32_t>(p));
  }
  return rows;
}

/// Few rows in groups farther apart than `apart` (m).
std::vector<std::vector<std::uint32_t>> groups_of(const core::Block& b, std::vector<std::uint32_t> rows, double apart) {
  std::vector<std::vector<std::uint32_t>> groups;
  while (!rows.empty()) {
    std::vector<std::uint32_t> group{rows.back()};
    rows.pop_back();
    for (size_t k = 0; k < group.size(); ++k) {
      const auto near = std::stable_partition(
          rows.begin(), rows.end(), [&](std::uint32_t r) { return std::hypot(b.x[r] - b.x[group[k]], b.y[r] - b.y[group[k]]) > apart; });
      group.insert(group.end(), near, rows.end());
      rows.erase(near, rows.end());
    }
    groups.push_back(std::move(group));
  }
  return groups;
}

std::vector<GroundEvidence> evidence_of(const core::Block& b, size_t own, const GroundOptions& o, std::vector<RaisedSurface>& raised) {
  GroundBase base = ground_base(b, own, judged_around(), surface_options(o));
  raised.insert(raised.end(), base.raised.begin(), base.raised.end());
  const core::Block near = own < b.size() ? points_of(b, base.rows) : core::Block{};
  std::vector<std::uint32_t>().swap(base.rows);
  return evidence_on(own < b.size() ? near : b, own, std::move(base), o);
}

/// Of the rows of one group, in its order, from the points within the halo alone.
std::vector<GroundEvidence> evidence_of(const core::Block& b, const std::vector<std::uint32_t>& group, const GroundOptions& o,
                                        std::vector<RaisedSurface>& raised) {
  const OwnBox around(core::select(b, group), group.size(), halo(o));
  std::vector<std::uint8_t> taken(b.size(), 0);
  for (const std::uint32_t p : group) taken[p] = 1;
  std::vector<std::uint32_t> rows = group;
  for (std::uint32_t p = 0; p < b.size(); ++p)
    if (!taken[p] && around.holds(b, p)) rows.push_back(p);
  return evidence_of(core::select(b, rows), group.size(), o, raised);
}

/// Are these rows so few and so far apart that groups of them take less than one surface over all?
bool is_scattered(const core::Block& b, const std::vector<std::uint32_t>& rows, const GroundOptions& o) {
  constexpr size_t few = 64;
  if (rows.size() > few) return false;
  const core::Lattice l = lattice_around(b, halo(o), 0);
  return static_cast<double>(l.size()) > 6.0 * static_cast<double>(rows.size());
}

/// As ground_evidence().
std::vector<GroundEvidence> evidence_and_raised(const core::Block& b, size_t own, const GroundOptions& o,
                                                std::vector<RaisedSurface>& raised) {
  GroundEvidence unknown;
  unknown.above = not_judged;
  if (own == 0) return {};
  std::vector<std::uint32_t> judged = in_company(b, own);
  if (is_scattered(b, judged, o)) {
    std::vector<GroundEvidence> evidence(own, unknown);
    for (const std::vector<std::uint32_t>& group : groups_of(b, judged, halo(o))) {
      const std::vector<GroundEvidence> found = evidence_of(b, group, o, raised);
      for (size_t k = 0; k < group.size(); ++k) evidence[group[k]] = found[k];
    }
    return evidence;
  }
  std::vector<bool> is_judged(own, false);
  for (const std::uint32_t p : judged) is_judged[p] = true;
  std::vector<std::uint32_t>().swap(judged);
  std::vector<GroundEvidence> evidence = evidence_of(b, own, o, raised);
  for (size_t p = 0; p < own; ++p)
    if (!is_judged[p]) evidence[p] = unknown;
  return evidence;
}

}  // namespace

std::vector<GroundEvidence> ground_evidence(const core::Block& b, size_t own, const GroundOptions& o) {
  std::vector<RaisedSurface> raised;
  return evidence_and_raised(b, own, o, raised);
}

GroundChances classify_ground(core::Block& b, size_t own, const GroundOptions& o) {
  GroundChances n;
  core::add_columns(b, {core::Column::classification, core::Column::ground_probability});
  if (own == 0) return n;
  const std::vector<GroundEvidence> evidence = evidence_and_raised(b, own, o, n.raised);
  std::vector<Verdict> verdicts(b.size(), Verdict::object);
  for (size_t p = 0; p < own; ++p) {
    const GroundEvidence& e = evidence[p];
    b.ground_probability[p] = core::is_usable(b, p) ? ground_probability(e, o.noise.value, o.grass) : not_judged;
    n.doubtful += b.ground_probability[p] > 0.25F && b.ground_probability[p] < 0.75F;
    if (!may_be_ground(b, p)) continue;
    if (std::isnan(e.above))
      verdicts[p] = Verdict::no_surface;
    else if (b.ground_probability[p] >= 0.5F)
      verdicts[p] = Verdict::ground;
  }
  static_cast<GroundCounts&>(n) = set_ground_classes(b, own, verdicts);
  return n;
}

}  // namespace swath::filters
