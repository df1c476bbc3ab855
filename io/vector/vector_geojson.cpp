// SPDX-License-Identifier: GPL-3.0-or-later
// RFC 7946: WGS84 longitude and latitude (section 4), lines cut at the antimeridian (section 3.1.9), foreign members allowed (6.1).
// Only the horizontal part of the CRS is transformed; heights stay in the CRS's own vertical reference, as a property, because the
// altitude of RFC 7946 is ellipsoidal and a contour's height is not.
// GDAL's driver was weighed: it cuts at the antimeridian only where it was built with GEOS, takes ballpark transformations between datums
// without a word and writes points that have no WGS84 coordinates; what refuses both is most of this file.
#include <ogr_spatialref.h>

#include <cmath>
#include <vector>

#include "core/error.h"
#include "io/vector/vector_sink.h"

namespace swath::io {
namespace {

constexpr int decimals = 9;  // of a degree: 0.1 mm

std::string quoted(const std::string& text) {
  std::string out = "\"";
  for (const char c : text) {
    if (c == '"' || c == '\\') out += '\\';
    if (static_cast<unsigned char>(c) >= 0x20) out += c;
  }
  return out + "\"";
}

using Part = std::vector<std::pair<double, double>>;

/// The line in parts that do not cross the antimeridian.
std::vector<Part> cut_at_antimeridian(const std::vector<double>& lon, const std::vector<double>& lat) {
  std::vector<Part> parts(1);
  for (size_t k = 0; k < lon.size(); ++k) {
    if (k > 0 && std::abs(lon[k] - lon[k - 1]) > 180.0) {
      const double side = lon[k - 1] > 0 ? 180.0 : -180.0;
      const double next = lon[k] + 2.0 * side;  // the same meridian, counted on
      const double share = next == lon[k - 1] ? 0.0 : (side - lon[k - 1]) / (next - lon[k - 1]);
      const double at = lat[k - 1] + share * (lat[k] - lat[k - 1]);
      if (parts.back().back() != std::pair(side, at)) parts.back().emplace_back(side, at);
      parts.push_back({{-side, at}});
    }
    if (parts.back().empty() || parts.back().back() != std::pair(lon[k], lat[k])) parts.back().emplace_back(lon[k], lat[k]);
  }
  std::erase_if(parts, [](const Part& p) { return p.size() < 2; });
  return parts;
}

class GeoJsonSink : public ContourSink {
 public:
  using ContourSink::add;
  GeoJsonSink(const std::filesystem::path& file, const CrsFacts& crs) : file_(file), text_(file) {
    if (crs.empty)
      throw core::Error("GeoJSON is in WGS84 and the contours' CRS is not known", file.string(),
                        "state the survey's crs, or write GeoPackage or DXF");
    const GdalMessages messages;
    OGRSpatialReference from, to;
    from.SetFromUserInput(crs.horizontal_wkt.c_str());
    from.SetAxisMappingStrategy(OAMS_TRADITIONAL_GIS_ORDER);
    to.SetFromUserInput("EPSG:4326");
    to.SetAxisMappingStrategy(OAMS_TRADITIONAL_GIS_ORDER);
    OGRCoordinateTransformationOptions options;
    options.SetBallparkAllowed(false);
    to_wgs84_.reset(OGRCreateCoordinateTransformation(&from, &to, options));
    if (!to_wgs84_)
      throw core::Error("GeoJSON is in WGS84 and there is no transformation to it from " + crs.name, file.string(),
                        "the CRS's datum is not known: state an EPSG code, or use the GeoPackage");
    text_ << "{\n\"type\": \"FeatureCollection\",\n\"swath\": {\"source_crs\": " << quoted(crs.name)
          << ", \"height_unit\": " << quoted(crs.vertical_unit) << ", \"height_reference\": " << quoted(crs.vertical_name)
          << "},\n\"features\": [";
  }

  void add(const core::ContourLine& line) override {
    lon_ = line.x;
    lat_ = line.y;
    ok_.assign(lon_.size(), 0);
    const GdalMessages messages;
    to_wgs84_->Transform(static_cast<int>(lon_.size()), lon_.data(), lat_.data(), nullptr, ok_.data());
    for (size_t k = 0; k < ok_.size(); ++k)
      if (!ok_[k] || !std::isfinite(lon_[k]) || !std::isfinite(lat_[k]))
        throw core::Error("a contour of height " + shortest_text(line.height) +
                              " lies where its CRS has no WGS84 coordinates: " + shortest_text(line.x[k]) + ", " + shortest_text(line.y[k]),
                          file_.string(), "check the survey's crs");
    const std::vector<Part> parts = cut_at_antimeridian(lon_, lat_);
    text_ << (first_ ? "\n" : ",\n") << "{\"type\": \"Feature\", \"properties\": {\"height\": " << shortest_text(line.height)
          << ", \"index\": " << (line.index ? "true" : "false") << ", \"closed\": " << (line.closed ? "true" : "false")
          << ", \"depression\": " << (line.depression ? "true" : "false") << "}, \"geometry\": ";
    first_ = false;
    if (parts.empty()) {
      text_ << "null}";
      return;
    }
    text_ << (parts.size() == 1 ? "{\"type\": \"LineString\", \"coordinates\": " : "{\"type\": \"MultiLineString\", \"coordinates\": [");
    for (size_t p = 0; p < parts.size(); ++p) {
      text_ << (p ? ", [" : "[");
      for (size_t k = 0; k < parts[p].size(); ++k) {
        text_ << (k ? ", [" : "[");
        text_.fixed(parts[p][k].first, decimals) << ", ";
        text_.fixed(parts[p][k].second, decimals) << "]";
      }
      text_ << "]";
    }
    text_ << (parts.size() == 1 ? "}}" : "]}}");
  }

  void close() override {
    text_ << "\n]\n}\n";
    text_.close();
  }

 private:
  std::filesystem::path file_;
  TextStream text_;
  std::unique_ptr<OGRCoordinateTransformation> to_wgs84_;
  std::vector<double> lon_, lat_;
  std::vector<int> ok_;
  bool first_ = true;
};

}  // namespace

std::unique_ptr<ContourSink> make_geojson_sink(const std::filesystem::path& file, const CrsFacts& crs) {
  return std::make_unique<GeoJsonSink>(file, crs);
}

}  // namespace swath::io
