// SPDX-License-Identifier: GPL-3.0-or-later
// Source: PDAL 2.x, documentation of its stages (pdal.io). Where a default differs from ours, PDAL's is set.
#include "pipeline/jobs/pdal_options.h"

#include <algorithm>
#include <cstdio>
#include <map>
#include <set>
#include <sstream>

#include "io/text/toml_text.h"

namespace swath::pipeline {

using core::Value;

const std::vector<PdalFilter>& pdal_filters() {
  static const std::vector<PdalFilter> list{
      {"filters.smrf",
       "filters.smrf",
       {{"cell", "cell", PdalUnit::across, 1.0},
        {"slope", "slope"},
        {"window", "window", PdalUnit::across, 18.0},
        {"threshold", "threshold", PdalUnit::height, 0.5},
        {"scalar", "scalar", PdalUnit::height, 1.25},
        {"cut", "cut", PdalUnit::across}},
       {},
       "last returns alone, noise (7, 18) and withheld points left out, openings without an approximation"},
      {"filters.pmf",
       "filters.pmf",
       {{"cell_size", "cell_size", PdalUnit::across, 1.0},
        {"max_window_size", "max_window_size", PdalUnit::across, 33.0},
        {"slope", "slope"},
        {"initial_distance", "initial_distance", PdalUnit::height, 0.15},
        {"max_distance", "max_distance", PdalUnit::height, 2.5},
        {"exponential", "exponential"}},
       {},
       "last returns alone, noise (7, 18) and withheld points left out"},
      {"filters.csf",
       "filters.csf",
       {{"resolution", "resolution", PdalUnit::across, 1.0},
        {"rigidness", "rigidness"},
        {"step", "step"},
        {"iterations", "iterations"},
        {"threshold", "threshold", PdalUnit::height, 0.5},
        {"smooth", "smooth"}},
       {},
       "last returns alone, noise (7, 18) and withheld points left out, the cloth in squares of twice span"},
      {"filters.elm",
       "filters.noise",
       {{"threshold", "low_depth", PdalUnit::height, 1.0}},
       {{"neighbours", 0}},
       "low points by the ground around them in place of the cell's next lowest point"},
      {"filters.outlier",
       "filters.outlier",
       {{"mean_k", "mean_k", PdalUnit::none, 8.0}, {"multiplier", "multiplier", PdalUnit::none, 2.0}},
       {{"min_distance", "0 m"}, {"group", 0}},
       "mean and deviation of the points around in place of the whole cloud's; classes 7 below and 18 above",
       "statistical"},
      {"filters.outlier",
       "filters.noise",
       {{"radius", "radius", PdalUnit::across, 1.0}, {"min_k", "neighbours", PdalUnit::none, 2.0}},
       {{"widen", false}, {"low_group", 0}},
       "class 18 in place of 7; points that are withheld or noise before are not neighbours",
       "radius"},
  };
  return list;
}

std::string pdal_nearest(const std::string& type) {
  static const std::string thin =
      "here no filter deletes points; nearest is filters.key_points, which flags those that the ground's surface needs";
  static const std::map<std::string, std::string> nearest{
      {"filters.sample", thin},
      {"filters.decimation", thin},
      {"filters.voxelcentroidnearestneighbor", thin},
      {"filters.voxelcenternearestneighbor", thin},
      {"filters.voxeldownsize", thin},
      {"filters.crop", "nearest is filters.crop of a config, which withholds points outside of polygons in a file"},
      {"filters.hag_nn", "nearest is filters.hag_delaunay"},
      {"filters.hag_dem", "nearest is filters.hag_delaunay"},
      {"filters.dem", "nearest is filters.noise of a config"},
      {"filters.assign",
       "leave it out where it clears classes: ground filters here give every point a new one but noise (7, 18) and withheld points"},
      {"filters.expression", "nearest is filters.range with Classification[a:b] right before writers.gdal"},
      {"filters.returns", "nearest is filters.returns of a config, which numbers the returns of pulses and deletes none"},
      {"writers.ept_addon", "nearest is writers.copc"},
      {"writers.ogr", "nearest is writers.las"},
      {"writers.raster", "nearest is writers.gdal"}};
  const auto at = nearest.find(type);
  return at == nearest.end() ? "" : at->second;
}

bool is_the_case(const std::string& type, const std::string& name, const Value& value) {
  static const std::map<std::string, std::vector<std::string>> same{
      {"returns", {"last, only", "last,only"}},
      {"ignore", {"Classification[7:7]", "Classification[7:7],Classification[18:18]", "Classification[7:7], Classification[18:18]"}},
      {"class", {"7"}},
      {"dir", {""}},
      {"gdaldriver", {"GTiff"}},
      {"data_type", {"float", "float32"}},
      {"nodata", {"-9999"}},
      {"dimension", {"Z"}},
      {"forward", {"all"}},
      {"extra_dims", {"all"}},
      {"offset_x", {"auto"}},
      {"offset_y", {"auto"}},
      {"offset_z", {"auto"}},
      {"minor_version", {"4"}},
      {"compression", {"true", "laszip", "lazperf"}}};
  if (name == "tag" || name == "type") return true;
  const auto at = same.find(name);
  if (at == same.end() || (name == "compression" && type != "writers.las")) return false;
  const std::string text = value.is_text() ? value.as_text() : io::toml_scalar(value);
  return std::find(at->second.begin(), at->second.end(), text) != at->second.end();
}

std::vector<int> classes_of_limits(const std::string& limits, std::string& why) {
  constexpr std::string_view dimension = "Classification";
  std::string plain = limits;
  std::erase(plain, ' ');
  std::set<int> out;
  std::istringstream in(plain);
  for (std::string one; std::getline(in, one, ',');) {
    int low = 0, high = 0, used = 0;
    const bool is_class = one.starts_with(dimension);
    const std::string range = is_class ? one.substr(dimension.size()) : one;
    if (!is_class)
      why = "'" + one + "' is no range of Classification";
    else if (range.starts_with('!'))
      why = "'" + one + "' states the classes to leave out: state those to keep";
    else if (std::sscanf(range.c_str(), "[%d:%d]%n", &low, &high, &used) != 2 || static_cast<size_t>(used) != range.size() || low < 0 ||
             high > 255 || low > high)
      why = "'" + one + "' is not Classification[a:b] with classes from 0 to 255";
    if (!why.empty()) return {};
    for (int c = low; c <= high; ++c) out.insert(c);
  }
  if (out.empty()) why = "no limit is stated";
  return {out.begin(), out.end()};
}

}  // namespace swath::pipeline
