// SPDX-License-Identifier: GPL-3.0-or-later
// A facet is its plane cut by the building's other planes, one after the other (Sutherland and Hodgman 1974).
#include "simulate/world/facets.h"

#include <Eigen/Geometry>
#include <cstdio>

#include "core/block.h"
#include "io/text/output_file.h"

namespace swath::simulate {
namespace {

using Eigen::Vector3d;
using Eigen::Vector4d;
using Polygon = std::vector<Vector3d>;

/// What of the polygon lies where normal . p <= offset.
Polygon cut(const Polygon& polygon, const Vector4d& plane) {
  Polygon out;
  for (size_t i = 0; i < polygon.size(); ++i) {
    const Vector3d &a = polygon[i], &b = polygon[(i + 1) % polygon.size()];
    const double da = plane.head<3>().dot(a) - plane[3], db = plane.head<3>().dot(b) - plane[3];
    if (da <= 0.0) out.push_back(a);
    if ((da < 0.0 && db > 0.0) || (da > 0.0 && db < 0.0)) out.push_back(a + da / (da - db) * (b - a));
  }
  return out;
}

Facet facet_of(const Building& b, size_t plane, const Relief& relief) {
  constexpr double depth = 100.0;  // m below the top: under the ground, which then cuts
  Facet f;
  f.normal = b.planes[plane].head<3>();
  f.roof = f.normal.z() > 1e-9;
  const Vector3d u = (f.roof ? Vector3d::UnitX().cross(f.normal).cross(f.normal) : Vector3d::UnitZ().cross(f.normal)).normalized(),
                 v = f.normal.cross(u);
  const Vector3d middle(b.centre.x(), b.centre.y(), b.top);
  const Vector3d centre = middle + (b.planes[plane][3] - f.normal.dot(middle)) * f.normal;
  const double size = 2 * (b.radius + depth);
  f.corners = {centre - size * u - size * v, centre + size * u - size * v, centre + size * u + size * v, centre - size * u + size * v};
  for (size_t i = 0; i < b.planes.size(); ++i)
    if (i != plane) f.corners = cut(f.corners, b.planes[i]);
  if (!f.roof)
    for (Vector3d& c : f.corners)
      if (c.z() < b.top - depth) c.z() = relief.height(c.x(), c.y());
  return f;
}

}  // namespace

std::vector<Facet> facets_of(const World& world) {
  std::vector<Facet> out;
  for (const Building& b : world.buildings()) {
    if (b.kind != core::point_class::building) continue;
    int roofs = 0, walls = 0;
    for (size_t i = 0; i < b.planes.size(); ++i) {
      Facet f = facet_of(b, i, world.relief());
      if (f.corners.size() < 3) continue;
      f.name = b.name + (f.roof ? " roof " + std::to_string(++roofs) : " wall " + std::to_string(++walls));
      out.push_back(std::move(f));
    }
  }
  return out;
}

void write_planes(const std::filesystem::path& file, const std::vector<Facet>& facets, const MapPatch& map) {
  std::string text = "name,kind,normal_east,normal_north,normal_up,corners\n";
  char number[128];
  for (const Facet& f : facets) {
    std::snprintf(number, sizeof number, ",%s,%.15g,%.15g,%.15g,", f.roof ? "roof" : "wall", f.normal.x(), f.normal.y(), f.normal.z());
    text += f.name + number;
    for (size_t i = 0; i < f.corners.size(); ++i) {
      const Vector3d p = f.corners[i] + map.map_origin();
      std::snprintf(number, sizeof number, "%s%.9f %.9f %.9f", i ? ";" : "", p.x(), p.y(), p.z());
      text += number;
    }
    text += '\n';
  }
  io::write_text_file(file, text);
}

}  // namespace swath::simulate
