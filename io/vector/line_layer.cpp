// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/vector/line_layer.h"

#include <gdal_priv.h>
#include <ogrsf_frmts.h>

#include "core/error.h"
#include "io/text/output_file.h"
#include "io/vector/gdal_door.h"

namespace swath::io {

void write_line_layer(const std::filesystem::path& file, const LineLayer& what, const std::string& crs) {
  const CrsFacts facts = crs_facts(crs);
  OutputFile out(file);
  std::filesystem::remove(out.temporary());  // the driver makes only files that are not there yet
  const GdalMessages messages;
  const GdalSetting date{"OGR_CURRENT_DATE", "2000-01-01T00:00:00.000Z"};
  GDALDriver* driver = GetGDALDriverManager()->GetDriverByName("GPKG");
  if (!driver) throw core::Error("this GDAL has no GeoPackage driver", file.string());
  const char* const creation[] = {"VERSION=1.2", nullptr};
  Dataset set(driver->Create(out.temporary().c_str(), 0, 0, 0, GDT_Unknown, const_cast<char**>(creation)));
  if (!set) messages.fail_writing(file);
  OGRSpatialReference srs;
  if (!facts.empty) srs.SetFromUserInput(facts.horizontal_wkt.c_str());
  srs.SetAxisMappingStrategy(OAMS_TRADITIONAL_GIS_ORDER);
  const std::string description = "DESCRIPTION=" + what.about;
  const char* const options[] = {"GEOMETRY_NAME=geom", "FID=fid", "SPATIAL_INDEX=YES", description.c_str(), nullptr};
  OGRLayer* layer = set->CreateLayer(what.name.c_str(), facts.empty ? nullptr : &srs, what.are_areas ? wkbPolygon : wkbLineString,
                                     const_cast<char**>(options));
  if (!layer) messages.fail_writing(file);
  OGRFieldDefn name("name", OFTString);
  if (layer->CreateField(&name) != OGRERR_NONE) messages.fail_writing(file);
  const auto add_fields = [&](const std::vector<std::string>& fields, OGRFieldType type) {
    for (const std::string& f : fields) {
      OGRFieldDefn field(f.c_str(), type);
      if (layer->CreateField(&field) != OGRERR_NONE) messages.fail_writing(file);
    }
  };
  add_fields(what.fields, OFTReal);
  add_fields(what.text_fields, OFTString);
  if (set->StartTransaction() != OGRERR_NONE) messages.fail_writing(file);
  for (const LineFeature& l : what.lines) {
    OGRFeature feature(layer->GetLayerDefn());
    feature.SetField(0, l.name.c_str());
    for (size_t k = 0; k < l.numbers.size(); ++k) feature.SetField(static_cast<int>(k) + 1, l.numbers[k]);
    for (size_t k = 0; k < l.texts.size(); ++k) feature.SetField(static_cast<int>(l.numbers.size() + k) + 1, l.texts[k].c_str());
    OGRLinearRing shape;
    shape.setPoints(static_cast<int>(l.x.size()), l.x.data(), l.y.data());
    if (what.are_areas) {
      OGRPolygon area;
      area.addRing(&shape);
      feature.SetGeometry(&area);
    } else {
      feature.SetGeometry(std::make_unique<OGRLineString>(shape).get());
    }
    if (layer->CreateFeature(&feature) != OGRERR_NONE) messages.fail_writing(file);
  }
  if (set->CommitTransaction() != OGRERR_NONE) messages.fail_writing(file);
  set.reset();
  messages.check_written(file);
  out.commit();
}

}  // namespace swath::io
