// SPDX-License-Identifier: GPL-3.0-or-later
// What quality.swath finds, and the files that it leaves of it.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/picture.h"
#include "quality/overlap_cells.h"
#include "quality/void_areas.h"
#include "stages/stage.h"

namespace swath::stages {

/// One flight line by itself.
struct SwathLineFound {
  int line = 0;
  double rms = std::numeric_limits<double>::quiet_NaN(), hard = rms, even = rms;
  std::uint64_t smooth_cells = 0;
};

template <class V>
void describe(const SwathLineFound& r, V& v) {
  using core::metres;
  v.result("line", r.line, "Number of the flight line.");
  v.result("smooth_cells", r.smooth_cells, "Level cells whose single returns fit a plane.");
  v.result("repeatability_m", r.rms, metres(4), "Scatter of a return about those planes, rms: grass is in it.");
  v.result("hard_m", r.hard, metres(4), "The same of the smoothest quarter of the cells: roads, car parks, roofs.");
  v.result("even", r.even, core::share(), "Share of cells of twice the pulse spacing with a first return of this line.");
}

struct SwathFindings {
  std::string quality_level = "none";
  quality::PulseSpacing spacing{};
  std::string spacing_from;
  std::optional<std::string> no_voids{};
  double cell = 0.0;
  quality::SwathPair all{};
  std::vector<quality::SwathPair> pairs{};
  std::vector<SwathLineFound> lines{};
  double hard = std::numeric_limits<double>::quiet_NaN(), even = hard;
  std::vector<double> bins{}, bin_cells{};
  quality::SwathVoids voids{};

  void set_overlaps(const quality::SwathOverlaps& o);
  /// Behind set_overlaps().
  void set_even(const std::vector<quality::EvenCells>& of_all_tiles);
  size_t count(bool water) const;
  double largest(bool water) const;  ///< m2
  std::vector<quality::VoidArea> largest_voids() const;
};

template <class V>
void describe(const SwathFindings& r, V& v) {
  using core::metres;
  v.result("quality_level", r.quality_level, "The level that is judged by.");
  v.result("anps_m", r.spacing.rule, metres(3), "Pulse spacing that voids and distribution are judged by.");
  v.result("anps_from", r.spacing_from, "quality level, stated or measured.");
  v.result("cell_m", r.cell, metres(2), "Side of the cells in which lines are compared.");
  v.result("hard_m", r.hard, metres(4).in_summary(), "Scatter of one line on smooth hard ground (intraswath), rms of the lines.");
  v.result("overlap_cells", r.all.cells, "Smooth level cells that two lines see, over all pairs.");
  v.result("overlap_rms_m", r.all.rms, metres(4).in_summary().limited_by("overlap_difference").only_if(r.all.cells > 0),
           "Difference of overlapping lines on smooth level ground (interswath), rms of all pairs.");
  v.result("overlap_q95_m", r.all.q95, metres(4).only_if(r.all.cells > 0), "95 % of its absolute values are smaller.");
  v.result("overlap_over_sigma", r.all.error_over_sigma, core::plain().only_if(r.all.predicted > 0.0),
           "overlap_rms_m over what the points' own sigmas predict; 1 where they are true.");
  v.result("no_voids", r.no_voids, core::plain().in_summary(), "Why neither the distribution nor voids are judged.");
  v.result("even", r.even, core::share().in_summary(), "Share of cells of twice the pulse spacing with a first return of any line.");
  const bool judged = !r.no_voids;
  v.result("judged_km2", 1e-6 * r.voids.judged, core::plain().only_if(judged),
           "Area in which voids are looked for: the survey without its rim.");
  v.result("least_void_m2", r.voids.least, core::plain().only_if(judged), "Area from which on a void counts: (4 ANPS)^2.");
  v.result("voids", static_cast<std::uint64_t>(r.count(false)), core::plain().in_summary().only_if(judged), "Voids apart from water.");
  v.result("void_m2", r.voids.area, core::plain().in_summary().only_if(judged), "Their area.");
  v.result("void_share", r.voids.judged > 0.0 ? r.voids.area / r.voids.judged : 0.0, core::share().limited_by("void_share").only_if(judged),
           "Their share of the judged area.");
  v.result("largest_void_m2", r.largest(false), core::plain().only_if(judged), "The largest of them.");
  v.result("water_voids", static_cast<std::uint64_t>(r.count(true)), core::plain().only_if(judged), "Voids that are water.");
  v.result("water_void_m2", r.voids.water_area, core::plain().only_if(judged), "Their area.");
  v.tables("largest", r.largest_voids(), "The ten largest voids, water or not.");
  v.tables("pairs", r.pairs, "Pairs of overlapping flight lines on smooth level cells.");
  v.tables("lines", r.lines, "Flight lines by themselves.");
  v.result("bins_m", r.bins, "Middles of bins of 5 mm of the differences of all pairs.");
  v.result("bin_cells", r.bin_cells, "Cells in each bin.");
}

/// swath.json, and swath.gpkg with the layers voids and pairs.
void write_swath_files(const Context& context, const SwathFindings& found);

/// Where cells of twice the pulse spacing hold first returns, with the outlines of voids; `even`: share of such cells.
core::Picture distribution_map(const core::Grid& even, const quality::SwathVoids& voids);

}  // namespace swath::stages
