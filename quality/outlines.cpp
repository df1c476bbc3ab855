// SPDX-License-Identifier: GPL-3.0-or-later
// Sides of the area, each with the area to its left, are linked where one ends and the next begins. Where two begin the one to the left is
// taken, so that cells that touch at a corner stay apart.
#include "quality/outlines.h"

#include <algorithm>
#include <map>
#include <utility>

namespace swath::quality {
namespace {

using Corner = std::pair<std::int32_t, std::int32_t>;  ///< x, y

struct Side {
  Corner to;
  bool used = false;
};
using Sides = std::multimap<Corner, Side>;
using Spans = std::vector<std::pair<std::int32_t, std::int32_t>>;

/// What of `a` does not lie in `b`; both rising and apart.
Spans without(const Spans& a, const Spans& b) {
  Spans out;
  size_t k = 0;
  for (auto [from, to] : a) {
    while (k < b.size() && b[k].second <= from) ++k;
    for (size_t n = k; n < b.size() && b[n].first < to; ++n) {
      if (b[n].first > from) out.push_back({from, b[n].first});
      from = std::max(from, b[n].second);
    }
    if (from < to) out.push_back({from, to});
  }
  return out;
}

Sides sides_of(const std::vector<VoidRun>& runs) {
  Sides sides;
  std::map<std::int32_t, Spans> rows;
  for (const VoidRun& r : runs) {
    rows[r.j].push_back({r.i0, r.i1});
    rows[r.j + 1];
    sides.insert({{r.i1, r.j}, {{r.i1, r.j + 1}}});
    sides.insert({{r.i0, r.j + 1}, {{r.i0, r.j}}});
  }
  Spans none;
  for (const auto& [j, row] : rows) {
    const auto below = rows.find(j - 1);
    const Spans& under = below == rows.end() ? none : below->second;
    for (const auto& [from, to] : without(row, under)) sides.insert({{from, j}, {{to, j}}});
    for (const auto& [from, to] : without(under, row)) sides.insert({{to, j}, {{from, j}}});
  }
  return sides;
}

/// Positive where the way from -> at -> to turns to the left.
std::int64_t turn(const Corner& from, const Corner& at, const Corner& to) {
  return static_cast<std::int64_t>(at.first - from.first) * (to.second - at.second) -
         static_cast<std::int64_t>(at.second - from.second) * (to.first - at.first);
}

double area_of(const std::vector<Eigen::Vector2d>& ring) {
  double sum = 0.0;
  for (size_t k = 0; k < ring.size(); ++k) {
    const Eigen::Vector2d a = ring[k] - ring[0], b = ring[(k + 1) % ring.size()] - ring[0];
    sum += a.x() * b.y() - a.y() * b.x();
  }
  return 0.5 * sum;
}

}  // namespace

std::vector<std::vector<Eigen::Vector2d>> outlines_of(const std::vector<VoidRun>& runs) {
  Sides sides = sides_of(runs);
  std::vector<std::vector<Eigen::Vector2d>> rings;
  for (auto& [start, first] : sides) {
    if (first.used) continue;
    std::vector<Corner> way{start};
    Side* side = &first;
    for (Corner at = first.to; !side->used;) {
      side->used = true;
      at = side->to;
      const Corner from = way.back();
      way.push_back(at);
      const auto [low, high] = sides.equal_range(at);
      Side* next = nullptr;
      for (auto s = low; s != high; ++s)
        if (!s->second.used && (!next || turn(from, at, s->second.to) > turn(from, at, next->to))) next = &s->second;
      if (!next) break;
      side = next;
    }
    way.pop_back();  // the first corner again
    std::vector<Eigen::Vector2d> ring;
    for (size_t k = 0; k < way.size(); ++k) {
      const Corner &before = way[(k + way.size() - 1) % way.size()], &after = way[(k + 1) % way.size()];
      if (turn(before, way[k], after) != 0) ring.push_back({way[k].first, way[k].second});
    }
    rings.push_back(std::move(ring));
  }
  std::stable_sort(rings.begin(), rings.end(), [](const auto& a, const auto& b) { return area_of(a) > area_of(b); });
  return rings;
}

}  // namespace swath::quality
