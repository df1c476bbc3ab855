// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/vector/height_statement.h"

#include <gdal_priv.h>
#include <ogrsf_frmts.h>

#include <fstream>
#include <string>
#include <string_view>

#include "core/error.h"
#include "core/geo/crs.h"
#include "core/geo/height_unit.h"
#include "io/vector/gdal_door.h"

namespace swath::io {
namespace {

constexpr std::string_view heights_in = "; heights in ";

/// The unit named between `before` and `behind` in a text.
std::optional<double> unit_between(std::string_view text, std::string_view before, char behind) {
  const size_t at = text.find(before);
  if (at == std::string_view::npos) return std::nullopt;
  const std::string_view rest = text.substr(at + before.size());
  return core::metres_of_unit_name(rest.substr(0, rest.find(behind)));
}

std::optional<double> unit_of_crs(const OGRSpatialReference* srs) {
  const std::string wkt = stated_wkt(srs);
  if (wkt.empty()) return std::nullopt;
  try {
    const core::Crs crs(wkt);
    return crs.has_height_unit() ? std::optional(crs.vertical_metres_per_unit()) : std::nullopt;
  } catch (const core::Error&) {  // what is not understood is not stated
    return std::nullopt;
  }
}

std::string beginning_of(const std::filesystem::path& file) {
  constexpr std::size_t longest = 4096;
  std::ifstream in(file, std::ios::binary);
  std::string text(longest, '\0');
  in.read(text.data(), static_cast<std::streamsize>(text.size()));
  text.resize(static_cast<std::size_t>(in.gcount()));
  return text;
}

}  // namespace

std::string heights_statement(const CrsFacts& crs) { return std::string(heights_in) + crs.vertical_unit + ", " + crs.vertical_name; }

std::string_view stated_heights(std::string_view description) {
  const size_t at = description.find(heights_in), comma = description.find(", ", at);
  if (at == std::string_view::npos || comma == std::string_view::npos) return {};
  return description.substr(comma + 2);
}

std::optional<double> height_unit_in(GDALDataset& set, const std::filesystem::path& file) {
  for (OGRLayer* layer : set.GetLayers()) {
    if (const auto unit = unit_of_crs(layer->GetSpatialRef())) return unit;
    const char* about = layer->GetMetadataItem("DESCRIPTION");
    if (const auto unit = unit_between(about ? about : "", heights_in, ',')) return unit;
  }
  const std::string driver = set.GetDriverName();
  if (driver == "DXF") return unit_between(beginning_of(file), ", elevations in ", ',');
  if (driver == "GeoJSON") return unit_between(beginning_of(file), "\"height_unit\": \"", '"');
  return std::nullopt;
}

}  // namespace swath::io
