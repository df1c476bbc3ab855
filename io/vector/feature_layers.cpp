// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/vector/feature_layers.h"

#include <gdal_priv.h>
#include <ogrsf_frmts.h>

#include <cmath>

#include "core/error.h"
#include "io/text/output_file.h"
#include "io/vector/gdal_door.h"

namespace swath::io {
namespace {

using Places = std::vector<Eigen::Vector2d>;

void set_points(OGRSimpleCurve& curve, const Places& places) {
  curve.setNumPoints(static_cast<int>(places.size()));
  for (size_t k = 0; k < places.size(); ++k) curve.setPoint(static_cast<int>(k), places[k].x(), places[k].y());
}

void set_shape(OGRFeature& feature, FeatureShape shape, const std::vector<Places>& parts) {
  if (shape == FeatureShape::point) {
    const OGRPoint point(parts.at(0).at(0).x(), parts[0][0].y());
    feature.SetGeometry(&point);
  } else if (shape == FeatureShape::line) {
    OGRLineString line;
    set_points(line, parts.at(0));
    feature.SetGeometry(&line);
  } else {
    OGRPolygon polygon;
    for (const Places& part : parts) {
      OGRLinearRing ring;
      set_points(ring, part);
      ring.closeRings();
      polygon.addRing(&ring);
    }
    feature.SetGeometry(&polygon);
  }
}

void write_layer(GDALDataset& set, const FeatureLayer& what, OGRSpatialReference* srs, const GdalMessages& messages,
                 const std::filesystem::path& file) {
  const std::string description = "DESCRIPTION=" + what.about;
  const char* const options[] = {"GEOMETRY_NAME=geom", "FID=fid", "SPATIAL_INDEX=YES", description.c_str(), nullptr};
  const OGRwkbGeometryType type = what.shape == FeatureShape::point  ? wkbPoint
                                  : what.shape == FeatureShape::line ? wkbLineString
                                                                     : wkbPolygon;
  OGRLayer* layer = set.CreateLayer(what.name.c_str(), srs, type, const_cast<char**>(options));
  if (!layer) messages.fail_writing(file);
  const auto add_fields = [&](const std::vector<std::string>& names, OGRFieldType kind) {
    for (const std::string& name : names) {
      OGRFieldDefn field(name.c_str(), kind);
      if (layer->CreateField(&field) != OGRERR_NONE) messages.fail_writing(file);
    }
  };
  add_fields(what.text_fields, OFTString);
  add_fields(what.number_fields, OFTReal);
  if (set.StartTransaction() != OGRERR_NONE) messages.fail_writing(file);
  const int texts = static_cast<int>(what.text_fields.size());
  for (const Feature& f : what.features) {
    OGRFeature feature(layer->GetLayerDefn());
    for (size_t k = 0; k < f.texts.size(); ++k) feature.SetField(static_cast<int>(k), f.texts[k].c_str());
    for (size_t k = 0; k < f.numbers.size(); ++k)
      if (std::isfinite(f.numbers[k])) feature.SetField(texts + static_cast<int>(k), f.numbers[k]);
    set_shape(feature, what.shape, f.parts);
    if (layer->CreateFeature(&feature) != OGRERR_NONE) messages.fail_writing(file);
  }
  if (set.CommitTransaction() != OGRERR_NONE) messages.fail_writing(file);
}

}  // namespace

void write_feature_layers(const std::filesystem::path& file, const std::vector<FeatureLayer>& layers, const std::string& crs) {
  const CrsFacts facts = crs_facts(crs);
  OutputFile out(file);
  const GdalMessages messages;
  const GdalSetting date{"OGR_CURRENT_DATE", "2000-01-01T00:00:00.000Z"};
  Dataset set = new_geopackage(out.temporary(), file, messages);
  OGRSpatialReference srs;
  if (!facts.empty) srs.SetFromUserInput(facts.horizontal_wkt.c_str());
  srs.SetAxisMappingStrategy(OAMS_TRADITIONAL_GIS_ORDER);
  for (const FeatureLayer& layer : layers) write_layer(*set, layer, facts.empty ? nullptr : &srs, messages, file);
  set.reset();
  messages.check_written(file);
  out.commit();
}

}  // namespace swath::io
