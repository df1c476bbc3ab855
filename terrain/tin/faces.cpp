// SPDX-License-Identifier: GPL-3.0-or-later
#include "terrain/tin/faces.h"

#include <algorithm>
#include <numeric>

namespace swath::terrain {
namespace {

std::int32_t root_of(std::vector<std::int32_t>& parent, std::int32_t f) {
  while (parent[f] != f) f = parent[f] = parent[parent[f]];
  return f;
}

/// Cuts the convex polygon of `members` anew as a fan from its first vertex.
void fan(std::vector<Face>& faces, const std::vector<Place>& places, const std::vector<std::int32_t>& members,
         const std::vector<std::int32_t>& polygon) {
  struct Side {
    std::int32_t from, to, across, back;
  };
  std::vector<Side> sides;
  for (const std::int32_t m : members)
    for (int k = 0; k < 3; ++k) {
      const std::int32_t g = faces[m].n[k];
      if (polygon[g] == polygon[m]) continue;
      sides.push_back({faces[m].v[ccw(k)], faces[m].v[cw(k)], g, faces[g].side_of(m)});
    }
  std::sort(sides.begin(), sides.end(), [](const Side& a, const Side& b) { return a.from < b.from; });
  std::vector<Side> ring{*std::min_element(sides.begin(), sides.end(), [&](const Side& a, const Side& b) {
    return is_before(places[static_cast<size_t>(a.from)], places[static_cast<size_t>(b.from)]);
  })};
  while (ring.size() < sides.size())
    ring.push_back(*std::lower_bound(sides.begin(), sides.end(), ring.back().to, [](const Side& s, std::int32_t v) { return s.from < v; }));
  const auto link = [&](std::int32_t f, int k, const Side& s) {
    faces[f].n[k] = s.across;
    faces[s.across].n[s.back] = f;
  };
  for (size_t i = 0; i < members.size(); ++i) {
    const std::int32_t f = members[i];
    faces[f].v = {ring[0].from, ring[i + 1].from, ring[i + 1].to};
    link(f, 0, ring[i + 1]);
    if (i == 0)
      link(f, 2, ring[0]);
    else
      faces[f].n[2] = members[i - 1];
    if (i + 1 == members.size())
      link(f, 1, ring.back());
    else
      faces[f].n[1] = members[i + 1];
  }
}

}  // namespace

void cut_as_fans(std::vector<Face>& faces, const std::vector<Place>& places, const std::vector<FacePair>& pairs) {
  if (pairs.empty()) return;
  std::vector<std::int32_t> polygon(faces.size());
  std::iota(polygon.begin(), polygon.end(), 0);
  for (const auto& [f, g] : pairs) polygon[root_of(polygon, g)] = root_of(polygon, f);
  std::vector<FacePair> member;  // polygon, face
  for (const auto& pair : pairs)
    for (const std::int32_t f : pair) member.push_back({root_of(polygon, f), f});
  for (const auto& [root, f] : member) polygon[f] = root;
  std::sort(member.begin(), member.end());
  member.erase(std::unique(member.begin(), member.end()), member.end());
  std::vector<std::int32_t> members;
  for (size_t i = 0; i < member.size();) {
    members.clear();
    const std::int32_t root = member[i].front();
    for (; i < member.size() && member[i].front() == root; ++i) members.push_back(member[i].back());
    fan(faces, places, members, polygon);
  }
}

}  // namespace swath::terrain
