// SPDX-License-Identifier: GPL-3.0-or-later
// What the tests of contours share: a grid as a surface, and whether lines meet, decided exactly.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <utility>
#include <vector>

#include "terrain/contours/contour_lines.h"
#include "terrain/contours/facets.h"

namespace swath::test {

/// The whole of a grid, read by windows as a run does.
inline terrain::Facets facets_of(const core::Grid& g) {
  return terrain::Facets(g.lattice.cell, [&g](const core::Lattice& window) {
    core::Grid out(window);
    for (int j = 0; j < window.ny; ++j)
      for (int i = 0; i < window.nx; ++i) {
        const auto gi = window.i0 + i - g.lattice.i0, gj = window.j0 + j - g.lattice.j0;
        if (gi < 0 || gj < 0 || gi >= g.lattice.nx || gj >= g.lattice.ny) continue;
        out.height[window.at(i, j)] = g.height[g.lattice.at(static_cast<int>(gi), static_cast<int>(gj))];
      }
    return out;
  });
}

/// Sign of the turn a, b, c. Differences of doubles of like size are exact in 113 bits; so are products of coordinates below 2^56 ulps.
inline int turn(const Eigen::Vector2d& a, const Eigen::Vector2d& b, const Eigen::Vector2d& c) {
  __extension__ using Quad = __float128;
  const Quad ux = static_cast<Quad>(b.x()) - a.x(), uy = static_cast<Quad>(b.y()) - a.y();
  const Quad vx = static_cast<Quad>(c.x()) - a.x(), vy = static_cast<Quad>(c.y()) - a.y();
  const Quad d = ux * vy - uy * vx;
  return d > 0 ? 1 : d < 0 ? -1 : 0;
}

inline bool on(const Eigen::Vector2d& p, const Eigen::Vector2d& a, const Eigen::Vector2d& b) {
  return turn(a, b, p) == 0 && std::min(a.x(), b.x()) <= p.x() && p.x() <= std::max(a.x(), b.x()) && std::min(a.y(), b.y()) <= p.y() &&
         p.y() <= std::max(a.y(), b.y());
}

/// Whether two closed segments have a point in common.
inline bool meet(const Eigen::Vector2d& a, const Eigen::Vector2d& b, const Eigen::Vector2d& c, const Eigen::Vector2d& d) {
  if (turn(a, b, c) * turn(a, b, d) < 0 && turn(c, d, a) * turn(c, d, b) < 0) return true;
  return on(c, a, b) || on(d, a, b) || on(a, c, d) || on(b, c, d);
}

/// Pairs of segments of any lines that meet, but for neighbours of one line in the vertex they share; bending back onto the neighbour
/// counts.
inline size_t meetings(const std::vector<terrain::ContourLine>& lines, double bucket) {
  struct Piece {
    Eigen::Vector2d a, b;
    size_t line, at, n;
    bool closed;
  };
  std::vector<Piece> pieces;
  for (size_t l = 0; l < lines.size(); ++l)
    for (size_t k = 1; k < lines[l].vertices.size(); ++k)
      pieces.push_back({lines[l].vertices[k - 1], lines[l].vertices[k], l, k - 1, lines[l].vertices.size() - 1, lines[l].closed});
  std::map<std::pair<long, long>, std::vector<size_t>> buckets;
  for (size_t k = 0; k < pieces.size(); ++k) {
    const Piece& p = pieces[k];
    for (long i = std::lround(std::floor(std::min(p.a.x(), p.b.x()) / bucket));
         i <= std::lround(std::floor(std::max(p.a.x(), p.b.x()) / bucket)); ++i)
      for (long j = std::lround(std::floor(std::min(p.a.y(), p.b.y()) / bucket));
           j <= std::lround(std::floor(std::max(p.a.y(), p.b.y()) / bucket)); ++j)
        buckets[{i, j}].push_back(k);
  }
  std::set<std::pair<size_t, size_t>> met;
  for (const auto& [key, inside] : buckets)
    for (size_t m = 0; m < inside.size(); ++m)
      for (size_t n = m + 1; n < inside.size(); ++n) {
        const Piece &p = pieces[inside[m]], &q = pieces[inside[n]];
        if (p.line == q.line && q.at == p.at + 1) {
          if (on(q.b, p.a, p.b) || on(p.a, q.a, q.b)) met.insert({inside[m], inside[n]});
        } else if (p.line == q.line && p.closed && p.at == 0 && q.at + 1 == q.n) {
          if (on(q.a, p.a, p.b) || on(p.b, q.a, q.b)) met.insert({inside[m], inside[n]});
        } else if (meet(p.a, p.b, q.a, q.b)) {
          met.insert({inside[m], inside[n]});
        }
      }
  return met.size();
}

/// Largest distance in height from the surface along the lines, at `steps` places of every segment; NaN in a void.
inline double farthest_from(terrain::Facets& surface, const std::vector<terrain::ContourLine>& lines, int steps) {
  double most = 0.0;
  for (const terrain::ContourLine& l : lines)
    for (size_t k = 1; k < l.vertices.size(); ++k)
      for (int s = 0; s <= steps; ++s) {
        const Eigen::Vector2d p = l.vertices[k - 1] + (l.vertices[k] - l.vertices[k - 1]) * (static_cast<double>(s) / steps);
        const double off = std::abs(surface.at(p.x(), p.y()) - l.height);
        if (!(off <= most)) most = off;
      }
  return most;
}

}  // namespace swath::test
