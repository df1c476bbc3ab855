// SPDX-License-Identifier: GPL-3.0-or-later
// What every use of GDAL in this room shares: drivers registered once, messages caught, CRS texts understood.
#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <string>

#include "core/geo/crs.h"

class GDALDataset;
class OGRFeature;
class OGRFeatureDefn;
class OGRSpatialReference;

namespace swath::io {

/// Catches GDAL's messages on this thread as long as it lives (nothing is printed) and registers GDAL's drivers.
class GdalMessages {
 public:
  GdalMessages();
  ~GdalMessages();
  GdalMessages(const GdalMessages&) = delete;
  GdalMessages& operator=(const GdalMessages&) = delete;

  bool failed() const { return failed_; }
  /// The first failure's text, or the first warning's; empty where GDAL said nothing.
  const std::string& text() const { return text_; }
  void note(bool failure, const char* message);
  /// Throws core::Error "doing: GDAL's text" for `file`.
  [[noreturn]] void fail(const std::string& doing, const std::filesystem::path& file, const std::string& hint = {}) const;
  /// fail() where GDAL reported a failure.
  void check(const std::string& doing, const std::filesystem::path& file) const;
  /// For a file that is being written: throws core::SystemError, with a hint where the disk is full.
  [[noreturn]] void fail_writing(const std::filesystem::path& file, const std::string& why = {}) const;
  /// fail_writing() where GDAL reported a failure.
  void check_written(const std::filesystem::path& file) const;

 private:
  bool failed_ = false;
  std::string text_;
};

struct CloseDataset {
  void operator()(GDALDataset* dataset) const;
};
using Dataset = std::unique_ptr<GDALDataset, CloseDataset>;

/// A file of a format that this program reads, opened for reading, or nothing. GDAL's other drivers are left out: some take any text for
/// a request to a server, or read files that the text names.
Dataset open_raster(const std::filesystem::path& file);
Dataset open_vector(const std::filesystem::path& file);
/// A file that open_vector() takes; throws core::Error "cannot read `what`" for any other, with `if_absent` for one that is not there.
Dataset required_vector(const std::filesystem::path& file, const GdalMessages& messages, const std::string& what = "the vector file",
                        const std::string& if_absent = "check the name");
/// Whether the feature's field "Layer" says `layer`, as GDAL gives the layers of a DXF file.
bool is_of_layer(OGRFeature& feature, const std::string& layer);
/// The field `stated`, or where that is empty `height`, `elev`, `elevation`, `contour` or `z`; -1 where there is none.
int height_field(const OGRFeatureDefn& fields, const std::string& stated);

/// The field as a number, also where its type is text; nothing where it is not set or is text that is not a number, which GDAL would take
/// for 0 or cut at a decimal comma. `field` may be -1.
std::optional<double> number_of(const OGRFeature& feature, int field);

/// An empty GeoPackage 1.2 in place of `temporary`, for the product `file`, which messages name. Throws core::Error.
Dataset new_geopackage(const std::filesystem::path& temporary, const std::filesystem::path& file, const GdalMessages& messages);

/// A setting of GDAL on this thread as long as the object lives.
class GdalSetting {
 public:
  GdalSetting(const char* key, const char* value);
  ~GdalSetting();
  GdalSetting(const GdalSetting&) = delete;
  GdalSetting& operator=(const GdalSetting&) = delete;

 private:
  std::string key_, before_;
  bool had_ = false;
};

/// What a CRS text ("EPSG:25832+7837", WKT, PROJ text) says of coordinates and heights.
struct CrsFacts {
  bool empty = true;                                 ///< no CRS: units unknown
  bool geographic = false;                           ///< horizontal axes in degrees
  bool ellipsoidal = false;                          ///< three axes: heights are ellipsoidal
  std::string wkt;                                   ///< WKT2:2019, whole
  std::string horizontal_wkt;                        ///< WKT2:2019 without the vertical part
  std::string axis_mapping = "1,2";                  ///< which CRS axes easting and northing are ("2,1" where the CRS puts northing first)
  std::string name;                                  ///< of the whole CRS
  std::string unit = "unknown";                      ///< of the horizontal axes: "m", "ft", "ftUS", "degree", ...
  std::string vertical_unit = "m";                   ///< of heights; "unknown unit" where a CRS in feet does not say
  std::string vertical_name{core::unknown_heights};  ///< name of the vertical datum, "ellipsoidal height", or that none is stated
};

/// WKT2:2019; empty where GDAL has none for it.
std::string wkt2(const OGRSpatialReference& srs);
/// The same of what a file states; empty where it states nothing, or says so (a local system, GeoPackage's "Undefined").
std::string stated_wkt(const OGRSpatialReference* srs);

/// Throws core::Error where PROJ does not know the text.
CrsFacts crs_facts(const std::string& crs);

}  // namespace swath::io
