// SPDX-License-Identifier: GPL-3.0-or-later
// Points, lines and polygons without heights, with texts and numbers, out as the layers of a GeoPackage.
#pragma once

#include <Eigen/Core>
#include <filesystem>
#include <string>
#include <vector>

#include "io/vector/feature_file.h"

namespace swath::io {

using FeatureShape = SpatialShape;

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

/// By write_gpkg(), which throws: also where a feature's texts and numbers are not as many as the layer's fields.
void write_feature_layers(const std::filesystem::path& file, const std::vector<FeatureLayer>& layers, const std::string& crs);

}  // namespace swath::io
