// SPDX-License-Identifier: GPL-3.0-or-later
// Points, lines and areas with fields, out as layers of a GeoPackage, and as DXF.
#pragma once

#include <Eigen/Core>
#include <filesystem>
#include <string>
#include <variant>
#include <vector>

namespace swath::io {

enum class SpatialShape { point, line, polygon };

/// A field's value; a number that is not finite is left unset.
using FieldValue = std::variant<double, std::int64_t, std::string>;

struct SpatialFeature {
  std::vector<Eigen::Vector3d> places;                ///< CRS units; a polygon's ring without the first place at its end
  std::vector<FieldValue> values;                     ///< in the order of the layer's fields, each of its kind
  std::vector<std::vector<Eigen::Vector3d>> holes{};  ///< of a polygon, rings as `places`
};

struct SpatialField {
  std::string name;
  FieldValue kind;  ///< of its values, by the alternative that it holds
};

struct SpatialLayer {
  std::string name, about;  ///< about: the layer's description; empty: none
  SpatialShape shape = SpatialShape::line;
  bool flat = false;  ///< without heights
  std::vector<SpatialField> fields;
  std::vector<SpatialFeature> features;
  bool vertical = false;  ///< with the vertical part of the CRS, where a GeoPackage can hold both
};

/// GeoPackage 1.2, in the horizontal part of the CRS (but see SpatialLayer::vertical); heights as they are. Equal layers give equal bytes:
/// the time stamp that the format wants is a constant, 2000-01-01. Throws core::Error: unknown CRS, a feature without places or with other
/// values than the layer's fields, file not writable, disk full; nothing half-written stays.
void write_gpkg(const std::filesystem::path& file, const std::vector<SpatialLayer>& layers, const std::string& crs);

/// AutoCAD R12: 3D polylines and points, each layer in upper case with a colour of its own, holes as polylines of their own; 4 decimals (9
/// in degrees). Throws as above.
void write_dxf(const std::filesystem::path& file, const std::vector<SpatialLayer>& layers, const std::string& crs);

/// The fields of one layer as delimited text with a head line: numbers with 4 decimals, in front of them x, y and z of points with 3.
/// Throws as above.
void write_feature_csv(const std::filesystem::path& file, const SpatialLayer& layer);

}  // namespace swath::io
