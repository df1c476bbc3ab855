// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/vector/point_layer.h"

#include "io/vector/feature_file.h"

namespace swath::io {

void write_point_layer(const std::filesystem::path& file, const std::string& layer_name, const std::string& crs,
                       const std::vector<std::string>& fields, const std::vector<NamedPoint>& points) {
  SpatialLayer layer{layer_name, "", SpatialShape::point, false, {{"name", std::string()}, {"kind", std::string()}}, {}, true};
  for (const std::string& f : fields) layer.fields.push_back({f, 0.0});
  for (const NamedPoint& p : points) {
    SpatialFeature& to = layer.features.emplace_back();
    to.places = {p.position};
    to.values = {p.name, p.kind};
    to.values.insert(to.values.end(), p.values.begin(), p.values.end());
  }
  write_gpkg(file, {layer}, crs);
}

}  // namespace swath::io
