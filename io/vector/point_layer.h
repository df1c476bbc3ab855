// SPDX-License-Identifier: GPL-3.0-or-later
// Points with a name, a kind and numbers as a GeoPackage.
#pragma once

#include <Eigen/Core>
#include <filesystem>
#include <string>
#include <vector>

namespace swath::io {

struct NamedPoint {
  std::string name, kind;
  Eigen::Vector3d position = Eigen::Vector3d::Zero();  ///< easting, northing, height of the CRS
  std::vector<double> values;                          ///< one per field; NaN is left empty
};

/// Writes one layer of points with heights: fields `name`, `kind`, and `fields` (reals). Empty `crs`: without one. The same points give the
/// same bytes. Throws core::Error, and where values and fields differ in number.
void write_point_layer(const std::filesystem::path& file, const std::string& layer, const std::string& crs,
                       const std::vector<std::string>& fields, const std::vector<NamedPoint>& points);

}  // namespace swath::io
