// SPDX-License-Identifier: GPL-3.0-or-later
// Contours of a made surface as a map would have them.
#pragma once

#include "terrain/contours/contour_lines.h"
#include "terrain/contours/map_surface.h"
#include "tests/terrain/made.h"

namespace swath::test {

inline terrain::MapContent map_of(const Surface& surface, const core::Lattice& fine, double interval) {
  terrain::ContourOptions o;
  o.interval = core::Metres(interval);
  o.tolerance = core::Metres(0.0);
  const core::Grid g = sampled(fine, surface);
  terrain::MapContent out;
  for (const terrain::ContourLine& l : terrain::join(terrain::trace(g, g.lattice, o), o)) {
    terrain::MapLine line{{}, true, "map"};
    for (const Eigen::Vector2d& v : l.vertices) line.vertices.emplace_back(v.x(), v.y(), terrain::level_height(o, l.level));
    out.lines.push_back(std::move(line));
  }
  return out;
}

/// Rms of heights less the surface over the cells that `counts` takes, and how many they are.
inline std::pair<double, size_t> rms_over(const core::Grid& g, const Surface& surface, const std::function<bool(size_t)>& counts) {
  double sum = 0.0;
  size_t n = 0;
  for (int j = 0; j < g.lattice.ny; ++j)
    for (int i = 0; i < g.lattice.nx; ++i) {
      const size_t c = g.lattice.at(i, j);
      if (!std::isfinite(g.height[c]) || !counts(c)) continue;
      const double e = static_cast<double>(g.height[c]) - surface(g.lattice.centre_x(i), g.lattice.centre_y(j));
      sum += e * e, ++n;
    }
  return {std::sqrt(sum / static_cast<double>(std::max<size_t>(n, 1))), n};
}

}  // namespace swath::test
