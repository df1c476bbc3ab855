// SPDX-License-Identifier: GPL-3.0-or-later
// Geometries come as OGR gives them: curves are read as chords, multi-part features as their parts. DXF has one OGR layer; its own layers
// are the attribute "Layer" there.
#include "io/vector/breaklines.h"

#include <gdal_priv.h>
#include <ogrsf_frmts.h>

#include <limits>
#include <memory>
#include <optional>

#include "core/error.h"
#include "core/geo/crs.h"
#include "core/printable.h"
#include "io/survey/survey.h"
#include "io/survey/wild_records.h"
#include "io/vector/gdal_door.h"

namespace swath::io {
namespace {

using core::Breakline;
using core::BreaklineKind;
using Eigen::Vector3d;

/// A feature's line or area as the file holds it, or why it is none.
class Reader {
 public:
  Reader(const BreaklineFile& file, double sigma) : file_(file), sigma_(sigma) {}

  std::vector<Breakline> features;

  void add(OGRFeature& feature, const std::string& place, core::Tally& tally) {
    const OGRGeometry* shape = feature.GetGeometryRef();
    if (!shape || shape->IsEmpty()) {
      tally.count("breakline features without a geometry, left out", place);
      return;
    }
    const size_t before = features.size();
    const std::unique_ptr<OGRGeometry> linear(shape->getLinearGeometry());
    const int field = file_.z.empty() ? -1 : feature.GetFieldIndex(file_.z.c_str());
    height_.reset();
    if (!linear->Is3D()) height_ = number_of(feature, field);
    if (!linear->Is3D() && !height_ && field >= 0 && *feature.GetFieldAsString(field) != '\0')
      throw core::Error("attribute '" + file_.z + "' is '" + core::printable(feature.GetFieldAsString(field)) + "', which is not a number",
                        place, "heights are numbers with a decimal point: correct it, or name another attribute as z in [[breaklines]]");
    add_shape(*linear, place);
    if (features.size() > before)
      tally.keep(kind_of_record, 1);
    else
      tally.count("breakline features with fewer than two vertices, left out", place);
  }
  static constexpr const char* kind_of_record = "breakline features";

 private:
  void add_shape(const OGRGeometry& shape, const std::string& place) {
    const auto type = wkbFlatten(shape.getGeometryType());
    if (OGR_GT_IsSubClassOf(type, wkbGeometryCollection)) {
      for (const OGRGeometry* part : *shape.toGeometryCollection()) add_shape(*part, place);
      return;
    }
    if (OGR_GT_IsSubClassOf(type, wkbPolygon))
      add_polygon(*shape.toPolygon(), place);
    else if (OGR_GT_IsSubClassOf(type, wkbLineString))
      add_line(*shape.toLineString(), place);
    else
      throw core::Error(std::string("the feature is a ") + shape.getGeometryName() + ", not a line or an area", place,
                        "breaklines are lines; boundaries and water are areas or closed lines");
  }

  std::vector<Vector3d> vertices(const OGRSimpleCurve& line) const {
    std::vector<Vector3d> out;
    for (int k = 0; k < line.getNumPoints(); ++k) {
      const Vector3d p(line.getX(k), line.getY(k), line.Is3D() ? line.getZ(k) : height_.value_or(0.0));
      if (out.empty() || p.head<2>() != out.back().head<2>()) out.push_back(p);
    }
    return out;
  }

  Breakline feature_of(const OGRGeometry& shape, const std::string& place) const {
    return {file_.kind, place, {}, shape.Is3D() || height_.has_value(), sigma_};
  }

  void add_line(const OGRLineString& line, const std::string& place) {
    Breakline f = feature_of(line, place);
    f.parts.push_back(vertices(line));
    std::vector<Vector3d>& v = f.parts.front();
    if (f.is_area()) {
      if (v.size() < 4 || v.front().head<2>() != v.back().head<2>())
        throw core::Error("the line is not closed, while an area is needed", place, "close it, or export it as a polygon");
      v.pop_back();
    } else {
      hold_breakline(f);
    }
    if (v.size() >= 2) features.push_back(std::move(f));
  }

  void add_polygon(const OGRPolygon& polygon, const std::string& place) {
    Breakline f = feature_of(polygon, place);
    for (const OGRLinearRing* ring : polygon) {
      std::vector<Vector3d> v = vertices(*ring);
      if (file_.kind == BreaklineKind::breakline) {  // each ring is a line of its own
        Breakline line = f;
        line.parts = {std::move(v)};
        hold_breakline(line);
        features.push_back(std::move(line));
        continue;
      }
      if (v.size() > 1) v.pop_back();
      if (v.size() < 3) throw core::Error("the area has fewer than three vertices", place, "correct it, or leave the feature out");
      f.parts.push_back(std::move(v));
    }
    if (!f.parts.empty()) features.push_back(std::move(f));
  }

