// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/vector/vector.h"

#include <cpl_conv.h>
#include <gdal_priv.h>
#include <ogrsf_frmts.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <cstring>

#include "core/error.h"
#include "core/printable.h"
#include "io/vector/gdal_door.h"
#include "io/vector/vector_sink.h"

namespace swath::io {
namespace {

std::unique_ptr<ContourSink> make_sink(const std::filesystem::path& file, const std::string& crs, const std::string& heights) {
  CrsFacts facts = crs_facts(crs);
  if (!heights.empty()) facts.vertical_name = heights;
  const std::string ending = core::lower_case(file.extension().string());
  if (ending == ".gpkg") return make_gpkg_sink(file, facts);
  if (ending == ".dxf") return make_dxf_sink(file, facts);
  if (ending == ".geojson" || ending == ".json") return make_geojson_sink(file, facts);
  throw core::usage_error("contours cannot be written as '" + ending + "'", file.string(), "use .gpkg, .dxf or .geojson");
}

struct Fields {
  int height = -1, index = -1, depression = -1;
  int cad_layer = -1;
};

Fields fields_of(OGRFeatureDefn& defn, const std::string& height) {
  Fields f;
  f.height = height_field(defn, height);
  f.index = defn.GetFieldIndex("index");
  f.depression = defn.GetFieldIndex("depression");
  f.cad_layer = defn.GetFieldIndex("Layer");
  return f;
}

void add_shape(const OGRGeometry& shape, const VectorLine& like, std::vector<VectorLine>& to) {
  const auto type = wkbFlatten(shape.getGeometryType());
  if (type == wkbLineString || type == wkbLinearRing) {
    const auto& points = *shape.toSimpleCurve();
    VectorLine line = like;
    const int n = points.getNumPoints();
    for (int k = 0; k < n; ++k) {
      line.x.push_back(points.getX(k));
      line.y.push_back(points.getY(k));
      if (shape.Is3D()) line.z.push_back(points.getZ(k));
    }
    line.closed = n > 2 && line.x.front() == line.x.back() && line.y.front() == line.y.back();
    if (std::isnan(line.height) && !line.z.empty() && std::all_of(line.z.begin(), line.z.end(), [&](double z) { return z == line.z[0]; }))
      line.height = line.z[0];
    to.push_back(std::move(line));
  } else if (type == wkbPolygon) {
    for (const OGRLinearRing* ring : *shape.toPolygon()) add_shape(*ring, like, to);
  } else if (OGR_GT_IsSubClassOf(type, wkbGeometryCollection)) {
    for (const OGRGeometry* part : *shape.toGeometryCollection()) add_shape(*part, like, to);
  } else if (shape.hasCurveGeometry(TRUE)) {
    const std::unique_ptr<OGRGeometry> chords(shape.getLinearGeometry());
    if (chords && !chords->hasCurveGeometry(TRUE)) add_shape(*chords, like, to);
  }
}

}  // namespace

ContourWriter::ContourWriter(const std::filesystem::path& file, const std::string& crs, const std::string& heights)
    : sink_(make_sink(file, crs, heights)), file_(file) {}
ContourWriter::~ContourWriter() = default;
ContourWriter::ContourWriter(ContourWriter&&) noexcept = default;
ContourWriter& ContourWriter::operator=(ContourWriter&&) noexcept = default;

void ContourWriter::add(const core::ContourLine& line) {
  const std::string at = file_.string() + ": contour " + std::to_string(count_ + 1);
  if (!sink_) throw core::Error("the file is closed", at);
  const auto finite = [](double v) { return std::isfinite(v); };
  if (line.x.size() != line.y.size() || line.x.size() < 2) throw core::Error("a contour needs two vertices or more, each with x and y", at);
  if (!finite(line.height) || !std::all_of(line.x.begin(), line.x.end(), finite) || !std::all_of(line.y.begin(), line.y.end(), finite))
    throw core::Error("a contour holds a number that is not finite", at);
  if (line.closed && (line.x.front() != line.x.back() || line.y.front() != line.y.back())) {
    core::ContourLine ring = line;
    ring.x.push_back(line.x.front());
    ring.y.push_back(line.y.front());
    sink_->add(ring);
  } else {
    sink_->add(line);
  }
  ++count_;
}

void ContourWriter::add(const core::ContourLabel& label) {
  const std::string at = file_.string() + ": label " + label.text;
  if (!sink_) throw core::Error("the file is closed", at);
  for (const double v : {label.x, label.y, label.rotation, label.text_height, label.height})
    if (!std::isfinite(v)) throw core::Error("a label holds a number that is not finite", at);
  sink_->add(label);
}

void ContourWriter::add(const core::SpotHeight& spot) {
  const std::string at = file_.string() + ": spot height " + spot.text;
  if (!sink_) throw core::Error("the file is closed", at);
  for (const double v : {spot.x, spot.y, spot.text_height, spot.height})
    if (!std::isfinite(v)) throw core::Error("a spot height holds a number that is not finite", at);
  sink_->add(spot);
}

void ContourWriter::close() {
  if (!sink_) return;
  const std::unique_ptr<ContourSink> sink = std::move(sink_);
  sink->close();
}

ContourFiles::ContourFiles(const std::filesystem::path& folder, const std::string& name, const std::string& crs, const std::string& heights)
    : geojson_name_(name + ".geojson") {
  for (const char* ending : {".gpkg", ".dxf"}) files_.emplace_back(folder / (name + ending), crs, heights);
  with_geojson([&] { geojson_.emplace(folder / geojson_name_, crs, heights); });
}

void ContourFiles::with_geojson(const std::function<void()>& work) {
  try {
    work();
  } catch (const core::SystemError&) {
    throw;
  } catch (const core::Error& e) {
    geojson_.reset();
    left_out_ = geojson_name_ + " is left out: " + e.what() + (e.hint().empty() ? std::string() : " (" + e.hint() + ")");
  }
}

std::string ContourFiles::close() {
  for (ContourWriter& f : files_) f.close();
  if (geojson_) geojson_->close();
  return left_out_;
}

VectorLines lines_in(GDALDataset& set, const std::string& field) {
  VectorLines out;
  for (OGRLayer* layer : set.GetLayers()) {
    if (const OGRSpatialReference* srs = layer->GetSpatialRef(); srs && out.crs_wkt.empty()) out.crs_wkt = wkt2(*srs);
    const Fields fields = fields_of(*layer->GetLayerDefn(), field);
    for (const auto& feature : *layer) {
      const OGRGeometry* shape = feature->GetGeometryRef();
      if (!shape) continue;
      VectorLine like;
      like.layer = layer->GetName();
      if (fields.cad_layer >= 0 && feature->IsFieldSetAndNotNull(fields.cad_layer))
        like.layer = feature->GetFieldAsString(fields.cad_layer);
      if (const auto height = number_of(*feature, fields.height)) like.height = *height;
      like.index = (fields.index >= 0 && feature->GetFieldAsInteger(fields.index) != 0) || like.layer == "CONTOUR_INDEX";
      like.depression =
          (fields.depression >= 0 && feature->GetFieldAsInteger(fields.depression) != 0) || like.layer == "CONTOUR_DEPRESSION";
      add_shape(*shape, like, out.lines);
    }
  }
  return out;
}

VectorLines read_lines(const std::filesystem::path& file, const std::string& field) {
  const GdalMessages messages;
  const Dataset set = required_vector(file, messages);
  VectorLines out = lines_in(*set, field);
  messages.check("cannot read the vector file", file);
  return out;
}

}  // namespace swath::io
