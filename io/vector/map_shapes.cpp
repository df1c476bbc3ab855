// SPDX-License-Identifier: GPL-3.0-or-later
// A side that is straight in the file's CRS is not in another: by L^2 / (8 R) at most about, 0.2 mm on 100 m.
#include "io/vector/map_shapes.h"

#include <gdal_priv.h>
#include <ogrsf_frmts.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <optional>

#include "core/error.h"
#include "core/geo/same_map.h"
#include "core/ring.h"
#include "io/vector/gdal_door.h"

namespace swath::io {
namespace {

using Eigen::Vector2d;
using Line = std::vector<Vector2d>;

constexpr double longest_side = 100.0;  // m, of a file in another CRS

/// Twice the area of the triangle: its sign says on which side of ab c lies.
double turn(const Vector2d& a, const Vector2d& b, const Vector2d& c) { return (b - a).x() * (c - a).y() - (b - a).y() * (c - a).x(); }

bool cross(const Vector2d& a, const Vector2d& b, const Vector2d& c, const Vector2d& d) {
  return turn(a, b, c) * turn(a, b, d) < 0.0 && turn(c, d, a) * turn(c, d, b) < 0.0;
}

/// A place where two sides of the rings cross.
std::optional<Vector2d> crossing(const std::vector<Line>& rings) {
  std::vector<std::array<Vector2d, 2>> sides;
  for (const Line& r : rings)
    for (size_t k = 0; k < r.size(); ++k) {
      Vector2d a = r[k], b = r[(k + 1) % r.size()];
      if (b.x() < a.x()) std::swap(a, b);
      sides.push_back({a, b});
    }
  std::sort(sides.begin(), sides.end(), [](const auto& p, const auto& q) { return p[0].x() < q[0].x(); });
  for (size_t i = 0; i < sides.size(); ++i)
    for (size_t j = i + 1; j < sides.size() && sides[j][0].x() <= sides[i][1].x(); ++j)
      if (cross(sides[i][0], sides[i][1], sides[j][0], sides[j][1])) return sides[j][0];
  return std::nullopt;
}

void expect_area(const MapShape& s) {
  double area = 0.0;
  for (const Line& ring : s.parts) {
    if (ring.size() < 3) throw core::Error("the area has fewer than three vertices", s.place, "correct it, or leave the feature out");
    area += std::abs(core::signed_area(ring));
  }
  if (const auto at = crossing(s.parts)) {
    char text[80];
    std::snprintf(text, sizeof text, "sides of the area cross near %.3f, %.3f", at->x(), at->y());
    throw core::Error(text, s.place, "correct it, for example by ogr2ogr -makevalid");
  }
  if (!(area > 0.0))
    throw core::Error("the area is empty: all its vertices lie on one line", s.place, "correct it, or leave the feature out");
}

class ShapeReader {
 public:
  ShapeReader(MapShapeKind kind, const core::Crs& own, const core::Crs& to) : kind_(kind) {
    if (own.empty() || to.empty()) return;
    const core::Crs from = own.horizontal(), map = to.horizontal();
    if (core::is_same_map(from, map)) return;
    operation_.emplace(from, map);
    unit_ = map.is_geographic() ? 1.0 : map.metres_per_unit();
  }

  std::vector<MapShape> shapes;

  void add(const OGRGeometry& shape, const std::string& place) {
    const auto type = wkbFlatten(shape.getGeometryType());
    if (OGR_GT_IsSubClassOf(type, wkbGeometryCollection)) {
      for (const OGRGeometry* part : *shape.toGeometryCollection()) add(*part, place);
    } else if (OGR_GT_IsSubClassOf(type, wkbPolygon)) {
      MapShape s{place};
      for (const OGRLinearRing* ring : *shape.toPolygon()) s.parts.push_back(vertices(*ring, true, place));
      if (kind_ == MapShapeKind::area) keep(std::move(s));
    } else if (OGR_GT_IsSubClassOf(type, wkbLineString)) {
      const OGRLineString& line = *shape.toLineString();
      const bool closed = line.get_IsClosed();
      if (kind_ == MapShapeKind::axis && line.getNumPoints() > 1) keep({place, {vertices(line, false, place)}});
      if (kind_ == MapShapeKind::area && closed) keep({place, {vertices(line, true, place)}});
    }
  }

 private:
  void keep(MapShape s) {
    if (kind_ == MapShapeKind::area) expect_area(s);
    shapes.push_back(std::move(s));
  }

  Vector2d on_map(const Vector2d& p, const std::string& place) const {
    if (!p.allFinite()) throw core::Error("a vertex is not finite", place, "correct it, or leave the feature out");
    if (!operation_) return p;
    try {
      return (*operation_)({p.x(), p.y(), 0.0}).head<2>();
    } catch (const core::Error& e) {
      throw core::Error("a vertex has no place in the CRS of the survey: " + std::string(e.what()), place,
                        "check the CRS that the file states");
    }
  }

  Line vertices(const OGRSimpleCurve& line, bool ring, const std::string& place) const {
    Line own;
    for (int k = 0; k < line.getNumPoints(); ++k) {
      const Vector2d p(line.getX(k), line.getY(k));
      if (own.empty() || p != own.back()) own.push_back(p);
    }
    Line out;
    for (size_t k = 0; k < own.size(); ++k) {
      const Vector2d b = on_map(own[k], place);
      if (operation_ && k > 0) {
        const double pieces = std::ceil((b - out.back()).norm() * unit_ / longest_side);
        for (double i = 1.0; i < pieces; ++i) out.push_back(on_map(own[k - 1] + (own[k] - own[k - 1]) * (i / pieces), place));
      }
      out.push_back(b);
    }
    if (ring && out.size() > 1 && own.front() == own.back()) out.pop_back();
    return out;
  }

  MapShapeKind kind_;
  std::optional<core::Transform> operation_;
  double unit_ = 1.0;
};

}  // namespace

std::vector<MapShape> read_map_shapes(const std::filesystem::path& file, const std::string& layer, const core::Crs& crs,
                                      MapShapeKind kind) {
  const GdalMessages messages;
  const Dataset set = required_vector(file, messages, "the vector file", "check the name; it is relative to survey.toml");
  std::vector<MapShape> out;
  std::string layers;
  bool has_layer = layer.empty();
  for (OGRLayer* l : set->GetLayers()) {
    const std::string name = l->GetName(), stated = stated_wkt(l->GetSpatialRef());
    layers += (layers.empty() ? "" : ", ") + name;
    ShapeReader reader(kind, stated.empty() ? core::Crs() : core::Crs(stated), crs);
    for (const auto& feature : *l) {
      if (!layer.empty() && layer != name && !is_of_layer(*feature, layer)) continue;
      has_layer = true;
      const OGRGeometry* shape = feature->GetGeometryRef();
      if (!shape || shape->IsEmpty()) continue;
      const std::unique_ptr<OGRGeometry> linear(shape->getLinearGeometry());
      reader.add(*linear, file.string() + ": layer " + name + ", feature " + std::to_string(feature->GetFID()));
    }
    std::move(reader.shapes.begin(), reader.shapes.end(), std::back_inserter(out));
  }
  messages.check("cannot read the vector file", file);
  if (!has_layer) throw core::Error("no feature is in a layer '" + layer + "'", file.string(), "its layers: " + layers);
  if (out.empty())
    throw core::Error(
        kind == MapShapeKind::area ? "no area is in the file" : "no line is in the file", file.string(),
        kind == MapShapeKind::area ? "polygons or closed lines are needed" : "an axis is a line; polygons are for the option polygons");
  return out;
}

}  // namespace swath::io
