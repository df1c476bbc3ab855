// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/vector/gdal_door.h"

#include <cpl_conv.h>
#include <cpl_error.h>
#include <cpl_minixml.h>
#include <gdal.h>
#include <gdal_priv.h>
#include <ogr_feature.h>
#include <ogr_spatialref.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <fstream>
#include <memory>
#include <mutex>
#include <string>
#include <string_view>
#include <utility>

#include "core/error.h"
#include "core/geo/crs.h"
#include "core/geo/height_unit.h"
#include "core/printable.h"
#include "io/store/address.h"
#include "io/store/object.h"
#include "io/text/output_file.h"

namespace swath::io {
namespace {

void catch_message(CPLErr kind, CPLErrorNum, const char* message) {
  auto* messages = static_cast<GdalMessages*>(CPLGetErrorHandlerUserData());
  if (kind == CE_Debug || kind == CE_None || !messages) return;
  messages->note(kind >= CE_Failure, message);
}

constexpr const char* raster_drivers[] = {"GTiff", "VRT", "AAIGrid", "GSBG",    "GS7BG", "GTX",  "EHdr", "ENVI", "HFA",
                                          "NTv2",  "XYZ", "SRTMHGT", "USGSDEM", "DTED",  "GPKG", "PNG",  "JPEG", nullptr};
constexpr const char* vector_drivers[] = {"GPKG", "ESRI Shapefile", "GeoJSON",      "GeoJSONSeq", "DXF", "CSV",
                                          "KML",  "FlatGeobuf",     "MapInfo File", nullptr};
constexpr const char* stored_raster_drivers[] = {"GTiff", nullptr};  // without files beside them, and naming no others
constexpr double megabyte = 1048576, largest_block = 250 * megabyte;
constexpr const char* other_drivers[] = {"COG", "MEM", "Memory", nullptr};  // for writing
constexpr const char* formats_read =
    "GeoTIFF, VRT of local files, Arc/Info ASCII grid, GTX, EHdr, ENVI, Erdas Imagine, XYZ, SRTM, DTED, GeoPackage, shapefile, GeoJSON, "
    "DXF, CSV, KML, FlatGeobuf and MapInfo are read";

bool listed(const char* const* names, const char* name) {
  for (; *names; ++names)
    if (EQUAL(*names, name)) return true;
  return false;
}

/// GDAL with the drivers of known formats alone, whatever a file that it opens names, and without fetching.
void register_drivers() {
  GDALAllRegister();
  GDALDriverManager& manager = *GetGDALDriverManager();
  for (int i = manager.GetDriverCount() - 1; i >= 0; --i) {
    GDALDriver* driver = manager.GetDriver(i);
    const char* name = driver->GetDescription();
    if (listed(raster_drivers, name) || listed(vector_drivers, name) || listed(other_drivers, name)) continue;
    manager.DeregisterDriver(driver);
    delete driver;
  }
  CPLSetConfigOption("CPL_VSIL_CURL_ALLOWED_EXTENSIONS", ".none");
}

bool names_elsewhere(const CPLXMLNode* node, int depth = 0) {
  constexpr int deepest = 100;
  if (depth > deepest) return true;
  for (; node; node = node->psNext) {
    const bool source = node->eType == CXT_Element && (EQUAL(node->pszValue, "SourceFilename") || EQUAL(node->pszValue, "SourceDataset"));
    const std::string_view name = source ? CPLGetXMLValue(node, nullptr, "") : "";
    if (name.starts_with("/vsi") || name.find("://") != std::string_view::npos || name.starts_with('<')) return true;
    if (names_elsewhere(node->psChild, depth + 1)) return true;
  }
  return false;
}

/// Whether a virtual raster names a source that is no plain file: an address, or one of GDAL's file systems.
bool names_elsewhere(const std::filesystem::path& file) {
  std::ifstream in(file, std::ios::binary);
  std::string start(std::size_t{1} << 12, '\0');
  in.read(start.data(), static_cast<std::streamsize>(start.size()));
  if (start.find("<VRTDataset") == std::string::npos) return false;
  const std::unique_ptr<CPLXMLNode, decltype(&CPLDestroyXMLNode)> tree(CPLParseXMLFile(file.c_str()), &CPLDestroyXMLNode);
  return names_elsewhere(tree.get());
}

/// What GDAL takes for a DXF: by the name's ending, or by "0", "SECTION".
bool looks_like_dxf(const std::filesystem::path& file) {
  if (core::lower_case(file.extension().string()) == ".dxf") return true;
  std::string start(1024, '\0');
  std::ifstream in(file, std::ios::binary);
  in.read(start.data(), static_cast<std::streamsize>(start.size()));
  return core::lower_case(start).find("section") != std::string::npos && start.find('0') != std::string::npos;
}

/// No text has such a byte, and GDAL's reader of DXF may read on for ever where it meets one.
bool holds_zero_byte(const std::filesystem::path& file) {
  std::ifstream in(file, std::ios::binary);
  std::string part(std::size_t{1} << 16, '\1');
  while (in.read(part.data(), static_cast<std::streamsize>(part.size())), in.gcount() > 0)
    if (part.find('\0') < static_cast<std::size_t>(in.gcount())) return true;
  return false;
}

/// Why the file is not to be opened; empty where it may.
std::string refusal_of(const std::filesystem::path& file) {
  std::error_code ec;
  if (std::filesystem::is_directory(file, ec)) return "it is a folder";
  if (!std::filesystem::exists(file, ec)) return "no such file";
  if (!std::filesystem::is_regular_file(file, ec)) return "it is not a regular file";
  if (looks_like_dxf(file) && holds_zero_byte(file)) return "a DXF is text, and this file has bytes of 0: it is damaged, or a binary DXF";
  return names_elsewhere(file) ? "the virtual raster names sources that are no local files" : "";
}

/// A raster at the address that the user states: nothing else is opened on its account.
Dataset open_stored(const std::filesystem::path& address) {
  const StoredObject object(address);  // says in our words what is wrong
  const OpenAddress open(address);
  Dataset opened;
  std::string fault;
  {
    const GdalMessages messages;
    opened.reset(GDALDataset::Open(gdal_name(address).c_str(), GDAL_OF_RASTER | GDAL_OF_READONLY, stored_raster_drivers));
    fault = messages.text().empty() ? "it is not a GeoTIFF, the one raster that is read from a store" : messages.text();
  }
  if (!opened) CPLError(CE_Failure, CPLE_OpenFailed, "%s", fault.c_str());
  return opened;
}

Dataset open_plain(const std::filesystem::path& file, unsigned kind, const char* const* drivers) {
  Dataset opened;
  std::string fault = refusal_of(file);
  if (fault.empty()) {
    const GdalMessages messages;
    opened.reset(GDALDataset::Open(file.c_str(), kind | GDAL_OF_READONLY, drivers));
    fault = messages.text().empty() ? std::string("the format is not known; ") + formats_read : messages.text();
  }
  if (!opened) CPLError(CE_Failure, CPLE_OpenFailed, "%s", fault.c_str());
  return opened;
}

/// Bytes of the largest block, which GDAL holds whole to read one value; where bands are interleaved by pixel it holds those of all.
double block_bytes(GDALDataset& raster) {
  const char* order = raster.GetMetadataItem("INTERLEAVE", "IMAGE_STRUCTURE");
  const bool together = order && EQUAL(order, "PIXEL");
  double largest = 0;
  for (int b = 1; b <= raster.GetRasterCount(); ++b) {
    GDALRasterBand& band = *raster.GetRasterBand(b);
    int nx = 0, ny = 0;
    band.GetBlockSize(&nx, &ny);
    largest = std::max(largest, static_cast<double>(nx) * ny * GDALGetDataTypeSizeBytes(band.GetRasterDataType()));
  }
  return together ? largest * raster.GetRasterCount() : largest;
}

}  // namespace

GdalMessages::GdalMessages() {
  static std::once_flag once;
  std::call_once(once, register_drivers);
  CPLPushErrorHandlerEx(catch_message, this);
}

GdalMessages::~GdalMessages() { CPLPopErrorHandler(); }

void GdalMessages::note(bool failure, const char* message) {
  if (text_.empty() || (failure && !failed_)) text_ = without_access(message);
  failed_ = failed_ || failure;
}

void GdalMessages::fail(const std::string& doing, const std::filesystem::path& file, const std::string& hint) const {
  throw core::Error(text_.empty() ? doing : doing + ": " + text_, file.string(), hint);
}

void GdalMessages::check(const std::string& doing, const std::filesystem::path& file) const {
  if (failed_) fail(doing, file);
}

void GdalMessages::fail_writing(const std::filesystem::path& file, const std::string& why) const {
  throw_write_error("cannot write" + (why.empty() ? "" : ": " + why) + (text_.empty() ? "" : ": " + text_), file);
}

void GdalMessages::check_written(const std::filesystem::path& file) const {
  if (failed_) fail_writing(file);
}

void CloseDataset::operator()(GDALDataset* dataset) const { GDALClose(dataset); }

Dataset open_raster(const std::filesystem::path& file) {
  Dataset opened = is_address(file) ? open_stored(file) : open_plain(file, GDAL_OF_RASTER, raster_drivers);
  if (const double bytes = opened ? block_bytes(*opened) : 0; bytes > largest_block) {
    CPLError(CE_Failure, CPLE_OpenFailed, "one block of the raster takes %.0f MB in memory, at most %.0f MB are read", bytes / megabyte,
             largest_block / megabyte);
    opened.reset();
  }
  return opened;
}
Dataset open_vector(const std::filesystem::path& file) { return open_plain(file, GDAL_OF_VECTOR, vector_drivers); }

Dataset required_vector(const std::filesystem::path& file, const GdalMessages& messages, const std::string& what,
                        const std::string& if_absent) {
  Dataset set = open_vector(file);
  if (!set) messages.fail("cannot read " + what, file, std::filesystem::exists(file) ? "" : if_absent);
  return set;
}

bool is_of_layer(OGRFeature& feature, const std::string& layer) {
  const int field = feature.GetFieldIndex("Layer");
  return field >= 0 && layer == feature.GetFieldAsString(field);
}

std::optional<double> number_of(const OGRFeature& feature, int field) {
  if (field < 0 || !feature.IsFieldSetAndNotNull(field)) return std::nullopt;
  if (feature.GetFieldDefnRef(field)->GetType() != OFTString) return feature.GetFieldAsDouble(field);
  constexpr const char* blanks = " \t";
  std::string_view text = feature.GetFieldAsString(field);
  text.remove_prefix(std::min(text.find_first_not_of(blanks), text.size()));
  text.remove_suffix(text.size() - (text.find_last_not_of(blanks) + 1));
  if (text.starts_with('+')) text.remove_prefix(1);
  double value = 0.0;
  const auto [end, code] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (text.empty() || code != std::errc() || end != text.data() + text.size()) return std::nullopt;
  return value;
}

int height_field(const OGRFeatureDefn& fields, const std::string& stated) {
  if (!stated.empty()) return fields.GetFieldIndex(stated.c_str());
  for (const char* name : {"height", "elev", "elevation", "contour", "z"})
    if (const int at = fields.GetFieldIndex(name); at >= 0) return at;  // regardless of case
  return -1;
}

Dataset new_geopackage(const std::filesystem::path& temporary, const std::filesystem::path& file, const GdalMessages& messages) {
  std::filesystem::remove(temporary);  // the driver makes only files that are not there yet
  GDALDriver* driver = GetGDALDriverManager()->GetDriverByName("GPKG");
  if (!driver) throw core::Error("this GDAL has no GeoPackage driver", file.string());
  const char* const creation[] = {"VERSION=1.2", nullptr};
  Dataset set(driver->Create(temporary.c_str(), 0, 0, 0, GDT_Unknown, const_cast<char**>(creation)));
  if (!set) messages.fail_writing(file);
  return set;
}

GdalSetting::GdalSetting(const char* key, const char* value) : key_(key) {
  if (const char* before = CPLGetThreadLocalConfigOption(key, nullptr)) {
    had_ = true;
    before_ = before;
  }
  CPLSetThreadLocalConfigOption(key, value);
}

GdalSetting::~GdalSetting() { CPLSetThreadLocalConfigOption(key_.c_str(), had_ ? before_.c_str() : nullptr); }

std::string wkt2(const OGRSpatialReference& srs) {
  const char* const options[] = {"FORMAT=WKT2_2019", "MULTILINE=NO", nullptr};
  char* text = nullptr;
  std::string out;
  if (srs.exportToWkt(&text, options) == OGRERR_NONE && text) out = text;
  CPLFree(text);
  return out;
}

std::string stated_wkt(const OGRSpatialReference* srs) {
  const char* name = srs ? srs->GetName() : nullptr;
  return !srs || srs->IsLocal() || std::string(name ? name : "").starts_with("Undefined") ? std::string() : wkt2(*srs);
}

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
  facts.unit = facts.geographic ? "degree" : core::unit_symbol(crs.metres_per_unit());
  const bool is_known = crs.has_height_unit() || facts.geographic || crs.metres_per_unit() == 1.0;
  facts.vertical_unit = is_known ? core::unit_symbol(crs.vertical_metres_per_unit()) : "unknown unit";
  facts.vertical_name = crs.vertical_name();
  srs.StripVertical();
  srs.DemoteTo2D(nullptr);
  facts.horizontal_wkt = wkt2(srs);
  return facts;
}

}  // namespace swath::io
