// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/vector/feature_layers.h"

namespace swath::io {
namespace {

std::vector<Eigen::Vector3d> lifted(const std::vector<Eigen::Vector2d>& places) {
  std::vector<Eigen::Vector3d> out;
  for (const Eigen::Vector2d& p : places) out.emplace_back(p.x(), p.y(), 0.0);
  return out;
}

SpatialFeature spatial(const Feature& f) {
  SpatialFeature out;
  for (const auto& part : f.parts) (out.places.empty() ? out.places : out.holes.emplace_back()) = lifted(part);
  for (const std::string& text : f.texts) out.values.emplace_back(text);
  for (const double number : f.numbers) out.values.emplace_back(number);
  return out;
}

}  // namespace

void write_feature_layers(const std::filesystem::path& file, const std::vector<FeatureLayer>& layers, const std::string& crs) {
  std::vector<SpatialLayer> out;
  for (const FeatureLayer& l : layers) {
    SpatialLayer& to = out.emplace_back();
    to.name = l.name, to.about = l.about, to.shape = l.shape, to.flat = true;
    for (const std::string& name : l.text_fields) to.fields.push_back({name, std::string()});
    for (const std::string& name : l.number_fields) to.fields.push_back({name, 0.0});
    for (const Feature& f : l.features) to.features.push_back(spatial(f));
  }
  write_gpkg(file, out, crs);
}

}  // namespace swath::io
