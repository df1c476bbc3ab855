// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/vector/line_layer.h"

#include "io/vector/feature_file.h"

namespace swath::io {

void write_line_layer(const std::filesystem::path& file, const LineLayer& what, const std::string& crs) {
  FeatureLayer layer{what.name, what.about, FeatureShape::line, true, {{"name", std::string()}}, {}};
  for (const std::string& f : what.fields) layer.fields.push_back({f, 0.0});
  for (const LineFeature& l : what.lines) {
    Feature feature;
    for (size_t k = 0; k < l.x.size(); ++k) feature.places.emplace_back(l.x[k], l.y[k], 0.0);
    feature.values.emplace_back(l.name);
    for (const double number : l.numbers) feature.values.emplace_back(number);
    layer.features.push_back(std::move(feature));
  }
  write_gpkg(file, {layer}, crs);
}

}  // namespace swath::io
