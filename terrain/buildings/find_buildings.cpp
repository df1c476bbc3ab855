// SPDX-License-Identifier: GPL-3.0-or-later
// Outlines by alpha shape and squared sides, roofs by planes. The outermost returns lie within the roof's edge, by half the distance of
// returns at most: sides are moved outwards by what the rim's own roughness says, and no more than that.
#include "terrain/buildings/find_buildings.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <tuple>

#include "core/ring.h"
#include "terrain/buildings/roof_heights.h"
#include "terrain/buildings/roof_solid.h"

namespace swath::terrain {
namespace {

using Eigen::Vector2d;

constexpr double outwards = 0.5;                                                            // of the mean distance of returns
constexpr double most_outwards = 0.5;                                                       // m
constexpr double face_spacings = 3.0, least_face_movement = 0.5, most_face_movement = 1.5;  // of returns' mean distance; m: of a face's rim
constexpr double least_face = 1.0;                                                          // m2
constexpr double cut_step = 1.0, cut_length = 3.0;        // m of the outline, beside which nothing is seen
constexpr double cut_reach = 3.0, unknown_height = 12.0;  // m beyond the roof's height: shadows of beams up to 45 deg are shorter
Tin alone(const Tin& tin, const TrianglePart& part) {
  Tin out;
  std::map<std::int32_t, std::int32_t> vertex, triangle;
  for (const std::int32_t t : part) {
    triangle.emplace(t, static_cast<std::int32_t>(triangle.size()));
    for (const std::int32_t v : tin.triangles[static_cast<size_t>(t)]) vertex[v] = 0;
  }
  for (auto& [old, now] : vertex) {
    now = static_cast<std::int32_t>(out.x.size());
    const auto v = static_cast<size_t>(old);
    out.x.push_back(tin.x[v]), out.y.push_back(tin.y[v]), out.z.push_back(tin.z[v]), out.row.push_back(tin.row[v]);
  }
  for (const std::int32_t t : part) {
    const auto& v = tin.triangles[static_cast<size_t>(t)];
    out.triangles.push_back({vertex[v[0]], vertex[v[1]], vertex[v[2]]});
    std::array<std::int32_t, 3> across{};
    for (size_t k = 0; k < 3; ++k) {
      const auto other = triangle.find(tin.across[static_cast<size_t>(t)][k]);
      across[k] = other == triangle.end() ? -1 : other->second;
    }
    out.across.push_back(across);
  }
  return out;
}

/// The ring's vertices on the line where its plane meets a neighbour of it.
Ring on_edges(const Ring& ring, size_t plane, const std::vector<RoofPlane>& planes, const std::set<std::pair<size_t, size_t>>& beside,
              double movement) {
  Ring out = ring;
  for (Vector2d& p : out) {
    double least = movement;
    Vector2d to = p;
    for (size_t k = 0; k < planes.size(); ++k) {
      if (!beside.contains({plane, k})) continue;
      const Vector2d across = planes[plane].slope - planes[k].slope;
      if (across.norm() < 0.1) continue;
      const double d = (planes[plane].height(p) - planes[k].height(p)) / across.norm();
      if (std::abs(d) < least) least = std::abs(d), to = p - d * across.normalized();
    }
    p = to;
  }
  return is_simple(out) ? out : ring;
}

std::vector<RoofFace> faces_of(const Tin& tin, const RoofPlanes& roof, double spacing) {
  const ShapeOptions shape{std::clamp(face_spacings * spacing, least_face_movement, most_face_movement), 0.0, false, {}};
  std::set<std::pair<size_t, size_t>> beside;
  for (const auto& v : tin.triangles)
    for (size_t k = 0; k < 3; ++k) {
      const std::int32_t a = roof.plane[static_cast<size_t>(v[k])], b = roof.plane[static_cast<size_t>(v[(k + 1) % 3])];
      if (a < 0 || b < 0 || a == b) continue;
      beside.insert({static_cast<size_t>(a), static_cast<size_t>(b)});
      beside.insert({static_cast<size_t>(b), static_cast<size_t>(a)});
    }
  std::vector<RoofFace> out;
  std::vector<std::int32_t> label(tin.size());
  for (size_t t = 0; t < tin.size(); ++t) label[t] = plane_of(tin, static_cast<std::int32_t>(t), roof);
  for (const TrianglePart& part : parts_of(tin, label)) {
    const Outline rim = rim_of(tin, part, least_face);
    if (rim.area() < least_face) continue;
    RoofFace face{static_cast<size_t>(label[static_cast<size_t>(part[0])]), {}};
    face.outline.outer = on_edges(shape_ring(rim.outer, shape).ring, face.plane, roof.planes, beside, shape.movement);
    for (const Ring& hole : rim.holes)
      if (!add_hole(face.outline, shape_ring(hole, shape).ring)) add_hole(face.outline, hole);
    out.push_back(std::move(face));
  }
  std::stable_sort(out.begin(), out.end(), [](const RoofFace& a, const RoofFace& b) { return a.plane < b.plane; });
  return out;
}

Outline shaped_outline(const Outline& rim, const ShapeOptions& o, bool& squared) {
  Outline out;
  const ShapedRing outer = shape_ring(rim.outer, o);
  squared = outer.direction.has_value();
  out.outer = outer.ring;
  ShapeOptions of_hole = o;
  of_hole.direction = outer.direction;
  for (const Ring& hole : rim.holes)
    if (!add_hole(out, shape_ring(hole, of_hole).ring)) add_hole(out, hole);
  return out;
}

/// Is there a stretch of the outline beside which no returns are?
bool is_cut(const Ring& ring, const Surroundings3d& around, double reach) {
  double blind = 0.0;
  bool cut = false;
  for_each_place(ring, cut_step, [&](const Vector2d& p, const Vector2d& right) {
    bool seen = false;
    for (double d = 2.0; d <= reach && !seen; d += 1.0) seen = around.has_returns(p + d * right);
    blind = seen ? 0.0 : blind + cut_step;
    cut = cut || blind >= cut_length;
  });
  return cut;
}

double share_on_lowest(const Tin& tin, const std::vector<RoofPlane>& planes, double tolerance) {
  if (planes.empty() || planes.size() > most_solid_planes) return 0.0;
  size_t on = 0;
  for (size_t v = 0; v < tin.x.size(); ++v) {
    double lowest = std::numeric_limits<double>::infinity();
    for (const RoofPlane& p : planes) lowest = std::min(lowest, p.height({tin.x[v], tin.y[v]}));
    on += std::abs(tin.z[v] - lowest) <= tolerance;
  }
  return static_cast<double>(on) / static_cast<double>(tin.x.size());
}

Building building_of(const Tin& tin, const Surroundings3d& around, const BuildingOptions& o) {
  Building b;
  const std::vector<TrianglePart> whole = parts_of(tin);
  const Outline rim = rim_of(tin, whole.front(), o.least_courtyard);
  const double spacing = std::sqrt(rim.area() / static_cast<double>(tin.x.size()));
  b.outline = shaped_outline(rim, {o.movement, std::min(outwards * spacing, most_outwards), o.square, {}}, b.squared);
  b.area = b.outline.area();
  b.returns = tin.x.size();
  RoofPlanes roof = roof_planes(tin, whole.front(), o.planes);
  b.faces = faces_of(tin, roof, spacing);
  measure_heights(tin, roof, around.ground, b);
  const double height = b.top - b.lowest_ground;
  b.is_cut = is_cut(b.outline.outer, around, cut_reach + (std::isfinite(height) ? height : unknown_height));
  b.on_lowest = share_on_lowest(tin, roof.planes, 2.0 * o.planes.tolerance);
  b.planes = std::move(roof.planes);
  return b;
}

Eigen::Vector2d least_place(const Building& b) {
  return *std::min_element(b.outline.outer.begin(), b.outline.outer.end(),
                           [](const Vector2d& p, const Vector2d& q) { return std::pair(p.x(), p.y()) < std::pair(q.x(), q.y()); });
}

double area_of(const Tin& tin) {
  double sum = 0.0;
  for (const auto& v : tin.triangles) {
    const auto at = [&](size_t k) { return Vector2d(tin.x[static_cast<size_t>(v[k])], tin.y[static_cast<size_t>(v[k])]); };
    sum += std::abs(core::signed_area({at(0), at(1), at(2)}));
  }
  return sum;
}

}  // namespace

bool is_west_of(const Building& a, const Building& b) {
  const Vector2d p = least_place(a), q = least_place(b);
  return std::tuple(p.x(), p.y(), a.area) < std::tuple(q.x(), q.y(), b.area);
}

FoundBuildings find_buildings(std::vector<RoofReturn> returns, const Surroundings3d& around, const BuildingOptions& o) {
  FoundBuildings out;
  const size_t all = returns.size();
  std::erase_if(returns, [](const RoofReturn& r) { return !std::isfinite(r.x) || !std::isfinite(r.y) || !std::isfinite(r.z); });
  out.not_finite = all - returns.size();
  std::sort(returns.begin(), returns.end(), [](const auto& p, const auto& q) { return std::tie(p.x, p.y, p.z) < std::tie(q.x, q.y, q.z); });
  core::Block block;
  std::vector<std::uint32_t> rows;
  for (const RoofReturn& r : returns) {
    block.x.push_back(r.x), block.y.push_back(r.y), block.z.push_back(r.z);
    rows.push_back(static_cast<std::uint32_t>(rows.size()));
  }
  const Tin tin = triangulate(block, rows, 0.5 * o.gap);
  size_t used = 0;
  for (const TrianglePart& part : parts_of(tin)) {
    const Tin own = alone(tin, part);
    used += own.x.size();
    if (area_of(own) < o.least_area) {
      ++out.small;
      out.small_returns += own.x.size();
      continue;
    }
    out.buildings.push_back(building_of(own, around, o));
  }
  out.alone = returns.size() > used ? returns.size() - used : 0;
  std::sort(out.buildings.begin(), out.buildings.end(), is_west_of);
  return out;
}

}  // namespace swath::terrain
