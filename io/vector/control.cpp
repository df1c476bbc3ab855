// SPDX-License-Identifier: GPL-3.0-or-later
// Surveyed control out of CSV and GeoPackage. Both doors give the same raw rows; CRS, sigmas and the shape of targets are held to the same
// rules after them.
#include "io/vector/control.h"

#include <gdal_priv.h>
#include <ogrsf_frmts.h>

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <set>

#include "core/error.h"
#include "core/geo/crs.h"
#include "core/printable.h"
#include "io/survey/column_roles.h"
#include "io/survey/survey.h"
#include "io/survey/wild_records.h"
#include "io/text/text_table.h"
#include "io/vector/gdal_door.h"

namespace swath::io {
namespace {

using Eigen::Vector3d;

/// Corners nearer than this to one line, or than three sigmas, do not define a plane.
constexpr double least_width = 0.01;  // m
constexpr double farthest = 1e9;      // m or feet: no map projection and no place on the globe reaches it
constexpr double width_sigmas = 3.0;

/// A point as its file states it.
struct RawPoint {
  std::string name;  ///< empty: none stated
  std::string target, cover;
  Vector3d at;  ///< easting (longitude), northing (latitude), height; units of the CRS
  double sigma_h = 0, sigma_v = 0;
  std::string place;
  bool of_polygon = false;
};

/// Points of one CRS.
struct RawLayer {
  std::string own_crs;  ///< WKT that the file itself states; empty: none
  std::vector<RawPoint> points;
};

void hold_sigma(double sigma, const char* of, const std::string& place) {
  if (!(sigma > 0) || !std::isfinite(sigma))
    throw core::Error(std::string("the sigma of ") + of + " is " + core::format_number(sigma) + " m, which is none above zero", place,
                      "a point that is not known at all is left out of the file; sigmas are in metres");
}

/// The column that the survey names, or where it names none, the one of a usual name.
std::optional<size_t> column_in_role(const TextTable& table, const ColumnRoles& roles, const std::string& asked, const std::string& usual) {
  if (asked != usual) return table.column_if_there(asked, usual);
  const auto role = std::find_if(roles.columns.begin(), roles.columns.end(), [&](const auto& c) { return c.first == usual; });
  return role == roles.columns.end() ? std::nullopt : std::optional(table.column(role->second));
}

RawLayer read_table(const std::filesystem::path& path, const ControlFile& f) {
  const ControlFile usual;
  const TextTable table(path, {}, Header::if_any);
  const ColumnRoles roles = roles_of_control(table.names());
  const auto coordinate = [&](const std::string& asked, const std::string& key) {
    const auto found = column_in_role(table, roles, asked, key);
    return found ? *found : table.column(asked);
  };
  const std::array<size_t, 3> xyz{coordinate(f.x, usual.x), coordinate(f.y, usual.y), coordinate(f.z, usual.z)};
  const auto name = column_in_role(table, roles, f.name, usual.name);
  const auto target = table.column_if_there(f.target, usual.target), cover = table.column_if_there(f.cover, usual.cover);
  const auto sigma_h = table.column_if_there(f.sigma_h, usual.sigma_h), sigma_v = table.column_if_there(f.sigma_v, usual.sigma_v);
  RawLayer out;
  for (size_t row = 0; row < table.rows(); ++row) {
    RawPoint p;
    if (name) p.name = table.text(row, *name);
    if (target) p.target = table.text(row, *target);
    if (cover) p.cover = table.text(row, *cover);
    for (int k = 0; k < 3; ++k) p.at[k] = table.coordinate(row, xyz[static_cast<size_t>(k)]);
    const auto sigma = [&](const std::optional<size_t>& column, core::Metres otherwise) {
      return column && !table.text(row, *column).empty() ? table.number(row, *column) : otherwise.value;
    };
    p.sigma_h = sigma(sigma_h, f.sigma_horizontal);
    p.sigma_v = sigma(sigma_v, f.sigma_vertical);
    p.place = table.place(row);
    out.points.push_back(std::move(p));
  }
  return out;
}

/// Fields of a layer by name; -1 where it has none.
struct Attributes {
  int name, target, cover, z, sigma_h, sigma_v;
};

int field_of(OGRFeatureDefn& defn, const std::string& name, const std::string& usual, bool number, const std::string& place) {
  if (name.empty()) return -1;
  const int at = defn.GetFieldIndex(name.c_str());
  if (at >= 0 && number) {
    const OGRFieldType type = defn.GetFieldDefn(at)->GetType();
    if (type != OFTReal && type != OFTInteger && type != OFTInteger64)
      throw core::Error("attribute '" + name + "' holds no numbers", place, "make it a real number, or name another in [[control]]");
  }
  if (at >= 0 || name == usual) return at;
  std::string list;
  for (int k = 0; k < defn.GetFieldCount(); ++k) list += (k ? ", " : "") + std::string(defn.GetFieldDefn(k)->GetNameRef());
  throw core::Error("no attribute '" + name + "'; attributes: " + (list.empty() ? "none" : list), place, "correct it in [[control]]");
}

std::string text_in(OGRFeature& feature, int field) {
  return field >= 0 && feature.IsFieldSetAndNotNull(field) ? feature.GetFieldAsString(field) : "";
}

double number_in(OGRFeature& feature, int field, double otherwise) {
  return field >= 0 && feature.IsFieldSetAndNotNull(field) ? feature.GetFieldAsDouble(field) : otherwise;
}

/// The one part of a collection; others as they are.
const OGRGeometry& single_part(const OGRGeometry& shape, const std::string& place) {
  if (!OGR_GT_IsSubClassOf(wkbFlatten(shape.getGeometryType()), wkbGeometryCollection)) return shape;
  const OGRGeometryCollection& parts = *shape.toGeometryCollection();
  if (parts.getNumGeometries() != 1)
    throw core::Error("the feature has " + std::to_string(parts.getNumGeometries()) + " parts, one is needed", place,
                      "split multi-part features into single ones, one plane or point each");
  return *parts.getGeometryRef(0);
}

void add_feature(OGRFeature& feature, const Attributes& fields, const ControlFile& f, RawPoint p, RawLayer& to, core::Tally& tally) {
  const OGRGeometry* whole = feature.GetGeometryRef();
  if (!whole || whole->IsEmpty()) {
    tally.count("control features without a geometry, left out", p.place);
    return;
  }
  tally.keep("control features", 1);
  const OGRGeometry& shape = single_part(*whole, p.place);
  p.name = text_in(feature, fields.name);
  p.target = text_in(feature, fields.target);
  p.cover = text_in(feature, fields.cover);
  p.sigma_h = number_in(feature, fields.sigma_h, f.sigma_horizontal.value);
  p.sigma_v = number_in(feature, fields.sigma_v, f.sigma_vertical.value);
  const auto type = wkbFlatten(shape.getGeometryType());
  if (type == wkbPoint) {
    const OGRPoint& at = *shape.toPoint();
    const bool field = fields.z >= 0 && feature.IsFieldSetAndNotNull(fields.z);
    if (!at.Is3D() && !field)
      throw core::Error("the point has no height", p.place, "give the points a z, or an attribute '" + f.z + "' with the height");
    p.at = {at.getX(), at.getY(), at.Is3D() ? at.getZ() : feature.GetFieldAsDouble(fields.z)};
    to.points.push_back(std::move(p));
    return;
  }
  if (type != wkbPolygon)
    throw core::Error(std::string("the feature is a ") + shape.getGeometryName() + ", not a point or a polygon", p.place,
                      "control is points, or polygons with heights, one plane each");
  if (!shape.Is3D()) throw core::Error("the polygon has no heights", p.place, "export it as PolygonZ");
  const OGRPolygon& polygon = *shape.toPolygon();
  if (polygon.getNumInteriorRings() > 0) tally.count("control polygons with holes: the outer ring alone is taken", p.place);
  if (p.target.empty()) p.target = p.name;
  if (p.target.empty()) p.target = std::string(feature.GetDefnRef()->GetName()) + " " + std::to_string(feature.GetFID());
  p.name.clear();
  p.of_polygon = true;
  const OGRLinearRing& ring = *polygon.getExteriorRing();
  for (int k = 0; k + 1 < ring.getNumPoints(); ++k) {
    p.at = {ring.getX(k), ring.getY(k), ring.getZ(k)};
    to.points.push_back(p);
  }
}

std::vector<RawLayer> read_geopackage(const std::filesystem::path& path, const ControlFile& f, core::Tally& tally) {
  const GdalMessages messages;
  const Dataset set = required_vector(path, messages, "the GeoPackage");
  const ControlFile usual;
  std::vector<RawLayer> out;
  for (OGRLayer* layer : set->GetLayers()) {
    const std::string place = path.string() + ": layer " + layer->GetName();
    OGRFeatureDefn& defn = *layer->GetLayerDefn();
    if (defn.GetGeomFieldCount() == 0) continue;
    RawLayer raw;
    raw.own_crs = stated_wkt(layer->GetSpatialRef());
    const Attributes fields{field_of(defn, f.name, usual.name, false, place),      field_of(defn, f.target, usual.target, false, place),
                            field_of(defn, f.cover, usual.cover, false, place),    field_of(defn, f.z, usual.z, true, place),
                            field_of(defn, f.sigma_h, usual.sigma_h, true, place), field_of(defn, f.sigma_v, usual.sigma_v, true, place)};
    for (const auto& feature : *layer) {
      RawPoint p;
      p.place = place + ", feature " + std::to_string(feature->GetFID());
      tally.read("control features", 1);
      add_feature(*feature, fields, f, std::move(p), raw, tally);
    }
    out.push_back(std::move(raw));
  }
  messages.check("cannot read the GeoPackage", path);
  return out;
}

/// The CRS of a layer's coordinates. A file whose own CRS says nothing of heights, where the survey's does, is not guessed at.
core::Crs crs_of(const Survey& survey, const ControlFile& f, const RawLayer& layer, const std::string& file) {
  const std::string stated = !f.crs.empty() ? f.crs : !layer.own_crs.empty() ? layer.own_crs : survey.crs;
  if (stated.empty()) throw core::Error("the CRS of the control is not known", file, "state crs in this [[control]], or in the survey");
  const core::Crs crs(stated);
  if ((!f.crs.empty() || !layer.own_crs.empty()) && !survey.crs.empty() && crs.heights() == core::Heights::unknown) {
    const core::Crs of_survey(survey.crs);
    if (of_survey.heights() == core::Heights::vertical)
      throw core::Error(
          "the file's CRS, " + crs.name() + ", does not say what its heights are, while the survey's are " + of_survey.vertical_name(),
          file, "state crs in this [[control]] with its vertical part, or as \"EPSG:25832+ellipsoidal\" where heights are ellipsoidal");
  }
  return crs;
}

/// Distance of the corner farthest from the line through the two that are farthest apart, m.
double width_of(const std::vector<ControlPoint>& corners) {
  size_t a = 0, b = 0;
  double longest = 0;
  for (size_t i = 0; i < corners.size(); ++i)
    for (size_t j = i + 1; j < corners.size(); ++j)
      if (const double d = (corners[i].ecef - corners[j].ecef).norm(); d > longest) longest = d, a = i, b = j;
  double width = 0;
  if (longest == 0) return 0;
  const Vector3d along = (corners[b].ecef - corners[a].ecef) / longest;
  for (const ControlPoint& c : corners) width = std::max(width, along.cross(c.ecef - corners[a].ecef).norm());
  return width;
}

std::string number(double v) { return core::format_number(v); }

void hold_target(const std::vector<ControlPoint>& corners) {
  const std::string &target = corners[0].target, &place = corners[0].place;
  if (corners.size() < 3)
    throw core::Error("target '" + target + "' has " + std::to_string(corners.size()) + (corners.size() == 1 ? " corner" : " corners") +
                          ", at least 3 are needed",
                      place, "survey more of its corners, or leave the target empty: its points then stand for themselves");
  double sigma = 0;
  for (const ControlPoint& c : corners) sigma = std::max({sigma, c.sigma_h, c.sigma_v});
  const double width = width_of(corners);
  if (width < std::max(least_width, width_sigmas * sigma))
    throw core::Error("the corners of target '" + target + "' lie in one line (within " +
                          core::format_number(std::round(width * 1e3) / 1e3) + " m of it)",
                      place, "a plane needs a corner off that line by more than three of its sigmas");
}

/// All points of the groups but those of targets that lost a corner, each with a name.
std::vector<ControlPoint> joined(std::vector<std::vector<ControlPoint>>& groups, const std::set<std::string>& lost, core::Tally& tally) {
  std::vector<ControlPoint> out;
  for (std::vector<ControlPoint>& group : groups) {
    if (lost.contains(group[0].target)) {
      tally.count("control points of targets that lose another corner, left out", group[0].place, group.size());
      continue;
    }
    if (!group[0].target.empty()) {
      if (group.size() > 3 && group.front().ecef == group.back().ecef) {  // a ring that was closed
        tally.count("control points that close the ring of their target, left out", group.back().place);
        group.pop_back();
      }
      hold_target(group);
    }
    for (size_t k = 0; k < group.size(); ++k) {
      ControlPoint& p = group[k];
      if (p.name.empty()) p.name = p.target.empty() ? std::to_string(out.size() + 1) : p.target + " " + std::to_string(k + 1);
      out.push_back(std::move(p));
    }
  }
  return out;
}

/// What is impossible about a point; empty where nothing is. `metre`: per unit of its height; nothing where z is none.
std::string fault_of(const RawPoint& raw, std::optional<double> metre) {
  if (!raw.at.allFinite() || !(raw.at.cwiseAbs().maxCoeff() < farthest)) return "a coordinate is empty or not finite";
  if (metre && !is_a_height(raw.at.z() * *metre)) return "the height is " + number(raw.at.z()) + ", which no ground has";
  return {};
}

/// One file's points in ecef, corners of a target brought together.
std::vector<ControlPoint> points_of(const Survey& survey, const ControlFile& f, const std::vector<RawLayer>& layers,
                                    const std::string& file, core::Tally& tally) {
  std::vector<std::vector<ControlPoint>> groups;  // a target or a single point each
  std::map<std::string, size_t> targets;
  std::set<std::string> lost;  // targets of which a corner is
  std::uint64_t all = 0, impossible = 0;
  std::optional<core::Error> fault;  // of the first that is impossible
  for (const RawLayer& layer : layers) {
    if (layer.points.empty()) continue;
    const core::Crs crs = crs_of(survey, f, layer, file);
    const core::Transform to_ecef(crs, core::wgs84_ecef());
    const double height_unit = crs.has_height_unit() ? 1.0 : metres_per_height(survey, crs);  // PROJ knows a unit that the CRS states
    std::optional<double> metre;
    if (f.kind != ControlKind::xy && !crs.is_geocentric()) metre = crs.has_height_unit() ? crs.vertical_metres_per_unit() : height_unit;
    // A target without one of its corners is another plane: all of it goes.
    all += layer.points.size();
    const auto leave_out = [&](const RawPoint& raw, const std::string& why) {
      ++impossible;
      if (!fault) fault.emplace(why, raw.place, "check the columns and the CRS of this [[control]]");
      tally.count("control points with an impossible coordinate, left out", raw.place + ": " + why);
      if (!raw.target.empty()) lost.insert(raw.target);
    };
    for (const RawPoint& raw : layer.points) {
      if (metre && is_no_height(raw.at.z())) {  // however many: the file says that it has none
        tally.count("control points without a height, left out", raw.place + ": z " + number(raw.at.z()));
        if (!raw.target.empty()) lost.insert(raw.target);
        continue;
      }
      if (const std::string fault = fault_of(raw, metre); !fault.empty()) {
        leave_out(raw, fault);
        continue;
      }
      hold_sigma(raw.sigma_h, "easting and northing", raw.place);
      hold_sigma(raw.sigma_v, "height", raw.place);
      ControlPoint p{raw.name,  raw.target, Vector3d::Zero(), raw.sigma_h,       raw.sigma_v,  f.use,
                     raw.place, raw.cover,  f.kind,           !raw.name.empty(), crs.heights()};
      try {
        p.ecef = to_ecef({raw.at.x(), raw.at.y(), raw.at.z() * height_unit});
      } catch (const core::Error&) {
        leave_out(raw, "x " + number(raw.at.x()) + ", y " + number(raw.at.y()) + ", z " + number(raw.at.z()) + " is not a place of " +
                           crs.name());
        continue;
      }
      const auto [at, fresh] = raw.target.empty() ? std::pair{targets.end(), true} : targets.try_emplace(raw.target, groups.size());
      if (fresh) groups.emplace_back();
      std::vector<ControlPoint>& group = fresh ? groups.back() : groups[at->second];
      if (!fresh && raw.of_polygon && group.front().place != raw.place)
        throw core::Error("target '" + raw.target + "' stands a second time, first as " + group.front().place, raw.place,
                          "give each polygon a name of its own");
      group.push_back(std::move(p));
    }
  }
  if (impossible > 0 && !are_few(impossible, all)) throw core::Error(*fault);
  std::vector<ControlPoint> out = joined(groups, lost, tally);
  tally.read("control points", all);
  tally.keep("control points", out.size());
  if (out.empty()) tally.count("control files without a point", file);
  return out;
}

std::vector<ControlPoint> control_of(const Survey& survey, bool any_kind, core::Tally& tally) {
  std::vector<ControlPoint> all;
  std::map<std::string, std::string> targets;  // their files
  std::set<std::string> names;
  for (const ControlFile& f : survey.control) {
    if (!any_kind && f.kind != ControlKind::xyz) continue;
    const std::filesystem::path path = resolve(survey, f.file);
    const std::string ending = core::lower_case(path.extension().string());
    const std::vector<RawLayer> layers = ending == ".gpkg" ? read_geopackage(path, f, tally) : std::vector<RawLayer>{read_table(path, f)};
    for (ControlPoint& p : points_of(survey, f, layers, path.string(), tally)) {
      if (!p.target.empty()) {
        const auto [at, fresh] = targets.try_emplace(p.target, path.string());
        if (at->second != path.string())
          throw core::Error("target '" + p.target + "' stands in " + at->second + " too", p.place, "give each target a name of its own");
      }
      if (!names.insert(p.name).second) tally.count("control points whose name stands more than once", p.place + ": " + p.name);
      all.push_back(std::move(p));
    }
  }
  return all;
}

}  // namespace

std::vector<ControlPoint> read_control(const Survey& survey, core::Tally& tally) { return control_of(survey, false, tally); }

std::vector<ControlPoint> read_image_control(const Survey& survey, core::Tally& tally) { return control_of(survey, true, tally); }

}  // namespace swath::io
