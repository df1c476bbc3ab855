// SPDX-License-Identifier: GPL-3.0-or-later
// GeoPackage 1.2 (OGC 12-128r15) through GDAL. The layers' CRS is the horizontal part alone: LineStrings are flat and a height is a field,
// which every GIS labels and styles by. gpkg_contents.last_change is set to a constant, so that equal contours are equal bytes.
#include <gdal_priv.h>
#include <ogrsf_frmts.h>

#include <utility>
#include <vector>

#include "core/config/units.h"
#include "core/error.h"
#include "io/vector/height_statement.h"
#include "io/vector/vector_sink.h"

namespace swath::io {
namespace {

constexpr const char* constant_date = "2000-01-01T00:00:00.000Z";
constexpr int features_per_transaction = 20000;

class GpkgSink : public ContourSink {
 public:
  GpkgSink(const std::filesystem::path& file, const CrsFacts& crs) : file_(file), out_(file) {
    const Scope scope;
    set_ = new_geopackage(out_.temporary(), file_, scope.messages).release();
    try {
      make_layers(crs, scope);
    } catch (...) {
      drop();
      throw;
    }
  }

  ~GpkgSink() override { drop(); }

  void add(const core::ContourLine& line) override {
    const Scope scope;
    OGRFeature feature(layer_->GetLayerDefn());
    feature.SetField(0, line.height);
    feature.SetField(1, line.index ? 1 : 0);
    feature.SetField(2, line.closed ? 1 : 0);
    feature.SetField(3, line.depression ? 1 : 0);
    OGRLineString shape;
    shape.setPoints(static_cast<int>(line.x.size()), line.x.data(), line.y.data());
    feature.SetGeometry(&shape);
    write(*layer_, feature, scope);
  }

  void add(const core::ContourLabel& label) override {
    const Scope scope;
    OGRFeature feature(labels_->GetLayerDefn());
    feature.SetField(0, label.text.c_str());
    feature.SetField(1, label.height);
    feature.SetField(2, core::to_degrees(label.rotation));
    feature.SetField(3, label.text_height);
    const OGRPoint shape(label.x, label.y);
    feature.SetGeometry(&shape);
    write(*labels_, feature, scope);
  }

  void add(const core::SpotHeight& spot) override {
    const Scope scope;
    OGRFeature feature(spots_->GetLayerDefn());
    feature.SetField(0, spot.height);
    feature.SetField(1, spot.text.c_str());
    feature.SetField(2, spot.top ? "top" : "pit");
    const OGRPoint shape(spot.x, spot.y);
    feature.SetGeometry(&shape);
    write(*spots_, feature, scope);
  }

  void close() override {
    const Scope scope;
    if (set_->CommitTransaction() != OGRERR_NONE) scope.messages.fail_writing(file_);
    GDALClose(std::exchange(set_, nullptr));
    remove_side_files();
    scope.messages.check_written(file_);
    out_.commit();
  }

 private:
  struct Scope {
    GdalMessages messages;
    GdalSetting date{"OGR_CURRENT_DATE", constant_date};
    GdalSetting speed{"OGR_SQLITE_SYNCHRONOUS", "OFF"};  // the whole file is flushed once, before it gets its name
  };

  void write(OGRLayer& layer, OGRFeature& feature, const Scope& scope) {
    if (layer.CreateFeature(&feature) != OGRERR_NONE) scope.messages.fail_writing(file_);
    if (++pending_ < features_per_transaction) return;
    if (set_->CommitTransaction() != OGRERR_NONE || set_->StartTransaction() != OGRERR_NONE) scope.messages.fail_writing(file_);
    pending_ = 0;
  }

  struct FieldKind {
    const char* name;
    OGRFieldType type;
    OGRFieldSubType subtype = OFSTNone;
  };

  OGRLayer* make_layer(const char* name, const std::string& about, OGRwkbGeometryType type, const std::vector<FieldKind>& fields,
                       const CrsFacts& crs, const Scope& scope) {
    OGRSpatialReference srs;
    if (!crs.empty) srs.SetFromUserInput(crs.horizontal_wkt.c_str());
    srs.SetAxisMappingStrategy(OAMS_TRADITIONAL_GIS_ORDER);
    const std::string description = "DESCRIPTION=" + about + heights_statement(crs);
    const char* const options[] = {"GEOMETRY_NAME=geom", "FID=fid", "SPATIAL_INDEX=YES", description.c_str(), nullptr};
    OGRLayer* layer = set_->CreateLayer(name, crs.empty ? nullptr : &srs, type, const_cast<char**>(options));
    if (!layer) scope.messages.fail_writing(file_);
    for (const FieldKind& kind : fields) {
      OGRFieldDefn field(kind.name, kind.type);
      field.SetSubType(kind.subtype);
      if (layer->CreateField(&field) != OGRERR_NONE) scope.messages.fail_writing(file_);
    }
    return layer;
  }

  void make_layers(const CrsFacts& crs, const Scope& scope) {
    const auto real = [](const char* field) { return FieldKind{field, OFTReal}; };
    const auto text = [](const char* field) { return FieldKind{field, OFTString}; };
    const auto boolean = [](const char* field) { return FieldKind{field, OFTInteger, OFSTBoolean}; };
    layer_ = make_layer("contours", "Contours", wkbLineString, {real("height"), boolean("index"), boolean("closed"), boolean("depression")},
                        crs, scope);
    labels_ = make_layer("labels", "Heights along index contours, rotation in degrees counter-clockwise from east", wkbPoint,
                         {text("text"), real("height"), real("rotation"), real("text_height")}, crs, scope);
    spots_ = make_layer("spot_heights", "Tops and pits", wkbPoint, {real("height"), text("text"), text("kind")}, crs, scope);
    if (set_->StartTransaction() != OGRERR_NONE) scope.messages.fail_writing(file_);
  }

  /// Lets go of an unfinished file.
  void drop() noexcept {
    if (!set_) return;
    const Scope scope;
    GDALClose(std::exchange(set_, nullptr));
    remove_side_files();
  }

  /// What SQLite may leave beside a file that could not be finished.
  void remove_side_files() noexcept {
    std::error_code ignored;
    for (const char* ending : {"-journal", "-wal", "-shm"}) std::filesystem::remove(out_.temporary().string() + ending, ignored);
  }

  std::filesystem::path file_;
  OutputFile out_;
  GDALDataset* set_ = nullptr;
  OGRLayer *layer_ = nullptr, *labels_ = nullptr, *spots_ = nullptr;
  int pending_ = 0;
};

}  // namespace

std::unique_ptr<ContourSink> make_gpkg_sink(const std::filesystem::path& file, const CrsFacts& crs) {
  return std::make_unique<GpkgSink>(file, crs);
}

}  // namespace swath::io