  void hold_breakline(const Breakline& f) const {
    if (!f.has_height)
      throw core::Error("the breakline has no heights", f.place,
                        "export it with heights (LineStringZ), or give it an attribute '" + file_.z + "' with the height");
  }

  const BreaklineFile& file_;
  double sigma_;
  std::optional<double> height_;
};

/// Coordinates of one layer into those of the survey; `products`: the CRS of a survey that states none.
void transform(std::vector<Breakline>& features, const BreaklineFile& f, const std::string& own, const Survey& survey,
               const std::string& products, const std::string& place) {
  const std::string stated = !f.crs.empty() ? f.crs : own;
  if (stated.empty() || stated == survey.crs || features.empty()) return;
  const core::Crs from(stated), to(survey.crs.empty() ? products : survey.crs);
  const bool heights = std::any_of(features.begin(), features.end(), [](const Breakline& b) { return b.has_height; });
  if (from.wkt() == to.wkt()) return;
  if (heights && from.heights() == core::Heights::unknown && to.heights() == core::Heights::vertical)
    throw core::Error(
        "the file's CRS, " + from.name() + ", does not say what its heights are, while the survey's are " + to.vertical_name(), place,
        "state crs in this [[breaklines]] with its vertical part, or as \"EPSG:25832+ellipsoidal\" where heights are ellipsoidal");
  if (from.epsg() != 0 && from.epsg() == to.epsg() && (!heights || (!from.has_vertical() && !to.has_vertical()))) return;
  const core::Transform operation = heights ? core::Transform(from, to) : core::Transform(from.horizontal(), to.horizontal());
  // PROJ takes heights of a known system in the CRS's own unit; those of an unknown one it hands through, or takes for metres.
  const auto unit = [&](const core::Crs& crs) { return crs.heights() == core::Heights::unknown ? metres_per_height(survey, crs) : 1.0; };
  for (Breakline& b : features)
    for (auto& part : b.parts)
      for (Vector3d& v : part) {
        if (!v.allFinite()) continue;
        try {
          const Vector3d moved = operation({v.x(), v.y(), v.z() * unit(from)});
          v.head<2>() = moved.head<2>();
          if (b.has_height) v.z() = moved.z() / unit(to);
        } catch (const core::Error&) {  // beyond the projection
          v.setConstant(std::numeric_limits<double>::quiet_NaN());
        }
      }
}

/// Throws where more vertices than a few are not finite, in the file or in the CRS of the survey.
void hold_vertices(const std::vector<Breakline>& features, size_t first) {
  std::uint64_t all = 0, impossible = 0;
  const Breakline* where = nullptr;
  for (size_t i = first; i < features.size(); ++i)
    for (const auto& part : features[i].parts)
      for (const Vector3d& v : part) {
        ++all;
        if (v.allFinite()) continue;
        ++impossible;
        if (!where) where = &features[i];
      }
  if (impossible > 0 && !are_few(impossible, all))
    throw core::Error(
        std::to_string(impossible) + " of the file's " + std::to_string(all) + " vertices are not finite, or no places of its CRS",
        where->place, "check the file, and crs in this [[breaklines]]");
}

}  // namespace

std::vector<Breakline> read_breaklines(const Survey& survey, const std::string& crs, core::Tally& tally) {
  std::vector<Breakline> out;
  for (const BreaklineFile& f : survey.breaklines) {
    const std::filesystem::path path = resolve(survey, f.file);
    const GdalMessages messages;
    const Dataset set = required_vector(path, messages, "the breaklines");
    const size_t first = out.size();
    std::string layers;
    for (OGRLayer* layer : set->GetLayers()) {
      if (layer->GetLayerDefn()->GetGeomFieldCount() == 0) continue;
      const std::string name = layer->GetName(), place = path.string() + ": layer " + name;
      layers += (layers.empty() ? "" : ", ") + name;
      Reader reader(f, f.sigma.value);
      for (const auto& feature : *layer) {
        tally.read(Reader::kind_of_record, 1);
        if (!f.layer.empty() && f.layer != name && !is_of_layer(*feature, f.layer)) {
          tally.count("breakline features of other layers than the stated, left out");
          continue;
        }
        reader.add(*feature, place + ", feature " + std::to_string(feature->GetFID()), tally);
      }
      transform(reader.features, f, stated_wkt(layer->GetSpatialRef()), survey, crs, place);
      out.insert(out.end(), std::make_move_iterator(reader.features.begin()), std::make_move_iterator(reader.features.end()));
    }
    messages.check("cannot read the breaklines", path);
    hold_vertices(out, first);
    if (out.size() == first)
      throw core::Error(f.layer.empty() ? "no lines in the file" : "no lines of layer '" + f.layer + "'", path.string(),
                        "layers: " + (layers.empty() ? "none" : layers));
  }
  return out;
}

}  // namespace swath::io
