// SPDX-License-Identifier: GPL-3.0-or-later
// Contours out as GeoPackage, DXF and GeoJSON, line by line; lines in from any vector file that GDAL reads.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/contour_line.h"

class GDALDataset;

namespace swath::io {

class ContourSink;

/// Writes contours one at a time (memory does not grow with their number). The file appears under its name at close(); without it,
/// or where anything fails, nothing stays. The ending of the name chooses the format:
/// - .gpkg: GeoPackage, layer `contours` of LineStrings in the horizontal part of the CRS; fields `height` (real, CRS vertical unit),
///   `index`, `closed` and `depression` (boolean); layers of Points `labels` (`text`, `height`, `rotation` in degrees counter-clockwise
///   from east, `text_height` in CRS units) and `spot_heights` (`height`, `text`, `kind`: top or pit); the layers' descriptions name height
///   unit and vertical datum. The same contours give the same bytes: the time stamp that the format wants is a constant, 2000-01-01.
/// - .dxf: AutoCAD R12 polylines at their elevation (no other dimension than the CRS's), layers CONTOUR, CONTOUR_INDEX and
///   CONTOUR_DEPRESSION (index or not), labels as centred TEXT on CONTOUR_LABEL, spot heights as POINT and TEXT on SPOT_HEIGHT; 4 decimals
///   (9 in degrees); $EXTMIN and $EXTMAX are true.
/// - .geojson, .json: RFC 7946, hence in WGS84 longitude and latitude with 9 decimals (0.1 mm), cut at the antimeridian; properties as the
///   GeoPackage's fields; lines only, as a direction on the map is none in degrees. Heights stay those of the CRS: the member `swath` names
///   CRS, height unit and vertical datum. A CRS is needed.
/// Throws core::Error: unknown ending or CRS, no transformation to WGS84 (GeoJSON), file not writable, disk full.
class ContourWriter {
 public:
  /// `heights`: what they count from, where the CRS leaves it open; empty: what the CRS says.
  ContourWriter(const std::filesystem::path& file, const std::string& crs, const std::string& heights = {});
  ~ContourWriter();
  ContourWriter(ContourWriter&&) noexcept;
  ContourWriter& operator=(ContourWriter&&) noexcept;

  /// Throws core::Error where a line has fewer than two vertices, columns of different length or a number that is not finite.
  void add(const core::ContourLine& line);
  void add(const core::ContourLabel& label);
  void add(const core::SpotHeight& spot);
  /// Lines so far.
  std::uint64_t count() const { return count_; }
  void close();

 private:
  std::unique_ptr<ContourSink> sink_;
  std::filesystem::path file_;
  std::uint64_t count_ = 0;
};

/// NAME.gpkg, NAME.dxf and NAME.geojson in a folder. GeoJSON is in WGS84: where the CRS has no way there it is left out.
class ContourFiles {
 public:
  ContourFiles(const std::filesystem::path& folder, const std::string& name, const std::string& crs, const std::string& heights);
  template <class T>
  void add(const T& what) {
    for (ContourWriter& f : files_) f.add(what);
    if (geojson_) with_geojson([&] { geojson_->add(what); });
  }
  /// Lines so far.
  std::uint64_t count() const { return files_.front().count(); }
  /// Why the GeoJSON is left out; empty where it is there.
  std::string close();

 private:
  void with_geojson(const std::function<void()>& work);
  std::vector<ContourWriter> files_;
  std::optional<ContourWriter> geojson_;
  std::string geojson_name_, left_out_;
};

/// A line of a vector file.
struct VectorLine {
  std::vector<double> x, y;  ///< easting before northing, CRS units
  std::vector<double> z;     ///< empty where the file's geometry is flat
  double height =
      std::numeric_limits<double>::quiet_NaN();  ///< field `height`, `elev`, `elevation`, `contour` or `z`; or the one z of all vertices
  bool index = false;                            ///< field `index`, or DXF layer CONTOUR_INDEX
  bool closed = false;                           ///< last vertex = first
  bool depression = false;                       ///< field `depression`, or DXF layer CONTOUR_DEPRESSION
  std::string layer;
};

struct VectorLines {
  std::vector<VectorLine> lines;
  std::string crs_wkt;  ///< WKT2:2019 of the first layer; empty where it states none
};

/// Reads all lines (also parts of multi-lines and rings of polygons, curves as chords) of all layers. `field`: the one with the height, in
/// place of those named above. Throws core::Error.
VectorLines read_lines(const std::filesystem::path& file, const std::string& field = {});
/// The same of a file that is open; GDAL's messages are left to the caller.
VectorLines lines_in(GDALDataset& set, const std::string& field);

}  // namespace swath::io
