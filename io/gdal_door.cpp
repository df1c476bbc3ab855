// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/gdal_door.h"

#include <cpl_conv.h>
#include <cpl_error.h>
#include <gdal.h>
#include <gdal_priv.h>
#include <ogr_spatialref.h>

#include <cmath>
#include <fstream>
#include <mutex>
#include <string>

#include "core/crs.h"
#include "core/error.h"

namespace swath::io {
namespace {

void catch_message(CPLErr kind, CPLErrorNum, const char* message) {
  auto* messages = static_cast<GdalMessages*>(CPLGetErrorHandlerUserData());
  if (kind == CE_Debug || kind == CE_None || !messages) return;
  messages->note(kind >= CE_Failure, message);
}

/// Names as the unit type of GeoTIFF bands is written and as GIS show it.
std::string short_unit(const std::string& name, double si) {
  if (si == 1.0) return "m";
  if (std::abs(si - 0.3048) < 1e-12) return "ft";
  if (std::abs(si - 1200.0 / 3937.0) < 1e-12) return "US survey foot";
  return name;
}

constexpr const char* raster_drivers[] = {"GTiff", "COG", "VRT",     "AAIGrid", "GSBG", "GS7BG", "GTX",  "EHdr", "ENVI", "HFA",
                                          "NTv2",  "XYZ", "SRTMHGT", "USGSDEM", "DTED", "BIL",   "GPKG", "PNG",  "JPEG", nullptr};
constexpr const char* vector_drivers[] = {"GPKG", "ESRI Shapefile", "GeoJSON",      "GeoJSONSeq", "DXF", "CSV",
                                          "KML",  "FlatGeobuf",     "MapInfo File", nullptr};

/// Whether a virtual raster names a source that is no plain file: an address, or one of GDAL's file systems.
bool names_elsewhere(const std::filesystem::path& file) {
  std::ifstream in(file, std::ios::binary);
  std::string text(std::size_t{1} << 16, '\0');
  in.read(text.data(), static_cast<std::streamsize>(text.size()));
  text.resize(static_cast<std::size_t>(in.gcount()));
  if (text.find("<VRTDataset") == std::string::npos) return false;
  in.clear();
  text.append(std::istreambuf_iterator<char>(in), {});
  return text.find("/vsi") != std::string::npos || text.find("://") != std::string::npos || text.find("<GDAL_") != std::string::npos;
}

GDALDataset* open_plain(const std::filesystem::path& file, unsigned kind, const char* const* drivers) {
  std::error_code ec;
  if (!std::filesystem::is_regular_file(file, ec) || names_elsewhere(file)) return nullptr;
  return GDALDataset::Open(file.c_str(), kind | GDAL_OF_READONLY, drivers);
}

std::string wkt2(const OGRSpatialReference& srs) {
  const char* const options[] = {"FORMAT=WKT2_2019", "MULTILINE=NO", nullptr};
  char* text = nullptr;
  std::string out;
  if (srs.exportToWkt(&text, options) == OGRERR_NONE && text) out = text;
  CPLFree(text);
  return out;
}

}  // namespace

GdalMessages::GdalMessages() {
  static std::once_flag once;
  std::call_once(once, [] { GDALAllRegister(); });
  CPLPushErrorHandlerEx(catch_message, this);
}

GdalMessages::~GdalMessages() { CPLPopErrorHandler(); }

void GdalMessages::note(bool failure, const char* message) {
  if (text_.empty() || (failure && !failed_)) text_ = message;
  failed_ = failed_ || failure;
}

void GdalMessages::fail(const std::string& doing, const std::filesystem::path& file, std::string hint) const {
  std::error_code ec;
  const auto folder = file.has_parent_path() ? file.parent_path() : std::filesystem::path(".");
  const auto space = std::filesystem::space(folder, ec);
  constexpr std::uintmax_t nearly_nothing = 1u << 20;  // bytes
  const bool full = text_.find("No space left") != std::string::npos || (!ec && space.available < nearly_nothing);
  if (full && hint.empty()) hint = "the disk is full: free space there, then run the same command again; what is finished is kept";
  throw core::Error(text_.empty() ? doing : doing + ": " + text_, file.string(), hint);
}

void GdalMessages::check(const std::string& doing, const std::filesystem::path& file) const {
  if (failed_) fail(doing, file);
}

GDALDataset* open_raster(const std::filesystem::path& file) { return open_plain(file, GDAL_OF_RASTER, raster_drivers); }
GDALDataset* open_vector(const std::filesystem::path& file) { return open_plain(file, GDAL_OF_VECTOR, vector_drivers); }

GdalSetting::GdalSetting(const char* key, const char* value) : key_(key) {
  if (const char* before = CPLGetThreadLocalConfigOption(key, nullptr)) {
    had_ = true;
    before_ = before;
  }
  CPLSetThreadLocalConfigOption(key, value);
}

GdalSetting::~GdalSetting() { CPLSetThreadLocalConfigOption(key_.c_str(), had_ ? before_.c_str() : nullptr); }

CrsFacts crs_facts(const std::string& text) {
  CrsFacts facts;
  if (text.empty()) return facts;
  const core::Crs crs(text);
  const GdalMessages messages;
  OGRSpatialReference srs;
  facts.wkt = crs.wkt();
  if (srs.importFromWkt(facts.wkt.c_str()) != OGRERR_NONE)
    throw core::Error("GDAL does not know the CRS" + (messages.text().empty() ? "" : ": " + messages.text()), text);
  srs.SetAxisMappingStrategy(OAMS_TRADITIONAL_GIS_ORDER);
  facts.axis_mapping.clear();
  for (const int axis : srs.GetDataAxisToSRSAxisMapping())
    facts.axis_mapping += (facts.axis_mapping.empty() ? "" : ",") + std::to_string(axis);
  facts.empty = false;
  facts.geographic = crs.is_geographic();
  facts.ellipsoidal = crs.heights() == core::Heights::ellipsoidal;
  facts.name = crs.name();
  facts.unit = facts.geographic ? "degree" : short_unit(crs.unit_name(), crs.metres_per_unit());
  facts.vertical_unit = short_unit(crs.vertical_unit_name(), crs.vertical_metres_per_unit());
  facts.vertical_name = crs.vertical_name();
  srs.StripVertical();
  srs.DemoteTo2D(nullptr);
  facts.horizontal_wkt = wkt2(srs);
  return facts;
}

}  // namespace swath::io
