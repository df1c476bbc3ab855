// SPDX-License-Identifier: GPL-3.0-or-later
// The table of survey.toml.
#pragma once

#include <array>
#include <filesystem>
#include <string>
#include <string_view>

#include "core/breakline.h"
#include "core/config/option.h"

namespace swath::io {

/// One file of lines or areas: GeoPackage, Shapefile, DXF, GeoJSON.
struct BreaklineFile {
  std::filesystem::path file;
  core::BreaklineKind kind = core::BreaklineKind::breakline;
  std::string layer;
  std::string crs;
  std::string z = "z";
  core::Metres sigma{0.05};
};

template <class V>
void describe(BreaklineFile& f, V& v) {
  v.option("file", f.file, "GeoPackage, Shapefile, DXF or GeoJSON, relative to survey.toml.");
  v.option("kind", f.kind, "breakline; boundary (of the model); lake (still water); river (area between its banks).");
  v.option("layer", f.layer, "Layer of the file that is read; empty: all.");
  v.option("crs", f.crs, "CRS of its coordinates; empty: the file's own, or that of the survey where it states none.");
  v.option("z", f.z, "Attribute with the height of features without one in their geometry, in the CRS's height unit.");
  v.option("sigma", f.sigma, core::at_least(0), "Sigma of the heights.");
}

}  // namespace swath::io

namespace swath::core {
template <>
struct Choices<BreaklineKind> {
  static constexpr std::array<std::string_view, 4> names{"breakline", "boundary", "lake", "river"};
};
}  // namespace swath::core
