// SPDX-License-Identifier: GPL-3.0-or-later
// Contours of a surface of triangles: the squares of four cell centres, each cut at its middle. A node exactly on a level counts as above
// it (as if it were higher by an infinitesimal), so every edge is crossed or not, never touched, and every vertex joins exactly two
// segments. Off the lattice's own edges the triangles depart from the bilinear surface by at most the square's twist
// |h00 - h10 - h01 + h11| / 16; squares traced without their middle would depart by a quarter of it.
//
// Vertices lie where linear interpolation along the edge meets the level, but for those within `squeeze` of an edge's end: there the
// interpolation is squeezed to half, so that lines through one node do not touch in it. That moves a vertex by at most 1e-4 of an edge.
#include "terrain/contours/contours.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <type_traits>

namespace swath::terrain {
namespace {

static_assert(std::is_trivially_copyable_v<Segment> && sizeof(Segment) == 88, "segments are stored as they are");

constexpr double squeeze = 2e-4;  // share of an edge

/// Where between heights a and b the level lies: strictly between 0 and 1 and in the order of the levels.
double share_of(double level, double a, double b) {
  const double t = std::clamp((level - a) / (b - a), 0.0, 1.0);
  if (t < squeeze) return 0.5 * (squeeze + t);
  if (t > 1.0 - squeeze) return 1.0 - 0.5 * (squeeze + (1.0 - t));
  return t;
}

/// Four neighbouring centres, counter-clockwise from the south-west, and the middle: nodes 0 to 3 and 4. Edges 0 to 3 run from corner k to
/// corner k + 1, edges 4 to 7 from corner k - 4 to the middle.
struct Square {
  const core::Lattice& lattice;
  int i, j;  // of the south-west cell
  std::array<double, 5> h;

  EdgeKey key(int edge) const {
    const std::int64_t si = lattice.i0 + i, sj = lattice.j0 + j;
    switch (edge) {
      case 0:
        return {si, sj, 0};
      case 1:
        return {si + 1, sj, 1};
      case 2:
        return {si, sj + 1, 0};
      case 3:
        return {si, sj, 1};
      default:
        return {si, sj, edge - 2};
    }
  }
  // Where the level crosses an edge: always from its western, southern or outer end, so both triangles of the edge get the same bits.
  void place(int edge, double level, double& x, double& y) const {
    const EdgeKey k = key(edge);
    double u = static_cast<double>(k.i), v = static_cast<double>(k.j);
    if (edge < 4) {
      const bool forward = edge < 2;
      const double a = forward ? h[edge] : h[(edge + 1) % 4], b = forward ? h[(edge + 1) % 4] : h[edge];
      const double t = share_of(level, a, b);
      u += k.axis == 0 ? 0.5 + t : 0.5;
      v += k.axis == 1 ? 0.5 + t : 0.5;
    } else {
      const int corner = edge - 4;
      const double t = 0.5 * share_of(level, h[corner], h[4]);
      u += corner == 1 || corner == 2 ? 1.5 - t : 0.5 + t;
      v += corner >= 2 ? 1.5 - t : 0.5 + t;
    }
    x = u * lattice.cell;
    y = v * lattice.cell;
  }
};

void trace_level(const Square& s, std::int64_t level, double height, std::vector<Segment>& out) {
  std::array<bool, 5> above{};
  for (size_t k = 0; k < 5; ++k) above[k] = s.h[k] >= height;
  for (int k = 0; k < 4; ++k) {
    // Going round a triangle counter-clockwise, a line with high ground on its left enters where the border steps down and leaves where it
    // steps up.
    const int next = (k + 1) % 4;
    const std::array<int, 3> node{k, next, 4}, edge{k, 4 + next, 4 + k};
    int from = -1, to = -1;
    for (int n = 0; n < 3; ++n) {
      const bool here = above[node[n]], there = above[node[(n + 1) % 3]];
      if (here && !there) from = edge[n];
      if (!here && there) to = edge[n];
    }
    if (from < 0) continue;
    Segment g;
    g.level = level;
    g.from = s.key(from);
    g.to = s.key(to);
    s.place(from, height, g.from_x, g.from_y);
    s.place(to, height, g.to_x, g.to_y);
    out.push_back(g);
  }
}

}  // namespace

std::optional<double> square_metres(const std::string& text) {
  double number = 0.0;
  const auto [end, fault] = std::from_chars(text.data(), text.data() + text.size(), number);
  if (fault != std::errc{} || !(number >= 0.0) || !std::isfinite(number)) return std::nullopt;
  std::string unit(end, text.data() + text.size());
  unit.erase(0, unit.find_first_not_of(' '));
  constexpr double foot = 0.3048;
  if (unit == "m2") return number;
  if (unit == "ft2") return number * foot * foot;
  if (unit == "ha") return number * 1e4;
  return std::nullopt;
}

std::vector<Segment> trace(const core::Grid& grid, const core::Lattice& own, const ContourOptions& options) {
  const core::Lattice& l = grid.lattice;
  std::vector<Segment> out;
  const int i_first = static_cast<int>(std::max<std::int64_t>(0, own.i0 - l.i0)),
            j_first = static_cast<int>(std::max<std::int64_t>(0, own.j0 - l.j0));
  const int i_end = static_cast<int>(std::min<std::int64_t>(l.nx - 1, own.i0 + own.nx - l.i0));
  const int j_end = static_cast<int>(std::min<std::int64_t>(l.ny - 1, own.j0 + own.ny - l.j0));
  for (int j = j_first; j < j_end; ++j)
    for (int i = i_first; i < i_end; ++i) {
      Square s{l,
               i,
               j,
               {grid.height[l.at(i, j)], grid.height[l.at(i + 1, j)], grid.height[l.at(i + 1, j + 1)], grid.height[l.at(i, j + 1)], 0.0}};
      s.h[4] = 0.25 * ((s.h[0] + s.h[1]) + (s.h[2] + s.h[3]));
      if (std::isnan(s.h[4])) continue;
      const auto [low, high] = std::minmax({s.h[0], s.h[1], s.h[2], s.h[3]});
      // One level early, so that rounding of the division cannot lose one; the comparison below is exact.
      for (auto k = static_cast<std::int64_t>(std::floor((low - options.base.value) / interval_of(options))) - 1;; ++k) {
        const double height = level_height(options, k);
        if (height > high) break;
        if (height > low) trace_level(s, k, height, out);
      }
    }
  std::sort(out.begin(), out.end());
  return out;
}

}  // namespace swath::terrain
