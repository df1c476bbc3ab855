// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/vector/spot_file.h"

#include <gdal_priv.h>
#include <ogrsf_frmts.h>

#include <cmath>
#include <string_view>

#include "io/vector/gdal_door.h"

namespace swath::io {
namespace {

constexpr std::string_view contour_labels = "labels";  // of contours that this program wrote: on their lines, no heights of their own

/// DXF texts come as points.
bool is_text(OGRFeature& feature) {
  const int classes = feature.GetFieldIndex("SubClasses"), text = feature.GetFieldIndex("Text");
  if (classes < 0) return false;
  return std::string_view(feature.GetFieldAsString(classes)).find("Text") != std::string_view::npos ||
         (text >= 0 && feature.IsFieldSetAndNotNull(text) && *feature.GetFieldAsString(text) != '\0');
}

void add_points(const OGRGeometry& shape, double height, SpotFile& to) {
  const auto type = wkbFlatten(shape.getGeometryType());
  if (type == wkbPoint) {
    const OGRPoint& p = *shape.toPoint();
    const double z = std::isnan(height) && shape.Is3D() ? p.getZ() : height;
    if (!std::isfinite(p.getX()) || !std::isfinite(p.getY()) || !std::isfinite(z)) {
      ++to.without_height;
      return;
    }
    to.x.push_back(p.getX()), to.y.push_back(p.getY()), to.z.push_back(z);
  } else if (OGR_GT_IsSubClassOf(type, wkbGeometryCollection)) {
    for (const OGRGeometry* part : *shape.toGeometryCollection()) add_points(*part, height, to);
  }
}

}  // namespace

SpotFile spots_in(GDALDataset& set, const std::string& field) {
  SpotFile out;
  for (OGRLayer* layer : set.GetLayers()) {
    if (contour_labels == layer->GetName()) continue;
    if (const OGRSpatialReference* srs = layer->GetSpatialRef(); srs && out.crs_wkt.empty()) out.crs_wkt = wkt2(*srs);
    const int at = height_field(*layer->GetLayerDefn(), field);
    for (const auto& feature : *layer) {
      const OGRGeometry* shape = feature->GetGeometryRef();
      if (!shape || shape->IsEmpty() || is_text(*feature)) continue;
      add_points(*shape, number_of(*feature, at).value_or(std::nan("")), out);
    }
  }
  return out;
}

}  // namespace swath::io
