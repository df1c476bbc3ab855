// SPDX-License-Identifier: GPL-3.0-or-later
// GDAL's own account of what it opens a file with (GDALDataset::GetFileList), and the names that it looks for later.
#include "io/vector/side_files.h"

#include <cpl_string.h>
#include <gdal_priv.h>

#include <algorithm>
#include <set>
#include <string>

#include "io/vector/gdal_door.h"

namespace swath::io {
namespace {

namespace fs = std::filesystem;

constexpr const char* vector_endings[] = {".shp", ".tab", ".mif", ".gpkg", ".geojson", ".kml", ".fgb", ".dxf"};
constexpr const char* raster_endings[] = {".vrt", ".tif", ".tiff", ".asc", ".img", ".png", ".jpg", ".bil", ".flt", ".dem", ".gtx", ".xyz"};
constexpr const char* looked_for[] = {".aux.xml", ".ovr", ".msk", "-wal", "-journal"};

std::string lower_ending(const fs::path& file) {
  std::string e = file.extension().string();
  std::transform(e.begin(), e.end(), e.begin(), [](unsigned char c) { return static_cast<char>(c >= 'A' && c <= 'Z' ? c + 32 : c); });
  return e;
}

template <size_t n>
bool is_one_of(const std::string& ending, const char* const (&list)[n]) {
  return std::find(std::begin(list), std::end(list), ending) != std::end(list);
}

void collect(const fs::path& file, int depth, std::set<fs::path>& out) {
  constexpr int deepest = 4;  // virtual rasters of virtual rasters
  const std::string ending = lower_ending(file);
  const bool vector = is_one_of(ending, vector_endings), raster = is_one_of(ending, raster_endings);
  if (depth > deepest || (!vector && !raster)) return;
  std::error_code ec;
  for (const char* name : looked_for)
    if (const fs::path beside = file.string() + name; fs::is_regular_file(beside, ec)) out.insert(beside);
  const GdalMessages messages;
  const Dataset opened = vector ? open_vector(file) : open_raster(file);
  if (!opened) return;
  const CPLStringList files(opened->GetFileList());
  for (int i = 0; i < files.size(); ++i) {
    const fs::path one = files[i];
    if (!fs::is_regular_file(one, ec) || !out.insert(one).second) continue;
    if (one != file) collect(one, depth + 1, out);
  }
}

}  // namespace

std::vector<fs::path> side_files(const fs::path& file) {
  std::set<fs::path> found;
  collect(file, 0, found);
  found.erase(file);
  return {found.begin(), found.end()};
}

}  // namespace swath::io
