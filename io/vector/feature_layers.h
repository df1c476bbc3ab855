// SPDX-License-Identifier: GPL-3.0-or-later
// Points, lines and polygons with texts and numbers, out as the layers of a GeoPackage.
#pragma once

#include <Eigen/Core>
#include <filesystem>
#include <string>
#include <vector>

namespace swath::io {

enum class FeatureShape { point, line, polygon };

struct Feature {
  /// One part: of a point its one place, of a line its vertices; of a polygon its outer ring and then its holes, not closed. CRS units.
  std::vector<std::vector<Eigen::Vector2d>> parts;
  std::vector<std::string> texts;  ///< in the order of the layer's fields
  std::vector<double> numbers;     ///< the same; not finite: no value
};

struct FeatureLayer {
  std::string name, about;  ///< about: the layer's description
  FeatureShape shape = FeatureShape::point;
  std::vector<std::string> text_fields, number_fields;
  std::vector<Feature> features;
};

/// GeoPackage 1.2 in the horizontal part of the CRS. Equal layers give equal bytes: the time stamp that the format wants is a constant,
/// 2000-01-01. Throws core::Error: unknown CRS, file not writable, disk full; nothing half-written stays.
void write_feature_layers(const std::filesystem::path& file, const std::vector<FeatureLayer>& layers, const std::string& crs);

}  // namespace swath::io
