// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/vector/describe_vector.h"

#include <gdal_priv.h>
#include <ogrsf_frmts.h>

#include <fstream>
#include <string>
#include <vector>

#include "core/config/result_visitors.h"
#include "core/error.h"
#include "io/survey/file_facts.h"
#include "io/vector/gdal_door.h"
#include "io/vector/height_statement.h"

namespace swath::io {
namespace {

struct LayerFacts {
  std::string name, geometry;
  std::uint64_t features = 0;
  core::Interval x, y, z, height;
  StatedCrs crs;
  std::string description;
  std::vector<std::string> fields;
};
template <class V>
void describe(const LayerFacts& r, V& v) {
  v.result("name", r.name, "Name of the layer.");
  v.result("geometry", r.geometry, "Kinds of geometry that its features have.");
  v.result("features", r.features, "Features.");
  v.result("x", r.x, "Smallest and largest x.");
  v.result("y", r.y, "Smallest and largest y.");
  v.result("z", r.z, "Smallest and largest z of geometries with heights.");
  v.result("height", r.height, "Smallest and largest value of the field `height`.");
  describe(r.crs, v);
  v.result("description", r.description, core::Form{}.only_if(!r.description.empty()), "Description that the layer states.");
  v.result("fields", r.fields, core::Form{}.only_if(!r.fields.empty()), "Names of its fields.");
}

struct VectorFacts {
  std::string format;
  std::vector<std::string> comments;
  std::vector<LayerFacts> layers;
  std::vector<std::string> warnings;
};
template <class V>
void describe(const VectorFacts& r, V& v) {
  v.result("format", r.format, "Format.");
  v.result("comments", r.comments, core::Form{}.only_if(!r.comments.empty()), "Comments that a DXF file begins with.");
  v.tables("layers", r.layers, "Layers.");
  v.result("warnings", r.warnings, "What looks wrong.");
}

void find_crs(OGRLayer& layer, LayerFacts& out, std::vector<std::string>& warnings) {
  const std::string wkt = stated_wkt(layer.GetSpatialRef());
  if (wkt.empty()) return warnings.push_back("layer " + out.name + " states no CRS");
  try {
    out.crs = StatedCrs(core::Crs(wkt));
  } catch (const core::Error& e) {
    warnings.push_back("layer " + out.name + ": the CRS is not known: " + e.what());
  }
}

LayerFacts facts_of(OGRLayer& layer, std::vector<std::string>& warnings) {
  LayerFacts out;
  out.name = layer.GetName();
  std::uint64_t empty = 0;
  const int height = layer.GetLayerDefn()->GetFieldIndex("height");
  for (const auto& feature : layer) {
    ++out.features;
    if (const auto number = number_of(*feature, height)) out.height.add(*number);
    const OGRGeometry* shape = feature->GetGeometryRef();
    if (!shape || shape->IsEmpty()) {
      ++empty;
      continue;
    }
    OGREnvelope3D box;
    shape->getEnvelope(&box);
    for (const double v : {box.MinX, box.MaxX}) out.x.add(v);
    for (const double v : {box.MinY, box.MaxY}) out.y.add(v);
    if (shape->Is3D())
      for (const double v : {box.MinZ, box.MaxZ}) out.z.add(v);
    const std::string kind = shape->getGeometryName();
    if (out.geometry.find(kind) == std::string::npos) out.geometry += (out.geometry.empty() ? "" : ", ") + kind;
  }
  if (out.geometry.empty()) out.geometry = "none";
  find_crs(layer, out, warnings);
  if (const char* about = layer.GetMetadataItem("DESCRIPTION")) out.description = about;
  // The CRS of flat lines has no heights: the description of this program's layers states those of the field.
  if (const std::string_view heights = stated_heights(out.description); !heights.empty() && out.crs.heights == core::unknown_heights)
    out.crs.heights = heights;
  for (int k = 0; k < layer.GetLayerDefn()->GetFieldCount(); ++k) out.fields.push_back(layer.GetLayerDefn()->GetFieldDefn(k)->GetNameRef());
  if (out.features == 0) warnings.push_back("layer " + out.name + " has no feature");
  if (empty > 0) warnings.push_back("layer " + out.name + " has " + core::counted(empty, "feature") + " without a geometry");
  return out;
}

/// The comments (group 999) that a DXF file begins with.
std::vector<std::string> comments_of(const std::filesystem::path& path) {
  std::vector<std::string> out;
  std::ifstream in(path);
  std::string group, words;
  while (std::getline(in, group) && std::getline(in, words) && group.find("999") != std::string::npos) {
    if (!words.empty() && words.back() == '\r') words.pop_back();
    out.push_back(words);
  }
  return out;
}

}  // namespace

core::Value describe_vector(const std::filesystem::path& file) {
  const GdalMessages messages;
  const Dataset set = open_vector(file);
  if (!set) return {};
  const std::string driver = set->GetDriverName();
  if (driver == "CSV") return {};  // GDAL takes any text with commas for one
  VectorFacts out;
  out.format = driver == "GPKG" ? "GeoPackage" : driver;
  if (driver == "DXF") out.comments = comments_of(file);
  for (OGRLayer* layer : set->GetLayers()) out.layers.push_back(facts_of(*layer, out.warnings));
  if (out.layers.empty()) out.warnings.push_back("the file has no layer");
  if (messages.failed()) out.warnings.push_back(messages.text());
  return core::reported(out);
}

}  // namespace swath::io
