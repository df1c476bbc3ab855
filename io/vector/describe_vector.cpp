// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/vector/describe_vector.h"

#include <cpl_conv.h>
#include <gdal_priv.h>
#include <ogrsf_frmts.h>

#include <algorithm>
#include <fstream>
#include <limits>
#include <memory>
#include <string>

#include "core/error.h"
#include "core/geo/crs.h"
#include "io/vector/gdal_door.h"

namespace swath::io {
namespace {

using core::Value;

struct Range {
  double low = std::numeric_limits<double>::infinity(), high = -std::numeric_limits<double>::infinity();
  void add(double from, double to) {
    low = std::min(low, from);
    high = std::max(high, to);
  }
  bool any() const { return low <= high; }
  Value value() const { return Value(Value::Array{low, high}); }
};

void put_crs(OGRLayer& layer, Value& out, Value& warnings) {
  const OGRSpatialReference* srs = layer.GetSpatialRef();
  if (!srs || srs->IsLocal()) {
    warnings.push(std::string("layer ") + layer.GetName() + " states no CRS");
    return;
  }
  const char* const options[] = {"FORMAT=WKT2_2019", "MULTILINE=NO", nullptr};
  char* text = nullptr;
  std::string wkt;
  if (srs->exportToWkt(&text, options) == OGRERR_NONE && text) wkt = text;
  CPLFree(text);
  try {
    const core::Crs crs(wkt);
    out["crs"] = crs.name();
    if (crs.epsg()) out["epsg"] = crs.epsg();
    out["unit"] = crs.unit_name();
    out["heights"] = crs.vertical_name();
  } catch (const core::Error& e) {
    warnings.push(std::string("layer ") + layer.GetName() + ": the CRS is not known: " + e.what());
  }
}

Value describe_layer(OGRLayer& layer, Value& warnings) {
  Value out = Value::object();
  out["name"] = layer.GetName();
  Range x, y, z, field;
  std::uint64_t features = 0, empty = 0;
  const int height = layer.GetLayerDefn()->GetFieldIndex("height");
  std::string kinds;
  for (const auto& feature : layer) {
    ++features;
    if (height >= 0 && feature->IsFieldSetAndNotNull(height))
      field.add(feature->GetFieldAsDouble(height), feature->GetFieldAsDouble(height));
    const OGRGeometry* shape = feature->GetGeometryRef();
    if (!shape || shape->IsEmpty()) {
      ++empty;
      continue;
    }
    OGREnvelope3D box;
    shape->getEnvelope(&box);
    x.add(box.MinX, box.MaxX);
    y.add(box.MinY, box.MaxY);
    if (shape->Is3D()) z.add(box.MinZ, box.MaxZ);
    const std::string kind = shape->getGeometryName();
    if (kinds.find(kind) == std::string::npos) kinds += (kinds.empty() ? "" : ", ") + kind;
  }
  out["geometry"] = kinds.empty() ? std::string("none") : kinds;
  out["features"] = features;
  if (x.any()) out["x"] = x.value();
  if (y.any()) out["y"] = y.value();
  if (z.any()) out["z"] = z.value();
  if (field.any()) out["height"] = field.value();
  put_crs(layer, out, warnings);
  if (const char* about = layer.GetMetadataItem("DESCRIPTION"); about && *about) out["description"] = about;
  Value fields = Value::array();
  for (int k = 0; k < layer.GetLayerDefn()->GetFieldCount(); ++k) fields.push(layer.GetLayerDefn()->GetFieldDefn(k)->GetNameRef());
  if (!fields.items().empty()) out["fields"] = std::move(fields);
  const std::string name = layer.GetName();
  if (features == 0) warnings.push("layer " + name + " has no feature");
  if (empty > 0) warnings.push("layer " + name + " has " + std::to_string(empty) + " features without a geometry");
  return out;
}

/// The comments (group 999) that a DXF file begins with.
Value comments_of(const std::filesystem::path& path) {
  Value out = Value::array();
  std::ifstream in(path);
  std::string group, words;
  while (std::getline(in, group) && std::getline(in, words) && group.find("999") != std::string::npos) {
    if (!words.empty() && words.back() == '\r') words.pop_back();
    out.push(words);
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
  Value out = Value::object(), warnings = Value::array();
  out["format"] = driver == "GPKG" ? std::string("GeoPackage") : driver;
  if (driver == "DXF")
    if (Value words = comments_of(file); !words.items().empty()) out["comments"] = std::move(words);
  Value& layers = out["layers"] = Value::array();
  for (OGRLayer* layer : set->GetLayers()) layers.push(describe_layer(*layer, warnings));
  if (layers.items().empty()) warnings.push("the file has no layer");
  if (messages.failed()) warnings.push(messages.text());
  out["warnings"] = std::move(warnings);
  return out;
}

}  // namespace swath::io
