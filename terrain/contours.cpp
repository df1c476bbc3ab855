// SPDX-License-Identifier: GPL-3.0-or-later
// Marching squares on the lattice of cell centres. A centre exactly on a level counts as above it (as if it were higher by an
// infinitesimal), so every square edge is crossed or not, never touched, and every vertex joins exactly two segments. Vertices lie where
// linear interpolation along the edge meets the level; off the edges the line departs from the bilinear surface's own contour (a
// hyperbola) by at most the square's twist |h00 - h10 - h01 + h11| / 4 in height.
#include "terrain/contours.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <type_traits>

namespace swath::terrain {
namespace {

static_assert(std::is_trivially_copyable_v<Segment> && sizeof(Segment) == 88, "segments are stored as they are");

/// Four neighbouring centres, counter-clockwise from the south-west: corners 0..3, edge k from corner k to corner k + 1.
struct Square {
  const core::Lattice& lattice;
  int i, j;  // of the south-west cell
  std::array<double, 4> h;

  EdgeKey key(int edge) const {
    const std::int64_t si = lattice.i0 + i, sj = lattice.j0 + j;
    switch (edge) {
      case 0:
        return {si, sj, 0};
      case 1:
        return {si + 1, sj, 1};
      case 2:
        return {si, sj + 1, 0};
      default:
        return {si, sj, 1};
    }
  }
  // Where the level crosses an edge: always from its western or southern end, so both squares of the edge get the same bits.
  void place(int edge, double level, double& x, double& y) const {
    const bool forward = edge < 2;
    const double a = forward ? h[edge] : h[(edge + 1) % 4], b = forward ? h[(edge + 1) % 4] : h[edge];
    const double t = std::clamp((level - a) / (b - a), 0.0, 1.0);
    const EdgeKey k = key(edge);
    x = (static_cast<double>(k.i) + (k.axis == 0 ? 0.5 + t : 0.5)) * lattice.cell;
    y = (static_cast<double>(k.j) + (k.axis == 1 ? 0.5 + t : 0.5)) * lattice.cell;
  }
};

void trace_level(const Square& s, std::int64_t level, double height, std::vector<Segment>& out) {
  std::array<bool, 4> above{};
  for (size_t k = 0; k < 4; ++k) above[k] = s.h[k] >= height;
  // Going round counter-clockwise, a line with high ground on its left enters where the border steps down and leaves where it steps up.
  std::array<int, 2> down{}, up{};
  int n_down = 0, n_up = 0;
  for (int k = 0; k < 4; ++k) {
    if (above[k] && !above[(k + 1) % 4]) down[n_down++] = k;
    if (!above[k] && above[(k + 1) % 4]) up[n_up++] = k;
  }
  const auto emit = [&](int from, int to) {
    Segment g;
    g.level = level;
    g.from = s.key(from);
    g.to = s.key(to);
    s.place(from, height, g.from_x, g.from_y);
    s.place(to, height, g.to_x, g.to_y);
    out.push_back(g);
  };
  if (n_down == 1) return emit(down[0], up[0]);
  if (n_down != 2) return;
  const bool centre_above = 0.25 * ((s.h[0] + s.h[1]) + (s.h[2] + s.h[3])) >= height;
  // High ground joined through the centre: each line cuts off the low corner that begins at its entry; otherwise the high corner that
  // ends there.
  for (int n = 0; n < 2; ++n) emit(down[n], centre_above ? (down[n] + 1) % 4 : (down[n] + 3) % 4);
}

}  // namespace

std::vector<Segment> trace(const core::Grid& grid, const core::Lattice& own, const ContourOptions& options) {
  const core::Lattice& l = grid.lattice;
  std::vector<Segment> out;
  const int i_first = static_cast<int>(std::max<std::int64_t>(0, own.i0 - l.i0)),
            j_first = static_cast<int>(std::max<std::int64_t>(0, own.j0 - l.j0));
  const int i_end = static_cast<int>(std::min<std::int64_t>(l.nx - 1, own.i0 + own.nx - l.i0));
  const int j_end = static_cast<int>(std::min<std::int64_t>(l.ny - 1, own.j0 + own.ny - l.j0));
  for (int j = j_first; j < j_end; ++j)
    for (int i = i_first; i < i_end; ++i) {
      const Square s{
          l, i, j, {grid.height[l.at(i, j)], grid.height[l.at(i + 1, j)], grid.height[l.at(i + 1, j + 1)], grid.height[l.at(i, j + 1)]}};
      if (std::isnan(s.h[0] + s.h[1] + s.h[2] + s.h[3])) continue;
      const auto [low, high] = std::minmax({s.h[0], s.h[1], s.h[2], s.h[3]});
      // One level early, so that rounding of the division cannot lose one; the comparison below is exact.
      for (auto k = static_cast<std::int64_t>(std::floor((low - options.base.value) / options.interval.value)) - 1;; ++k) {
        const double height = level_height(options, k);
        if (height > high) break;
        if (height > low) trace_level(s, k, height, out);
      }
    }
  std::sort(out.begin(), out.end());
  return out;
}

}  // namespace swath::terrain
