// SPDX-License-Identifier: GPL-3.0-or-later
// Every edge of the lattice is left by at most one segment and entered by at most one (terrain/contours/contours.cpp), so following keys
// needs no search by distance and no tolerance. What is left out and what is a depression is judged on whole lines, after joining.
#include "terrain/contours/contour_lines.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <utility>

#include "terrain/contours/contour_shape.h"

namespace swath::terrain {
namespace {

using Vertices = std::vector<Eigen::Vector2d>;

void add(Vertices& v, double x, double y) {
  const Eigen::Vector2d p(x, y);
  if (v.empty() || v.back() != p) v.push_back(p);
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
        segments[start].level, level_height(options, segments[start].level), is_index(options, segments[start].level), closed, false, {}};
    add(line.vertices, segments[start].from_x, segments[start].from_y);
    for (std::ptrdiff_t k = start; k >= 0 && !used[k]; k = after(segments[k])) {
      used[k] = true;
      add(line.vertices, segments[k].to_x, segments[k].to_y);
    }
    line.depression = closed && signed_area(line.vertices) < 0.0;
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

DrawnLines contour_lines(std::vector<Segment> segments, const ContourOptions& options, Facets& surface) {
  std::vector<ContourLine> lines = join(std::move(segments), options);
  const double least_area = square_metres(options.min_area).value_or(0.0);
  const size_t left_out = std::erase_if(lines, [&](const ContourLine& l) {
    return length(l.vertices) < options.min_length.value || (l.closed && std::abs(signed_area(l.vertices)) < least_area);
  });
  std::vector<ContourLine> out, level;
  for (size_t k = 0; k < lines.size(); ++k) {
    level.push_back(std::move(lines[k]));
    if (k + 1 < lines.size() && lines[k + 1].level == level[0].level) continue;
    thin(level, surface, vertical_tolerance(options));
    std::move(level.begin(), level.end(), std::back_inserter(out));
    level.clear();
  }
  return {std::move(out), left_out};
}

}  // namespace swath::terrain
