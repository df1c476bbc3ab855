// SPDX-License-Identifier: GPL-3.0-or-later
#include "stages/adapters/quality/swath_files.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "core/config/result_visitors.h"
#include "io/text/output_file.h"
#include "io/text/value_file.h"
#include "io/vector/feature_layers.h"
#include "quality/pulse_density.h"
#include "report/value_map.h"

namespace swath::stages {
namespace {

constexpr size_t voids_listed = 10;
constexpr size_t outlines_drawn = 300;  // of the largest voids

io::FeatureLayer voids_layer(const Context& context, const quality::SwathVoids& voids) {
  io::FeatureLayer layer{"voids",
                         "Areas without a first return, larger than (4 ANPS)^2; area in square metres",
                         io::FeatureShape::polygon,
                         {"kind", "water_by"},
                         {"area_m2"},
                         {}};
  for (const quality::VoidArea& v : voids.voids) {
    io::Feature f{v.rings, {v.is_water() ? "water" : "void", v.evidence()}, {v.area}};
    for (auto& ring : f.parts)
      for (Eigen::Vector2d& corner : ring) corner /= context.unit;
    layer.features.push_back(std::move(f));
  }
  return layer;
}

io::FeatureLayer pairs_layer(const Context& context, const std::vector<quality::SwathPair>& pairs, double cell) {
  io::FeatureLayer layer{"pairs",
                         "Overlaps of two flight lines, box around the compared cells; differences line_a minus line_b in metres",
                         io::FeatureShape::polygon,
                         {"pair"},
                         {"line_a", "line_b", "cells", "mean_m", "median_m", "rms_m", "q95_m", "predicted_m", "error_over_sigma"},
                         {}};
  for (const quality::SwathPair& p : pairs) {
    const double w = (p.west - 0.5 * cell) / context.unit, s = (p.south - 0.5 * cell) / context.unit,
                 e = (p.east + 0.5 * cell) / context.unit, n = (p.north + 0.5 * cell) / context.unit;
    layer.features.push_back({{{{w, s}, {e, s}, {e, n}, {w, n}}},
                              {std::to_string(p.line_a) + " - " + std::to_string(p.line_b)},
                              {static_cast<double>(p.line_a), static_cast<double>(p.line_b), static_cast<double>(p.cells), p.mean, p.median,
                               p.rms, p.q95, p.predicted, p.error_over_sigma}});
  }
  return layer;
}

}  // namespace

void SwathFindings::set_overlaps(const quality::SwathOverlaps& o) {
  all = o.all;
  pairs = o.pairs;
  hard = o.hard;
  bins = o.bins;
  bin_cells = o.bin_cells;
  for (const quality::SwathLine& l : o.lines) lines.push_back({l.line, l.rms, l.hard, std::nan(""), l.cells});
}

void SwathFindings::set_even(const std::vector<quality::EvenCells>& of_all_tiles) {
  std::map<int, quality::EvenCells> sums;
  for (const quality::EvenCells& e : of_all_tiles) sums[e.line].cells += e.cells, sums[e.line].hit += e.hit;
  for (const auto& [line, e] : sums) {
    const double share = static_cast<double>(e.hit) / static_cast<double>(e.cells);  // not a number without cells
    if (line == quality::all_lines) {
      even = share;
      continue;
    }
    auto at = std::find_if(lines.begin(), lines.end(), [line = line](const SwathLineFound& l) { return l.line == line; });
    if (at == lines.end()) at = lines.insert(lines.end(), SwathLineFound{line});
    at->even = share;
  }
  std::sort(lines.begin(), lines.end(), [](const auto& a, const auto& b) { return a.line < b.line; });
}

size_t SwathFindings::count(bool water) const {
  return static_cast<size_t>(std::count_if(voids.voids.begin(), voids.voids.end(), [&](const auto& v) { return v.is_water() == water; }));
}

double SwathFindings::largest(bool water) const {
  double out = 0.0;
  for (const quality::VoidArea& v : voids.voids)
    if (v.is_water() == water) out = std::max(out, v.area);
  return out;
}

std::vector<quality::VoidArea> SwathFindings::largest_voids() const {
  return {voids.voids.begin(), voids.voids.begin() + static_cast<std::ptrdiff_t>(std::min(voids.voids.size(), voids_listed))};
}

void write_swath_files(const Context& context, const SwathFindings& found) {
  io::write_text_file(context.output / "swath.json", io::to_json(core::reported(found)));
  io::write_feature_layers(context.output / "swath.gpkg",
                           {voids_layer(context, found.voids), pairs_layer(context, found.pairs, found.cell)}, context.product_crs);
}

core::Picture distribution_map(const core::Grid& even, const quality::SwathVoids& voids) {
  std::vector<report::MapLine> lines;
  for (const quality::VoidArea& v : voids.voids) {
    if (lines.size() >= outlines_drawn) break;
    report::MapLine line;
    for (size_t k = 0; k <= v.rings[0].size(); ++k) {
      line.x.push_back(v.rings[0][k % v.rings[0].size()].x());
      line.y.push_back(v.rings[0][k % v.rings[0].size()].y());
    }
    line.width = 1.5;
    lines.push_back(std::move(line));
  }
  report::ValueMapOptions look;
  look.title = "Cells of twice the pulse spacing with a first return; voids outlined";
  look.low = 0.0;
  look.high = 1.0;
  look.void_name = "rim, voids, outside";
  return report::draw(report::value_map(even.lattice, even.height, lines, look));
}

}  // namespace swath::stages
