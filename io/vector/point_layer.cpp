// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/vector/point_layer.h"

#include <gdal_priv.h>
#include <ogrsf_frmts.h>

#include <cmath>

#include "core/error.h"
#include "io/text/output_file.h"
#include "io/vector/gdal_door.h"

namespace swath::io {
namespace {

constexpr int points_per_transaction = 20000;

void add_point(OGRLayer& layer, const NamedPoint& p, size_t fields, const GdalMessages& messages, const std::filesystem::path& file) {
  if (p.values.size() != fields) throw core::Error("a point has another number of values than the layer has fields", file.string());
  OGRFeature feature(layer.GetLayerDefn());
  feature.SetField(0, p.name.c_str());
  feature.SetField(1, p.kind.c_str());
  for (size_t k = 0; k < p.values.size(); ++k)
    if (std::isfinite(p.values[k])) feature.SetField(static_cast<int>(k) + 2, p.values[k]);
  const OGRPoint shape(p.position.x(), p.position.y(), p.position.z());
  feature.SetGeometry(&shape);
  if (layer.CreateFeature(&feature) != OGRERR_NONE) messages.fail_writing(file);
}

}  // namespace

void write_point_layer(const std::filesystem::path& file, const std::string& layer_name, const std::string& crs,
                       const std::vector<std::string>& fields, const std::vector<NamedPoint>& points) {
  OutputFile out(file);
  const GdalMessages messages;
  const GdalSetting date("OGR_CURRENT_DATE", "2000-01-01T00:00:00.000Z"), speed("OGR_SQLITE_SYNCHRONOUS", "OFF");
  Dataset set = new_geopackage(out.temporary(), file, messages);
  OGRSpatialReference srs;
  if (!crs.empty()) {
    const CrsFacts facts = crs_facts(crs);
    const bool flat = facts.ellipsoidal && !facts.geographic;  // a GeoPackage has no projection with three axes
    srs.SetFromUserInput(flat ? facts.horizontal_wkt.c_str() : facts.wkt.c_str());
  }
  srs.SetAxisMappingStrategy(OAMS_TRADITIONAL_GIS_ORDER);
  const char* const options[] = {"GEOMETRY_NAME=geom", "FID=fid", "SPATIAL_INDEX=YES", nullptr};
  OGRLayer* layer = set->CreateLayer(layer_name.c_str(), crs.empty() ? nullptr : &srs, wkbPoint25D, const_cast<char**>(options));
  if (!layer) messages.fail_writing(file);
  OGRFieldDefn name("name", OFTString), kind("kind", OFTString);
  if (layer->CreateField(&name) != OGRERR_NONE || layer->CreateField(&kind) != OGRERR_NONE) messages.fail_writing(file);
  for (const std::string& f : fields) {
    OGRFieldDefn field(f.c_str(), OFTReal);
    if (layer->CreateField(&field) != OGRERR_NONE) messages.fail_writing(file);
  }
  set->StartTransaction();
  int pending = 0;
  for (const NamedPoint& p : points) {
    add_point(*layer, p, fields.size(), messages, file);
    if (++pending < points_per_transaction) continue;
    if (set->CommitTransaction() != OGRERR_NONE || set->StartTransaction() != OGRERR_NONE) messages.fail_writing(file);
    pending = 0;
  }
  if (set->CommitTransaction() != OGRERR_NONE) messages.fail_writing(file);
  set.reset();
  messages.check_written(file);
  out.commit();
}

}  // namespace swath::io
