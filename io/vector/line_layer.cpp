// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/vector/line_layer.h"

#include "io/vector/feature_layers.h"

namespace swath::io {

void write_line_layer(const std::filesystem::path& file, const LineLayer& what, const std::string& crs) {
  FeatureLayer layer{what.name, what.about, what.are_areas ? FeatureShape::polygon : FeatureShape::line, {"name"}, what.fields, {}};
  layer.text_fields.insert(layer.text_fields.end(), what.text_fields.begin(), what.text_fields.end());
  for (const LineFeature& l : what.lines) {
    Feature f{{{}}, {l.name}, l.numbers};
    f.texts.insert(f.texts.end(), l.texts.begin(), l.texts.end());
    for (size_t k = 0; k < l.x.size(); ++k) f.parts[0].push_back({l.x[k], l.y[k]});
    layer.features.push_back(std::move(f));
  }
  write_feature_layers(file, {layer}, crs);
}

}  // namespace swath::io
