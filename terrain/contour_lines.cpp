// SPDX-License-Identifier: GPL-3.0-or-later
// Every edge of the lattice is left by at most one segment and entered by at most one (terrain/contours.cpp), so following keys needs no
// search by distance and no tolerance. Simplification works on whole lines, after joining: it cannot know of tiles.
#include "terrain/contour_lines.h"

#include <algorithm>
#include <utility>

namespace swath::terrain {
namespace {

using Vertices = std::vector<Eigen::Vector2d>;

void add(Vertices& v, double x, double y) {
  const Eigen::Vector2d p(x, y);
  if (v.empty() || v.back() != p) v.push_back(p);
}

double distance_to_chord(const Eigen::Vector2d& p, const Eigen::Vector2d& a, const Eigen::Vector2d& b) {
  const Eigen::Vector2d d = b - a;
  const double dd = d.squaredNorm();
  const double t = dd > 0.0 ? std::clamp((p - a).dot(d) / dd, 0.0, 1.0) : 0.0;
  return (p - a - t * d).norm();
}

// The vertex between a and b farthest from their chord (the first of equals).
std::pair<size_t, double> farthest(const Vertices& v, size_t a, size_t b) {
  std::pair<size_t, double> best{a, -1.0};
  for (size_t k = a + 1; k < b; ++k)
    if (const double d = distance_to_chord(v[k], v[a], v[b]); d > best.second) best = {k, d};
  return best;
}

// Marks what stays between the kept vertices first and last; a stack of its own, as lines have up to millions of vertices.
void mark(const Vertices& v, size_t first, size_t last, double tolerance, std::vector<bool>& keep) {
  std::vector<std::pair<size_t, size_t>> todo{{first, last}};
  while (!todo.empty()) {
    const auto [a, b] = todo.back();
    todo.pop_back();
    const auto [k, d] = farthest(v, a, b);
    if (d <= tolerance) continue;
    keep[k] = true;
    todo.emplace_back(a, k);
    todo.emplace_back(k, b);
  }
}

}  // namespace

double length(const Vertices& vertices) {
  double sum = 0.0;
  for (size_t k = 1; k < vertices.size(); ++k) sum += (vertices[k] - vertices[k - 1]).norm();
  return sum;
}

std::vector<ContourLine> join(std::vector<Segment> segments, const ContourOptions& options) {
  std::sort(segments.begin(), segments.end());
  segments.erase(std::unique(segments.begin(), segments.end()), segments.end());
  using Node = std::pair<std::int64_t, EdgeKey>;  // level and edge
  const auto after = [&](const Segment& end) {
    const Node node{end.level, end.to};
    const auto at =
        std::lower_bound(segments.begin(), segments.end(), node, [](const Segment& s, const Node& n) { return Node(s.level, s.from) < n; });
    return at != segments.end() && Node(at->level, at->from) == node ? at - segments.begin() : std::ptrdiff_t{-1};
  };
  std::vector<bool> entered(segments.size(), false), used(segments.size(), false);
  for (const Segment& s : segments)
    if (const auto k = after(s); k >= 0) entered[k] = true;

  std::vector<std::pair<Node, ContourLine>> lines;
  const auto follow = [&](std::ptrdiff_t start, bool closed) {
    ContourLine line{
        segments[start].level, level_height(options, segments[start].level), is_index(options, segments[start].level), closed, {}};
    add(line.vertices, segments[start].from_x, segments[start].from_y);
    for (std::ptrdiff_t k = start; k >= 0 && !used[k]; k = after(segments[k])) {
      used[k] = true;
      add(line.vertices, segments[k].to_x, segments[k].to_y);
    }
    if (line.vertices.size() > (closed ? 3u : 1u)) lines.emplace_back(Node(segments[start].level, segments[start].from), std::move(line));
  };
  const auto n = static_cast<std::ptrdiff_t>(segments.size());
  for (std::ptrdiff_t k = 0; k < n; ++k)
    if (!entered[k]) follow(k, false);
  for (std::ptrdiff_t k = 0; k < n; ++k)
    if (!used[k]) follow(k, true);
  std::sort(lines.begin(), lines.end(), [](const auto& a, const auto& b) { return a.first < b.first; });

  std::vector<ContourLine> out;
  for (auto& [key, line] : lines) out.push_back(std::move(line));
  return out;
}

Vertices simplify(const Vertices& v, bool closed, double tolerance) {
  if (v.size() < 3 || tolerance <= 0.0) return v;
  const size_t last = v.size() - 1;
  std::vector<bool> keep(v.size(), false);
  keep[0] = keep[last] = true;
  if (!closed) {
    mark(v, 0, last, tolerance, keep);
  } else {
    // A ring has no chord: it is cut at the vertex farthest from its first, and the larger of the two bows keeps a vertex in any case.
    const size_t middle = farthest(v, 0, last).first;
    keep[middle] = true;
    const auto [k1, d1] = farthest(v, 0, middle);
    const auto [k2, d2] = farthest(v, middle, last);
    keep[d1 >= d2 ? k1 : k2] = true;
    for (size_t a = 0, b = 1; b < v.size(); ++b)
      if (keep[b]) {
        mark(v, a, b, tolerance, keep);
        a = b;
      }
  }
  Vertices out;
  for (size_t k = 0; k < v.size(); ++k)
    if (keep[k]) out.push_back(v[k]);
  return out;
}

std::vector<ContourLine> contour_lines(std::vector<Segment> segments, const ContourOptions& options) {
  std::vector<ContourLine> lines = join(std::move(segments), options);
  std::erase_if(lines, [&](const ContourLine& l) { return length(l.vertices) < options.min_length.value; });
  for (ContourLine& l : lines) l.vertices = simplify(l.vertices, l.closed, options.tolerance.value);
  return lines;
}

}  // namespace swath::terrain
