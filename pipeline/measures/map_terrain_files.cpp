// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/measures/map_terrain_files.h"

#include <algorithm>
#include <cstdio>

#include "core/config/result_visitors.h"
#include "core/error.h"
#include "core/geo/height_unit.h"
#include "io/raster/geotiff.h"
#include "io/text/output_file.h"
#include "io/text/value_file.h"
#include "io/vector/vector_map.h"
#include "pipeline/input_guard.h"
#include "pipeline/line_file.h"

namespace swath::pipeline {
namespace {

namespace fs = std::filesystem;

struct MapFile {
  fs::path name;
  io::VectorMap map;
};

std::vector<MapFile> read_files(const MapTerrainRequest& r) {
  std::vector<MapFile> out;
  for (const fs::path& file : r.files) out.push_back({file, io::read_map(file, r.field)});
  return out;
}

core::Crs crs_of(const MapTerrainRequest& r, const std::vector<MapFile>& files) {
  if (!r.crs.empty()) return core::Crs(r.crs);
  for (const MapFile& file : files)
    if (!file.map.spots.crs_wkt.empty()) return core::Crs(file.map.spots.crs_wkt);
  return {};
}

/// Metres of one unit of a file's heights: what it states, else the option, else what the model's CRS leaves no doubt of.
double unit_of(const MapFile& file, const MapTerrainRequest& r, const core::Crs& crs) {
  if (file.map.height_unit) return *file.map.height_unit;
  if (r.height_unit) return *r.height_unit;
  if (crs.has_height_unit()) return crs.vertical_metres_per_unit();
  if (core::is_same_unit(crs.metres_per_unit(), 1.0)) return 1.0;
  throw core::usage_error("the file does not state the unit of its heights, and the CRS is in " + crs.unit_name(), file.name.string(),
                          "name the unit: --height-unit \"1 m\", \"1 ft\" or \"1 us-ft\"");
}

/// Brings the heights of all files to the unit of the model, which is that of its CRS, else of the first file. Metres of it; without a CRS
/// every length is in units of the files.
double settle_heights(std::vector<MapFile>& files, const MapTerrainRequest& r, const core::Crs& crs) {
  if (crs.empty()) return 1.0;
  const double model = crs.has_height_unit() ? crs.vertical_metres_per_unit() : unit_of(files.front(), r, crs);
  for (MapFile& file : files) {
    const double unit = unit_of(file, r, crs), scale = core::is_same_unit(unit, model) ? 1.0 : unit / model;
    for (io::VectorLine& line : file.map.lines.lines) {
      line.height *= scale;
      for (double& z : line.z) z *= scale;
    }
    for (double& z : file.map.spots.z) z *= scale;
  }
  return model;
}

/// The CRS that products state.
std::string product_crs(const core::Crs& crs, double vertical) {
  if (crs.empty()) return {};
  const bool plain = core::is_same_unit(vertical, 1.0) && core::is_same_unit(crs.metres_per_unit(), 1.0);
  return crs.has_height_unit() || plain ? crs.wkt() : core::with_height_unit(crs, vertical);
}

bool is_place(double x, double y, double z) { return is_on_a_map(x, y) && std::isfinite(z); }

/// The line with its heights; nothing where it has none, or no length.
std::optional<terrain::MapLine> map_line(const io::VectorLine& line, const std::string& place) {
  const bool has_z = !line.z.empty();
  const bool changes = has_z && *std::max_element(line.z.begin(), line.z.end()) > *std::min_element(line.z.begin(), line.z.end());
  if (!changes && !std::isfinite(line.height)) return std::nullopt;
  terrain::MapLine out{{}, !changes, place};
  for (size_t k = 0; k < line.x.size(); ++k) {
    const double z = changes ? line.z[k] : line.height;
    if (is_place(line.x[k], line.y[k], z)) out.vertices.emplace_back(line.x[k], line.y[k], z);
  }
  if (out.vertices.size() < 2) return std::nullopt;
  return out;
}

terrain::MapContent content_of(std::vector<MapFile> files, const core::Crs& crs, MapTerrainFound& found) {
  terrain::MapContent out;
  for (MapFile& file : files) {
    size_t number = 0;
    move_into(crs, file.name, file.map.lines);
    for (const io::VectorLine& line : file.map.lines.lines) {
      auto one = map_line(line, file.name.string() + ": layer " + line.layer + ", line " + std::to_string(++number));
      if (!one) {
        ++found.without_height;
        continue;
      }
      ++(one->contour ? found.contours : found.breaklines);
      out.lines.push_back(std::move(*one));
    }
    move_into(crs, file.name, file.map.spots);
    const io::SpotFile& spots = file.map.spots;
    found.without_height += spots.without_height;
    for (size_t k = 0; k < spots.x.size(); ++k)
      if (is_place(spots.x[k], spots.y[k], spots.z[k])) out.spots.emplace_back(spots.x[k], spots.y[k], spots.z[k]);
  }
  found.spots = out.spots.size();
  return out;
}

void write_products(const MapTerrainRequest& r, const std::string& wkt, const terrain::MapSurface& s, const MapTerrainFound& found) {
  std::error_code ec;
  fs::create_directories(r.folder, ec);
  if (ec) throw core::SystemError("cannot make the folder: " + ec.message(), r.folder.string());
  io::write_grid(r.folder / "dtm.tif", s.grid, wkt);
  io::write_grid(r.folder / "dtm_quality.tif", s.grid, wkt, {false, !s.grid.sigma.empty(), false, true});
  std::vector<float> part;
  for (const terrain::MapPart p : s.part) part.push_back(static_cast<float>(p));
  io::write_raster(r.folder / "dtm_part.tif", s.grid.lattice, {{"1 between contours, 2 flat and filled, 3 flat and kept", "", &part}}, wkt,
                   false);
  io::write_text_file(r.folder / "map_terrain.json", io::to_json(core::reported(found)));
}

}  // namespace

MapTerrainFound write_map_terrain(const MapTerrainRequest& r) {
  const InputGuard guard(r.files);
  for (const char* name : {"dtm.tif", "dtm_quality.tif", "dtm_part.tif", "map_terrain.json"}) guard.expect_apart(r.folder / name);
  std::vector<MapFile> files = read_files(r);
  const core::Crs crs = crs_of(r, files);
  const double metre = crs.empty() ? 1.0 : crs.metres_per_unit();
  if (metre == 0.0)
    throw core::Error("the map is in degrees", r.files.front().string(), "name a projected CRS for the model: --crs EPSG:25832");
  const double vertical = settle_heights(files, r, crs);
  MapTerrainFound found;
  if (!crs.empty()) found.height_unit = core::unit_symbol(vertical);
  const terrain::MapContent content = content_of(std::move(files), crs, found);
  const auto heights = [&](std::optional<double> v) { return v ? std::optional(*v / vertical) : v; };
  terrain::MapTerrain made = terrain::map_terrain(
      content, {r.cell / metre, heights(r.interval), heights(r.sigma), r.max_edge / metre, r.tolerance / vertical, r.keep_flats});
  found.levels = made.levels, found.interval = made.interval * vertical, found.cell = r.cell;
  found.voids = static_cast<size_t>(std::count(made.surface.part.begin(), made.surface.part.end(), terrain::MapPart::none));
  found.cells = made.surface.part.size() - found.voids;
  found.flat_parts = made.surface.flats.parts, found.flat_parts_left = made.surface.flats.parts_left;
  for (terrain::MapError& e : made.errors) {
    e.every_second *= vertical, e.every_fourth *= vertical;
    if (e.sigma) *e.sigma *= vertical;
  }
  found.errors = std::move(made.errors);
  write_products(r, product_crs(crs, vertical), made.surface, found);
  return found;
}

std::string map_terrain_text(const MapTerrainFound& f) {
  const std::string unit = f.height_unit.empty() ? "" : " m";
  char line[240];
  std::snprintf(line, sizeof line, "%s of %s, interval %.6g%s; %s, %s; without a height: %llu\n",
                core::counted(f.contours, "contour").c_str(), core::counted(f.levels, "height").c_str(), f.interval, unit.c_str(),
                core::counted(f.spots, "spot height").c_str(), core::counted(f.breaklines, "breakline").c_str(),
                static_cast<unsigned long long>(f.without_height));
  std::string out = line;
  std::snprintf(line, sizeof line, "%zu cells of %.6g%s, %zu void; flat parts filled: %zu, left flat: %zu\n", f.cells, f.cell, unit.c_str(),
                f.voids, f.flat_parts, f.flat_parts_left);
  out += line;
  if (!f.height_unit.empty()) out += "heights of the model in " + f.height_unit + "; lengths and errors in m\n";
  std::snprintf(line, sizeof line, "%-18s %12s %12s %14s %14s %10s\n", "part", "cells", "tested", "every second", "every fourth", "sigma");
  out += line;
  for (const terrain::MapError& e : f.errors) {
    if (e.cells == 0) continue;
    std::snprintf(line, sizeof line, "%-18s %12zu %12zu %14.3f %14.3f %10.3f%s\n", e.part.c_str(), e.cells, e.tested, e.every_second,
                  e.every_fourth, e.sigma.value_or(std::nan("")), e.assumed ? " (assumed)" : "");
    out += line;
  }
  return out;
}

}  // namespace swath::pipeline
